#!/bin/bash
# Runs the core's unit tests and golden vectors for 64-bit ARM (NEON) in qemu and for WebAssembly (simd128) in Node, and
# compiles the core without std for a browser. Debian's compiler includes the source of the standard library, which is
# compiled too, so no target has to be downloaded. Installs nothing.
set -eu -o pipefail
cd "$(dirname "$0")/../.."

need() { # NAME PLACES PACKAGE: sets `found` to the first place that exists
    for place in $2; do
        if [ -e "$place" ]; then found=$place && return; fi
    done
    echo "test-portable: $1 is missing: install $3" >&2
    exit 2
}

need "Debian's Rust compiler" /usr/bin/rustc rustc-web
need "Debian's cargo" /usr/bin/cargo cargo-web
need "the standard library's source" /usr/lib/rustlib/src/rust/library/Cargo.lock rust-web-src
need "an ARM linker" /usr/bin/aarch64-linux-gnu-gcc gcc-aarch64-linux-gnu
need "an ARM libc" /usr/aarch64-linux-gnu/lib/crt1.o libc6-dev-arm64-cross
need "an ARM emulator" /usr/bin/qemu-aarch64 qemu-user
need "a libc for WebAssembly" /usr/lib/wasm32-wasi/libc.a wasi-libc
need "Node 20 or newer" "$(command -v node || true)" nodejs
need "a linker for WebAssembly" "/usr/bin/wasm-ld-19 /usr/bin/wasm-ld" lld-19
wasm_linker=$found

# A stable compiler needs this variable for -Zbuild-std, and rustup must not choose another compiler.
export RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc
unset RUSTFLAGS

export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu"

# std refers to pthread_join and pthread_detach, which a libc without threads does not have. Nothing here calls them, so
# missing symbols may become traps.
export CARGO_TARGET_WASM32_WASIP1_LINKER=$wasm_linker
export CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS="-C target-feature=+simd128 -C link-self-contained=no \
-L native=/usr/lib/wasm32-wasi -C link-arg=/usr/lib/wasm32-wasi/crt1-command.o \
-C link-arg=--unresolved-symbols=ignore-all"
export CARGO_TARGET_WASM32_WASIP1_RUNNER="node --no-warnings $PWD/core/tests/wasi.mjs"

export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-C target-feature=+simd128"

cargo() { # VERB TARGET STD-CRATES [OPTION...]
    echo "== cargo $1 for $2 ${*:4}"
    /usr/bin/cargo "$1" --quiet -p midair --target "$2" -Zbuild-std="$3" "${@:4}"
}

for features in "" std; do
    cargo check wasm32-unknown-unknown std,panic_abort --no-default-features --features "$features"
done
for target in aarch64-unknown-linux-gnu,std,panic_unwind,test wasm32-wasip1,std,panic_abort,test; do
    cargo test "${target%%,*}" "${target#*,}" --features scene-file --lib -- --include-ignored
    cargo test "${target%%,*}" "${target#*,}" --features scene-file --test suite golden
done
