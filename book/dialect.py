"""Counts the words that docs/style.md replaces, in all texts and sources of the repository,
for `make lint`.
"""

import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
#: The allowed number; a change may lower it but not raise it.
MOST = 19
#: Files generated from texts that are counted where they are written.
GENERATED = {"docs/map.md", "docs/scene.schema.json", "docs/sweep.schema.json", "capi/include/midair.h"}
#: Uses of the words that do not count: public names (an attribute of midair.Rest, the ends of a track), and
#: the term "held out" for data sets.
PUBLIC = r"held[ _-]out|\.held\b|\bheld(?=: |\()|::Held\b|\bHeld,"
TEXTS = (
    ".c", ".cpp", ".cs", ".h", ".hpp", ".md", ".mjs", ".py", ".pyi", ".rs", ".sh", ".toml", ".ts", ".vhd",
    ".yml",
)  # fmt: skip


def words(page: str) -> list[str]:
    """Returns the words in code spans in the first column of the style page's table."""
    rows = re.findall(r"^\| (`[^|]+) \|", page, re.MULTILINE)
    return [word for row in rows for word in re.findall(r"`(\w+)`", row)]


def prose(text: str, markdown: bool) -> str:
    """Returns the text without public names, and without code spans and quotations if it is Markdown."""
    text = re.sub(PUBLIC, "", text)
    return re.sub(r"`[^`\n]+`|\"[^\"\n]+\"", "", text) if markdown else text


def counts(pattern: re.Pattern[str]) -> dict[str, int]:
    """Returns how often the pattern's words occur in each file, also as parts of longer names."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    files = [name for name in listed.stdout.splitlines() if name.endswith(TEXTS) and name not in GENERATED]
    texts = {name: ROOT.joinpath(name) for name in files}
    found = {
        name: len(pattern.findall(prose(path.read_text(errors="replace"), name.endswith(".md"))))
        for name, path in texts.items()
        if path.is_file()
    }
    return {name: count for name, count in found.items() if count}


def main() -> None:
    """Prints the number and the files with most of the words;
    fails if the number is above the allowed one.
    """
    listed = words(ROOT.joinpath("docs", "style.md").read_text())
    pattern = re.compile(rf"(?<![A-Za-z])(?:{'|'.join(listed)})(?![A-Za-z])", re.IGNORECASE)
    found = counts(pattern)
    total = sum(found.values())
    print(f"words that docs/style.md replaces: {total}, at most {MOST}")
    if total > MOST or "--list" in sys.argv:
        for name, count in Counter(found).most_common(None if "--list" in sys.argv else 20):
            print(f"{count:6} {name}")
    if total > MOST:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
