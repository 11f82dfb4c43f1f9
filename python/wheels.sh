#!/bin/bash
# wheels.sh [FOLDER] [TARGET...]: builds wheels for Linux into dist or FOLDER, by default for x86-64 and 64-bit ARM, for
# glibc 2.17 and newer.
set -eu -o pipefail
cd "$(dirname "$0")/.."
out=${1:-dist}
.venv/bin/uv pip install --quiet --python .venv/bin/python --group wheels
for target in "${@:2}" $([ $# -gt 1 ] || echo x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu); do
    rustup --quiet target add "$target"
    python/zig.sh "$target" maturin build --release --target "$target" --compatibility manylinux2014 --out "$out"
done
ls -l "$out"/*.whl
