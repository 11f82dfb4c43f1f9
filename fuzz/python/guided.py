"""Fuzzes a function of bytes, guided by Atheris, which measures the coverage of the package.
With "replay", runs the function on the stored inputs.
From the bytes come numbers, lists, and arrays of every type and memory layout.
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
    import numpy as np
    from numpy.typing import NDArray

    import midair
    import midair._sweep

#: Errors that a bad argument may raise: the package's, or Python's for a wrong number or name of arguments.
REFUSALS = (midair.SceneError, TypeError)

#: The stored inputs, one folder for each target.
CORPUS = Path(__file__).resolve().parent.parent / "corpus"


DTYPES = ["<f8", ">f8", "<f4", ">f4", "<f2", "<i8", "<i4", ">i2", "u1", "<c16", ">c8"]
DTYPES += ["?", "O", "U4", "S4", "M8[s]"]
ODD = [0, -1, 1, 2**31, 2**63, 2**64, 2**130, -(2**63), 1e-300, 1e300, 5e-324]
TEXTS = [
    "",
    "a\nb",
    "\ud800",
    *["greedy", "Fast", "uniform", "rows", "random", "clamp", "full", "l1", "max", "point", "piston"],
]
THINGS = [None, True, False, np.True_, ..., b"1", range(3), 1j, object(), np, {1, 2}]
SCALARS = [np.float64(0.5), np.float32(2), np.int64(3), np.uint8(4), np.complex64(1j)]


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


def odd(data: Data, depth: int = 3) -> Any:
    """Returns an arbitrary object."""
    kind = data.ConsumeIntInRange(0, 13)
    if kind <= 1:
        return data.ConsumeFloat()
    if kind == 2:
        return data.PickValueInList(ODD)
    if kind == 3:
        return data.ConsumeInt(4)
    if kind == 4:
        return data.PickValueInList(TEXTS)
    if kind == 5:
        return data.PickValueInList(THINGS)
    if kind == 6:
        return data.PickValueInList(SCALARS)
    if kind == 7:
        return {data.PickValueInList(TEXTS): odd(data, depth - 1) if depth else 1}
    if kind == 8:
        return endless() if data.ConsumeBool() else deep(data.ConsumeIntInRange(1, 3000))
    if kind <= 10 and depth:
        items = [odd(data, depth - 1) for _ in range(data.ConsumeIntInRange(0, 4))]
        return tuple(items) if kind == 9 else items
    shape = [data.ConsumeIntInRange(0, 4) for _ in range(data.ConsumeIntInRange(0, 4))]
    dtype = np.dtype(data.PickValueInList(DTYPES))
    content = data.ConsumeBytes(int(np.prod(shape)) * dtype.itemsize)
    if dtype.hasobject or len(content) < int(np.prod(shape)) * dtype.itemsize:
        return laid_out(data, np.zeros(shape).astype(dtype))
    return laid_out(data, np.frombuffer(content, dtype).reshape(shape))


def endless() -> list[Any]:
    """Returns a list that contains itself."""
    items: list[Any] = [0.0]
    items.append(items)
    return items


def deep(levels: int) -> list[Any]:
    """Returns a list that is nested `levels` times."""
    items: list[Any] = [0.0]
    for _ in range(levels):
        items = [items]
    return items


def numbers(data: Data, *shape: int, scale: float = 1.0) -> NDArray[np.float64]:
    """Returns multiples of a power of two, which have exact values in f32 and in every byte order."""
    count = int(np.prod(shape))
    values = [data.ConsumeIntInRange(-128, 127) / 1024 for _ in range(count)]
    return scale * np.array(values).reshape(shape)


def laid_out(data: Data, array: NDArray[Any]) -> Any:
    """Returns the same numbers in another memory layout."""
    way = data.ConsumeIntInRange(0, 11)
    if way == 1:
        return np.asfortranarray(array)
    if way == 2:
        return np.repeat(array, 2, axis=-1)[..., ::2] if array.ndim else array
    if way == 3:
        return array[::-1].copy()[::-1] if array.ndim else array
    if way == 4:
        return np.array(array.T, order="C").T
    if way == 5:
        return array.astype(array.dtype.newbyteorder())
    if way == 6:
        memory = np.zeros(array.nbytes + 1, np.uint8)[1:]
        if not array.dtype.hasobject:
            shifted = memory.view(array.dtype).reshape(array.shape)
            shifted[...] = array
            return shifted
    if way == 7:
        array = array.copy()
        array.flags.writeable = False
    if way == 8:
        return array.tolist()
    if way == 9:
        return np.ma.masked_array(array)
    if way == 10:
        return np.broadcast_to(array[:1], array.shape) if array.ndim and (array == array[:1]).all() else array
    if way == 11:
        return memoryview(np.ascontiguousarray(array)) if array.dtype.kind in "fiu" else array
    return array


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
