"""Makes the pictures and tables of the pages: `make pictures` lists them, NAMES="motion touch" chooses some.

Each file in this folder has a function `main`, which writes pictures to docs/ and prints tables of the page
that its first line names. All numbers are judged in double precision by the references of python/tests.
"""

import ast
import sys
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).resolve().parent
#: What each file makes, by its name.
PICTURES = {
    path.stem: (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]
    for path in sorted(HERE.glob("[a-z]*.py"))
}


def main(*names: str) -> None:
    """Makes the pictures and tables of some files, or lists all files if none is named."""
    # The references come last, because some of their files have the names of these.
    sys.path[:] = [str(HERE.parent), *sys.path[1:], str(HERE.parents[1] / "python" / "tests")]
    if unknown := {*names} - PICTURES.keys():
        raise SystemExit(f"unknown {', '.join(sorted(unknown))}: known are {', '.join(PICTURES)}")
    for name in names:
        import_module(f"pictures.{name}").main()
    if not names:
        print("\n".join(f"{name:12}{line}" for name, line in PICTURES.items()))


if __name__ == "__main__":
    main(*sys.argv[1:])
