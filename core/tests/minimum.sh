#!/bin/bash
# Every crate of the workspace by the oldest Rust that Cargo.toml names, where rustup can get it; says so where it cannot.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
version=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
if ! rustup run "$version" rustc --version >/dev/null 2>&1 \
    && ! timeout 120 rustup toolchain install "$version" --profile minimal >/dev/null 2>&1; then
    echo "Rust $version cannot be had here: not checked"
    exit 0
fi
rustup run "$version" cargo check --quiet --target-dir target/minimum --workspace --features midair/scene-file,midair/parallel
