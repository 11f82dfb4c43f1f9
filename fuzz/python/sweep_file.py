"""The reader of sweep files: any text is refused in one line, or is a sweep of so many problems."""

from __future__ import annotations

from guided import REFUSALS, folder, fuzz, refused
from midair._sweep.request import read

FOLDER = folder()
FILES = [FOLDER / "sweep.toml", FOLDER / "sweep.json"]


def test(content: bytes) -> None:
    for file in FILES:
        file.write_bytes(content)
        try:
            assert read(file).problems > 0
        except (*REFUSALS, OSError) as error:
            # A scene file that is not there is Python's own error.
            refused(error)


fuzz(test)
