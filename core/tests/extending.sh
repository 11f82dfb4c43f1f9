#!/bin/bash
# Does the steps of docs/extending.md in a copy of the core, with the text of that page. Its solver and its directivity must
# compile without warnings and pass the tests that run for all solvers and directivities. With the solver alone in the
# registry, the laws must pass too. Then trials.sh adds a key of the medium, a board and an obstacle to the copy.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
export CARGO_INCREMENTAL=0
page=docs/extending.md copy=target/extending

words() { # prints the only code span on the page that matches a pattern
    local found
    found=$(grep -o "\`$1\`" "$page" | tr -d '`' | sort -u)
    [ "$(wc -l <<<"$found")" = 1 ] && [ -n "$found" ] || { echo "extending: $page says not once: $1" >&2; exit 1; }
    echo "$found"
}

touched=()

create() { # writes stdin to a new file of the copy
    touched+=("$1")
    cat >"$copy/$1"
}

after() { # TEXT FILE: inserts stdin below the first line that contains the text
    touched+=("$2")
    TEXT=$(cat) MARK=$1 awk '{ print } !done && index($0, ENVIRON["MARK"]) { print ENVIRON["TEXT"]; done = 1 }
        END { exit !done }' "$copy/$2" >"$copy/after" || { echo "extending: $2 has no line $1" >&2; exit 1; }
    mv "$copy/after" "$copy/$2"
}

swap() { # OLD NEW FILE: replaces a text by another
    touched+=("$3")
    grep -qF "$1" "$copy/$3" || { echo "extending: $3 has no $1" >&2; exit 1; }
    OLD=$1 NEW=$2 awk '!done && (at = index($0, ENVIRON["OLD"])) {
        $0 = substr($0, 1, at - 1) ENVIRON["NEW"] substr($0, at + length(ENVIRON["OLD"])); done = 1 } { print }' \
        "$copy/$3" >"$copy/after"
    mv "$copy/after" "$copy/$3"
}

append() { # appends stdin to a file of the copy
    touched+=("$1")
    cat >>"$copy/$1"
}

at_most() { # COUNT NAME: checks how many files the trial has changed
    local count
    count=$(printf '%s\n' "${touched[@]}" | sort -u | wc -l)
    echo "extending: $2 touches $count files, $1 at most"
    [ "$count" -le "$1" ] || { printf '%s\n' "${touched[@]}" | sort -u >&2; exit 1; }
    touched=()
}

noted() { # adds a line to CHANGELOG.md
    after '## ' CHANGELOG.md <<<"- **$1**, a trial."
}

# An optimised build would take minutes. The copy reuses the dependencies that are already compiled.
rm -rf "$copy"
mkdir -p "$copy"
cp -rp Cargo.toml Cargo.lock rustfmt.toml CHANGELOG.md core python "$copy"
mkdir "$copy/docs"
cp -p docs/*.md "$copy/docs"
sed -i 's/^members = .*/members = ["core", "python"]/; /^exclude = /d' "$copy/Cargo.toml"
printf '\n[profile.test.package.midair]\nopt-level = 0\n' >>"$copy/Cargo.toml"

block() { # prints the first or second block of Rust on the page
    awk -v wanted="$1" '/^```(rust|rs)$/ { count++; inside = 1; next } /^```$/ { inside = 0 } inside && count == wanted' "$page"
}

file=$(words 'core/src/solvers/two_phases\.rs')
module=$(words 'pub(crate) mod two_phases;')
name=$(words 'pub use [^`]*;')
entry=$(words 'Entry::of::<[^`]*>(),')
create "$file" < <(block 1)
after 'pub(crate) mod uniform;' core/src/solvers/mod.rs <<<"$module"
after 'pub use uniform::Uniform;' core/src/solvers/mod.rs <<<"$name"
after 'pub static SOLVERS' core/src/solvers/registry.rs <<<"    $entry"
at_most 3 'a solver, without its documentation,'

law=$(words 'core/src/scene/directivity/gauss\.rs')
create "$law" < <(block 2)
after 'pub(crate) mod cos;' core/src/scene/directivity/mod.rs <<<"$(words 'pub(crate) mod gauss;')"
swap '[&Law; 5] = [' "[&Law; 6] = [$(words '&gauss::LAW'), " core/src/scene/directivity/mod.rs
after '| `"point"` |' docs/conventions.md <<<'| `gauss` | a trial |'
noted gauss
at_most 4 'a directivity'

. core/tests/trials.sh

own=(--manifest-path "$copy/Cargo.toml" -p midair --features scene-file)
export CARGO_TARGET_DIR=$PWD/target
rustfmt --check --edition 2024 "$copy/$file" "$copy/$law"
cargo clippy --quiet "${own[@]}" -- -D warnings
cargo check --quiet --manifest-path "$copy/Cargo.toml" -p midair-python
python3 -m py_compile "$copy"/python/tests/{firmware,test_obstacles}.py "$copy"/python/midair/{__init__,_pictures/panel}.py

# Runs the tests of laws.rs with this solver alone in the registry.
sed -i '1a #![allow(unused_imports)]
/^    Entry::of::<[A-Z]/d' "$copy/core/src/solvers/registry.rs"
cat >"$copy/core/tests/suite/main.rs" <<'RUST'
//! The law book.
#![allow(dead_code, unreachable_pub, reason = "the other tests use the rest")]
mod boards;
mod laws;
mod motions;
mod oracle;
mod scenes;
RUST
cargo test --quiet "${own[@]}" --lib -- two_phases directivit eq_5 nonlinearity bubble
MIDAIR_GOLDEN=write cargo test --quiet "${own[@]}" --test suite --test allocations -- --include-ignored
