#!/bin/bash
# zig.sh TARGET COMMAND...: runs a command. Meanwhile Rust links by this script for glibc 2.17 and newer, which Zig can.
set -eu -o pipefail
[ -z "${ZIG_TARGET-}" ] || exec maturin zig cc -- -target "$ZIG_TARGET" "$@"
name=${1//-/_} bin=$(dirname "$(realpath "$0")")/../.venv/bin
export PATH="$bin:$PATH" ZIG_TARGET="${1%%-*}-linux-gnu.2.17" "CARGO_TARGET_${name^^}_LINKER=$(realpath "$0")"
exec "${@:2}"
