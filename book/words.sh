#!/usr/bin/env bash
# Finds the words that docs/style.md replaces, in all texts and sources of the repository, for `make lint`.
# In Markdown, code spans and quotations do not count. Some uses are public names: the attribute `held` of midair.Rest and
# midair.Flight, "held out" for data sets, a message of serde.
set -eu
cd "$(dirname "$0")/.."
words=$(mktemp)
trap 'rm -f "$words"' EXIT
sed -nE 's/^\| `(\w+)` \| (.*) \|$/\1->\2,/p; s/^\| `(\w+)`, `(\w+)` \| (.*) \|$/\1->\3,\n\2->\3,/p' docs/style.md > "$words"
names='held[ _-]out|\.held\b|\bheld[:(]|"held"|(of|of \w+|\}|beads) held\b|\bheld, stiffness\b|::Held\b|\bHeld,|lone leading surrogate'
find() { git ls-files -z "$@" | xargs -0 "${CODESPELL:-.venv/bin/codespell}" --skip '' --quiet-level 3 -D "$words" --regex '[A-Za-z]+' --ignore-regex "$ignored"; }
ignored=$names
find '*.c' '*.cpp' '*.cs' '*.h' '*.hpp' '*.mjs' '*.py' '*.pyi' '*.rs' '*.sh' '*.toml' '*.ts' '*.vhd' '*.yml' ':!book/words.sh'
ignored="$names|\`[^\`]+\`|\"[^\"]+\""
find '*.md' ':!docs/map.md' ':!docs/style.md'
