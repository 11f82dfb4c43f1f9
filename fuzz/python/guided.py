"""Fuzzes a function of bytes, guided by Atheris, which measures the coverage of the package.
With "replay", runs the function on the stored inputs.
"""

import sys
import tempfile
import warnings
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

try:
    import atheris
except ImportError:
    # A replay of stored inputs works without Atheris.
    atheris = None

with atheris.instrument_imports(include=["midair", "zipfile", "numpy.lib"]) if atheris else nullcontext():
    import midair
    import midair._sweep

#: Errors that a bad argument may raise: the package's, or Python's for a wrong number or name of arguments.
REFUSALS = (midair.SceneError, TypeError)

#: The stored inputs, one folder for each target.
CORPUS = Path(__file__).resolve().parent.parent / "corpus"


class Data:
    """Values computed from bytes. An input gives the same values with Atheris and without."""

    def __init__(self, content: bytes) -> None:
        self._left = content

    def remaining_bytes(self) -> int:
        """Returns how many bytes are left."""
        return len(self._left)

    def ConsumeBytes(self, count: int) -> bytes:
        """Returns the next `count` bytes, or fewer at the end."""
        found, self._left = self._left[: max(count, 0)], self._left[max(count, 0) :]
        return found

    def ConsumeInt(self, count: int) -> int:
        """Returns a signed whole number of `count` bytes."""
        return int.from_bytes(self.ConsumeBytes(count), "little", signed=True)

    def ConsumeIntInRange(self, low: int, high: int) -> int:
        """Returns a whole number between the bounds; the lower one if no bytes are left."""
        size = ((high - low).bit_length() + 7) // 8
        return low + int.from_bytes(self.ConsumeBytes(size), "little") % (high - low + 1)

    def ConsumeBool(self) -> bool:
        """Returns true or false."""
        return bool(self.ConsumeIntInRange(0, 1))

    def ConsumeFloat(self) -> float:
        """Returns any number, including infinite ones and NaN."""
        import struct

        return float(struct.unpack("<d", self.ConsumeBytes(8).ljust(8, b"\0"))[0])

    def PickValueInList(self, values: Sequence[Any]) -> Any:
        """Returns one of the values."""
        return values[self.ConsumeIntInRange(0, len(values) - 1)]


def folder() -> Path:
    """Returns a folder for this process only, in memory if possible."""
    memory = Path("/dev/shm")
    return Path(tempfile.mkdtemp(dir=memory if memory.is_dir() else None))


def spoilt(data: Data, content: bytes) -> bytes:
    """Returns the contents of a file with some bytes removed, inserted or changed."""
    found = bytearray(content)
    for _ in range(data.ConsumeIntInRange(1, 4)):
        at = data.ConsumeIntInRange(0, len(found))
        cut = data.ConsumeIntInRange(0, 8)
        found[at : at + cut] = data.ConsumeBytes(data.ConsumeIntInRange(0, 8))
    return bytes(found)


def refused(error: Exception) -> None:
    """Checks that an error message is one line, neither empty nor very long."""
    text = str(error)
    assert text.strip(), repr(error)
    assert "\n" not in text, text
    assert len(text) < 2000, text


def fuzz(test: Callable[[bytes], None]) -> None:
    """Runs libFuzzer with the options of the command line; with "replay", runs the stored inputs."""
    warnings.simplefilter("ignore")
    if sys.argv[1:] == ["replay"]:
        test(b"")
        for file in sorted((CORPUS / Path(sys.argv[0]).stem).glob("*")):
            test(file.read_bytes())
        return
    atheris.Setup(sys.argv, test)
    atheris.Fuzz()
