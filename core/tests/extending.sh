#!/bin/bash
# The steps of docs/extending.md, done to a copy of the core with the page's own words: its solver and its directivity
# compile without a warning, pass the tests that run over all of them and, the solver alone in the registry, the law book.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
export CARGO_INCREMENTAL=0
page=docs/extending.md copy=target/extending

words() { # the one thing in backquotes on the page that looks like this
    local found
    found=$(grep -o "\`$1\`" "$page" | tr -d '`' | sort -u)
    [ "$(wc -l <<<"$found")" = 1 ] && [ -n "$found" ] || { echo "extending: $page says not once: $1" >&2; exit 1; }
    echo "$found"
}

insert() { # what, after which line, into which file of the copy
    grep -q "$2" "$copy/$3" || { echo "extending: $3 has no line $2" >&2; exit 1; }
    sed -i "0,/$2/s//&\n$1/" "$copy/$3"
}

# Compiled for speed it would take minutes; the crates it depends on are those that were compiled before.
rm -rf "$copy"
mkdir -p "$copy"
cp -rp Cargo.toml Cargo.lock rustfmt.toml core "$copy"
sed -i 's/^members = .*/members = ["core"]/; /^exclude = /d' "$copy/Cargo.toml"
printf '\n[profile.test.package.midair]\nopt-level = 0\n' >>"$copy/Cargo.toml"

block() { # the first or second block of Rust
    awk -v wanted="$1" '/^```(rust|rs)$/ { count++; inside = 1; next } /^```$/ { inside = 0 } inside && count == wanted' "$page"
}

file=$(words 'core/src/solvers/two_phases\.rs')
module=$(words 'pub(crate) mod two_phases;')
name=$(words 'pub use [^`]*;')
entry=$(words 'Entry::of::<[^`]*>(),')
block 1 >"$copy/$file"
insert "$module" 'pub(crate) mod uniform;' core/src/solvers/mod.rs
insert "$name" 'pub use uniform::Uniform;' core/src/solvers/mod.rs
insert "    $entry" 'pub static SOLVERS.*' core/src/solvers/registry.rs

law=$(words 'core/src/scene/directivity/gauss\.rs')
listed=$(words '&gauss::LAW')
block 2 >"$copy/$law"
insert "$(words 'pub(crate) mod gauss;')" 'pub(crate) mod cos;' core/src/scene/directivity/mod.rs
sed -i "s/^static LAWS: \[&Law; 5\] = \[/static LAWS: [\&Law; 6] = [${listed/&/\\&}, /" "$copy/core/src/scene/directivity/mod.rs"

own=(--manifest-path "$copy/Cargo.toml" -p midair --features scene-file,parallel)
export CARGO_TARGET_DIR=$PWD/target
rustfmt --check --edition 2024 "$copy/$file" "$copy/$law"
cargo clippy --quiet "${own[@]}" -- -D warnings

# The law book over this solver alone.
sed -i '1a #![allow(unused_imports)]
/^    Entry::of::<[A-Z]/d' "$copy/core/src/solvers/registry.rs"
cat >"$copy/core/tests/suite/main.rs" <<'RUST'
//! The law book.
#![allow(dead_code, unreachable_pub, reason = "the other tests use the rest")]
mod laws;
mod motions;
mod oracle;
mod scenes;
RUST
cargo test --quiet "${own[@]}" --lib two_phases
cargo test --quiet "${own[@]}" --lib directivit
cargo test --quiet "${own[@]}" --lib eq_5
cargo test --quiet "${own[@]}" --test suite --test allocations -- --include-ignored
