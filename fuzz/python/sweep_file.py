"""The reader of sweep files: any text gives an error of one line, or a sweep with at least one problem."""

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
            # A missing scene file raises an error of Python itself.
            refused(error)


fuzz(test)
