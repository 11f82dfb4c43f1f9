"""Guided fuzzing of a function of bytes, by Atheris over the package; or the inputs of the tree replayed."""

from __future__ import annotations

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
    # What replays inputs needs none.
    atheris = None

with atheris.instrument_imports(include=["midair", "zipfile", "numpy.lib"]) if atheris else nullcontext():
    import midair
    import midair._sweep

#: What a bad argument may raise: the package's error, or Python's for arguments of another number or name.
REFUSALS = (midair.SceneError, TypeError)

#: Inputs of the tree, a folder a target.
CORPUS = Path(__file__).resolve().parent.parent / "corpus"


class Data:
    """Values drawn from bytes: an input means the same with Atheris and without."""

    def __init__(self, content: bytes) -> None:
        self._left = content

    def remaining_bytes(self) -> int:
        """How many bytes are left."""
        return len(self._left)

    def ConsumeBytes(self, count: int) -> bytes:
        """So many bytes, fewer where they end."""
        found, self._left = self._left[: max(count, 0)], self._left[max(count, 0) :]
        return found

    def ConsumeInt(self, count: int) -> int:
        """A whole number of so many bytes, with a sign."""
        return int.from_bytes(self.ConsumeBytes(count), "little", signed=True)

    def ConsumeIntInRange(self, low: int, high: int) -> int:
        """A whole number between bounds, the lower one where no bytes are left."""
        size = ((high - low).bit_length() + 7) // 8
        return low + int.from_bytes(self.ConsumeBytes(size), "little") % (high - low + 1)

    def ConsumeBool(self) -> bool:
        """One or the other."""
        return bool(self.ConsumeIntInRange(0, 1))

    def ConsumeFloat(self) -> float:
        """A number of any size, infinite ones and those that are none among them."""
        import struct

        return float(struct.unpack("<d", self.ConsumeBytes(8).ljust(8, b"\0"))[0])

    def PickValueInList(self, values: Sequence[Any]) -> Any:
        """One of some values."""
        return values[self.ConsumeIntInRange(0, len(values) - 1)]


def folder() -> Path:
    """A folder of this process alone, in memory where there is such a thing."""
    memory = Path("/dev/shm")
    return Path(tempfile.mkdtemp(dir=memory if memory.is_dir() else None))


def spoilt(data: Data, content: bytes) -> bytes:
    """A file with some bytes cut, put in or changed."""
    found = bytearray(content)
    for _ in range(data.ConsumeIntInRange(1, 4)):
        at = data.ConsumeIntInRange(0, len(found))
        cut = data.ConsumeIntInRange(0, 8)
        found[at : at + cut] = data.ConsumeBytes(data.ConsumeIntInRange(0, 8))
    return bytes(found)


def refused(error: Exception) -> None:
    """A refusal is one line that says something."""
    text = str(error)
    assert text.strip(), repr(error)
    assert "\n" not in text, text
    assert len(text) < 2000, text


def fuzz(test: Callable[[bytes], None]) -> None:
    """Run libFuzzer by the command line's options, or, with "replay", the inputs of the tree."""
    warnings.simplefilter("ignore")
    if sys.argv[1:] == ["replay"]:
        test(b"")
        for file in sorted((CORPUS / Path(sys.argv[0]).stem).glob("*")):
            test(file.read_bytes())
        return
    atheris.Setup(sys.argv, test)
    atheris.Fuzz()
