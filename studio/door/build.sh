#!/bin/bash
# Builds the door for the browser: target/midair.wasm, simd128, without imports. With rustup's target wasm32 where there is
# one; else with Debian's compiler (rustc-web cargo-web rust-web-src lld-19), which builds the standard library along: short,
# and without the messages of panics, which no browser shows. With rustup's own library the module is larger.
set -eu -o pipefail
cd "$(dirname "$0")"
# What is inlined and unrolled at will makes the module larger, and no faster; kernels ask for it by themselves.
flags="-C target-feature=+simd128 -C link-arg=--compress-relocations"
flags+=" -C llvm-args=--inline-threshold=10 -C llvm-args=--inlinehint-threshold=30"
flags+=" -C llvm-args=-unroll-runtime=false -C llvm-args=-unroll-allow-partial=false"
target=wasm32-unknown-unknown
out=${CARGO_TARGET_DIR:-target}

if [ -d "$(rustc --print sysroot)/lib/rustlib/$target" ]; then
    RUSTFLAGS="$flags" cargo build --release --target $target
else
    linker=$(command -v wasm-ld wasm-ld-19 | head -1 || true)
    if [ ! -x /usr/bin/rustc ] || [ ! -e /usr/lib/rustlib/src/rust/library/Cargo.lock ] || [ -z "$linker" ]; then
        echo "studio/door: no compiler for WebAssembly: rustup target add $target" \
            "(Debian: apt-get install rustc-web cargo-web rust-web-src lld-19)" >&2
        exit 2
    fi
    RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc RUSTFLAGS="$flags -C linker=$linker -Z unstable-options -C panic=immediate-abort" \
        /usr/bin/cargo build --release --target $target -Zbuild-std=std,panic_abort -Zbuild-std-features=optimize_for_size
fi
mkdir -p ../built
cp "$out/$target/release/midair_door.wasm" ../built/midair.wasm
