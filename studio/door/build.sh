#!/bin/bash
# Builds the browser's binding: target/midair.wasm, with simd128, without imports. With Debian's compiler (rustc-web
# cargo-web rust-web-src lld-19) it also builds the standard library: optimised for size, without panic messages, which
# no browser shows. Otherwise it uses rustup's target wasm32, whose module is a tenth larger.
set -eu -o pipefail
cd "$(dirname "$0")"
# Unlimited inlining and unrolling makes the module larger but not faster; kernels request inlining themselves.
flags="-C target-feature=+simd128 -C link-arg=--compress-relocations"
flags+=" -C llvm-args=--inline-threshold=10 -C llvm-args=--inlinehint-threshold=30"
flags+=" -C llvm-args=-unroll-runtime=false -C llvm-args=-unroll-allow-partial=false"
target=wasm32-unknown-unknown
out=${CARGO_TARGET_DIR:-target}

linker=$(command -v wasm-ld wasm-ld-19 "$(rustc --print sysroot)"/lib/rustlib/*/bin/rust-lld | head -1 || true)
if [ -x /usr/bin/rustc ] && [ -e /usr/lib/rustlib/src/rust/library/Cargo.lock ] && [ -n "$linker" ]; then
    RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc RUSTFLAGS="$flags -C linker=$linker -Z unstable-options -C panic=immediate-abort" \
        /usr/bin/cargo build --release --target $target -Zbuild-std=std,panic_abort -Zbuild-std-features=optimize_for_size
elif [ -d "$(rustc --print sysroot)/lib/rustlib/$target" ] || rustup --quiet target add $target 2> /dev/null; then
    RUSTFLAGS="$flags" cargo build --release --target $target
else
    echo "studio/door: no compiler for WebAssembly: rustup target add $target" \
        "(Debian: apt-get install rustc-web cargo-web rust-web-src lld-19)" >&2
    exit 2
fi
mkdir -p ../built
cp "$out/$target/release/midair_door.wasm" ../built/midair.wasm
