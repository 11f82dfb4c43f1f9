#!/bin/bash
# Compiles all crates of the workspace with the oldest Rust version in Cargo.toml. Reports it if rustup cannot install that.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
version=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
if ! rustup run "$version" rustc --version >/dev/null 2>&1 \
    && ! timeout 120 rustup toolchain install "$version" --profile minimal >/dev/null 2>&1; then
    echo "Rust $version cannot be had here: not checked"
    exit 0
fi
rustup run "$version" cargo check --quiet --target-dir target/minimum --workspace --features midair/scene-file
