#!/bin/bash
# Builds wheels for Linux on x86-64 and 64-bit ARM into dist, for glibc 2.17 and newer: Zig can link against old versions.
set -eu -o pipefail
cd "$(dirname "$0")/.."
.venv/bin/uv pip install --quiet --python .venv/bin/python --group wheels
for target in x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu; do
    rustup --quiet target add $target
    PATH="$PWD/.venv/bin:$PATH" .venv/bin/maturin build --release --zig --target $target --compatibility manylinux2014 \
        --out dist
done
ls -l dist/*.whl
