#!/bin/bash
# Builds the door for the browser: target/midair.wasm, simd128, without imports. With rustup's target wasm32 where there is
# one; else with Debian's compiler (rustc-web cargo-web rust-web-src lld-19), which builds the standard library along.
set -eu -o pipefail
cd "$(dirname "$0")"
# What is inlined at will makes the module half as large again, and no faster; kernels ask for it by themselves.
flags="-C target-feature=+simd128 -C llvm-args=--inline-threshold=40"
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
    RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc RUSTFLAGS="$flags -C linker=$linker" /usr/bin/cargo build --release \
        --target $target -Zbuild-std=std,panic_abort
fi
mkdir -p ../built
cp "$out/$target/release/midair_door.wasm" ../built/midair.wasm
