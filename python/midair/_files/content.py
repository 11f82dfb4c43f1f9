"""What a file holds, read whole up to a limit; what is wrong with it, told by file, line, value and cure."""

from __future__ import annotations

import zlib
from os import PathLike
from pathlib import Path

from .._midair import SceneError

#: In bytes, of a file and of what it unpacks to. A drive of 512 transducers is 5 kB at most: 50 000 frames.
MOST_BYTES = 256 << 20


def fault(path: str | PathLike[str], line: int | None, reason: str) -> SceneError:
    """What is wrong with a file, in one line."""
    place = f'file "{path}"' if line is None else f'file "{path}", line {line}'
    return SceneError(" ".join(f"{place}: {reason}".split()))


def content(path: str | PathLike[str], most: int = MOST_BYTES, *, empty: bool = False) -> bytes:
    """The bytes of a file, which may be empty."""
    file = Path(path)
    try:
        if file.exists() and not file.is_file():
            raise fault(path, None, "it is a folder, device or pipe: give a file")
        with file.open("rb") as stream:
            found = stream.read(most + 1)
    except OSError as error:
        reason = error.strerror or str(error)
        raise fault(path, None, f"it cannot be read ({reason}): give a file that is there") from error
    if len(found) > most:
        raise fault(path, None, f"it is larger than {most >> 20} MB: give a smaller one")
    if not found and not empty:
        raise fault(path, None, "it is empty: give a file with something in it")
    return found


def text(path: str | PathLike[str], found: bytes | None = None) -> str:
    """The text of a file, UTF-8."""
    try:
        return (content(path) if found is None else found).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise fault(path, None, "it is no text: give a text file in UTF-8") from error


def unpacked(path: str | PathLike[str], found: bytes, kind: str, most: int = MOST_BYTES) -> bytes:
    """What zlib has packed, "gzip" or "zlib", and no more than `most` of it."""
    packed = zlib.decompressobj(31 if kind == "gzip" else 15)
    try:
        whole = packed.decompress(found, most + 1)
    except zlib.error as error:
        raise fault(path, None, f"its {kind} data are damaged: get the file again") from error
    if len(whole) > most:
        raise fault(path, None, f"it unpacks to more than {most >> 20} MB: give a smaller one")
    if not packed.eof:
        raise fault(path, None, f"its {kind} data end too soon: get the file again")
    if packed.unused_data:
        raise fault(path, None, f"something follows its {kind} data: get the file again")
    return whole
