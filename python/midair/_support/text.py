"""Files of other programs: read up to a size limit, never executed.

Errors state file, line, value and cure.
"""

import io
import os
import tomllib
import zipfile
import zlib
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from html import escape
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from .._midair import SceneError, memory_limit, restated, stated
from .arguments import needs

#: Largest size in bytes of a file and of its unpacked content: 50 000 frames of 512 transducers, of at most
#: 5 kB each.
MOST_BYTES = 256 << 20


def meanings(table: str) -> dict[str, str]:
    """Return the meaning of each column of a printed table by its heading, from columns.toml."""
    found = tomllib.loads(Path(__file__).with_name("columns.toml").read_text(encoding="utf-8"))[table]
    return {str(head): str(meaning) for head, meaning in found.items()}


def fault(path: str | PathLike[str], line: int | None, words: str | SceneError, cure: str = "") -> SceneError:
    """Return the error about a faulty file, in one line."""
    place = f'file "{path}"' if line is None else f'file "{path}", line {line}'
    error = stated("", words, cure, "unreadable") if isinstance(words, str) else words
    return restated(error, inside=place)


@contextmanager
def reading(kind: str, path: str | PathLike[str], cure: str) -> Iterator[None]:
    """Raise a SceneError that names the file if a block cannot read it, whatever its content is."""
    file = f'{kind} file "{" ".join(str(path).split())}"'
    try:
        yield
    except SceneError as error:
        raise restated(error, inside=file) from error
    except OSError:
        raise
    # zip, NumPy and JSON raise errors of many kinds for a damaged file.
    except Exception as error:
        raise stated(file, "is damaged, or none", cure, code="unreadable") from error


def no_file() -> SceneError:
    """Return the error about a path that is no file.

    A pipe or a device may send data without end, so it is not read.
    """
    return stated("it", "is a folder, device or pipe", "give a file", "unreadable")


def _no_file(file: Path) -> bool:
    """Return whether the path exists and is no regular file."""
    return file.exists() and not file.is_file()


def content(path: str | PathLike[str], most: int = MOST_BYTES, *, empty: bool = False) -> bytes:
    """Return the bytes of a file: at most `most`, and at most the limit MIDAIR_MEMORY.

    `empty` allows empty files.
    """
    file, most = Path(path), min(most, memory_limit())
    try:
        fit = b"\0" not in os.fsencode(file)
    except UnicodeEncodeError:
        fit = False
    if not fit:
        raise stated("a name", "of a file has a character that no file can have", "give the name of a file")
    try:
        if _no_file(file):
            raise fault(path, None, no_file())
        with file.open("rb") as stream:
            found = stream.read(most + 1)
    except OSError as error:
        reason = error.strerror or str(error)
        raise fault(path, None, f"it cannot be read ({reason})", "give a file that is there") from error
    if len(found) > most:
        raise fault(path, None, f"it is larger than {_size(most)}", "give a smaller one")
    if not found and not empty:
        raise fault(path, None, "it is empty", "give a file with something in it")
    return found


def arrays(path: str | PathLike[str], only: Collection[str] | None = None) -> dict[str, NDArray[Any]]:
    """Return arrays of an .npz file, all or those in `only`, unpacked up to the limit MIDAIR_MEMORY.

    Raises OSError if the file cannot be opened, SceneError if it is too large, and ValueError if it is
    damaged.
    """
    if _no_file(Path(path)):
        raise no_file()
    with open(path, "rb") as stream:
        try:
            with zipfile.ZipFile(stream) as archive:
                sizes = {part.filename.removesuffix(".npy"): part.file_size for part in archive.infolist()}
            names = [name for name in sizes if only is None or name in only]
            needed = sum(sizes[name] for name in names)
            if needed > memory_limit():
                reported = f"unpacks to {_size(needed)}, more than the {_size(memory_limit())} allowed"
                raise stated("it", reported, "give a smaller one, or raise MIDAIR_MEMORY")
            with np.load(stream, allow_pickle=False) as found:
                return {name: found[name] for name in names}
        except SceneError:
            raise
        # zip and NumPy raise errors of many kinds for a damaged file.
        except Exception as error:
            raise ValueError(f"no .npz: {error}") from error


def array(path: str | PathLike[str]) -> NDArray[Any]:
    """Return the array of a .npy file. Raises ValueError if it is damaged."""
    found = io.BytesIO(content(path))
    try:
        whole: NDArray[Any] = npy.read_array(found, allow_pickle=False)
    except Exception as error:
        raise ValueError(f"no .npy: {error}") from error
    return whole


def _size(count: int) -> str:
    """Return a number of bytes as text."""
    return f"{count >> 20} MB" if count >= 1 << 20 else f"{count} bytes"


def text(path: str | PathLike[str], found: bytes | None = None) -> str:
    """Return the text of a file in UTF-8, or in UTF-16 with a byte order mark, as Excel writes it."""
    data = content(path) if found is None else found
    try:
        return data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError as error:
        raise fault(path, None, "it is no text", "give a text file in UTF-8") from error


def unpacked(path: str | PathLike[str], found: bytes, kind: str, most: int = MOST_BYTES) -> bytes:
    """Return the unpacked bytes of "gzip" or "zlib" data; rejects more than `most` bytes."""
    packed = zlib.decompressobj(31 if kind == "gzip" else 15)
    try:
        whole = packed.decompress(found, most + 1)
    except zlib.error as error:
        raise fault(path, None, f"its {kind} data are damaged", "get the file again") from error
    if len(whole) > most:
        raise fault(path, None, f"it unpacks to more than {most >> 20} MB", "give a smaller one")
    if not packed.eof:
        raise fault(path, None, f"its {kind} data end too soon", "get the file again")
    if packed.unused_data:
        raise fault(path, None, f"something follows its {kind} data", "get the file again")
    return whole


def rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the cells of each line, without empty lines and those that begin with #."""
    for line, row in enumerate(text.splitlines(), 1):
        if row.strip() and not row.lstrip().startswith("#"):
            yield line, cells(row)


def cells(row: str) -> list[str]:
    """Return the cells of a row."""
    separator = next((mark for mark in ";\t" if mark in row), ",")
    return [cell.strip().strip('"').strip() for cell in row.split(separator)]


def number(cell: str) -> float | None:
    """Return a finite number, None for any other text."""
    try:
        found = float(cell) if "_" not in cell else np.nan
    except ValueError:
        return None
    return found if np.isfinite(found) else None


def numbers(
    path: str | PathLike[str], line: int, found: Sequence[str], names: Sequence[str] = ()
) -> NDArray[np.float64]:
    """Return a row of finite numbers. Errors name the column by `names`, or by its number."""
    try:
        row = np.array(found, np.float64)
    except ValueError:
        row = np.array([np.nan])
    # Python's number syntax allows underscores; files must not have them.
    if not np.isfinite(row).all() or "_" in "".join(found):
        for index, cell in enumerate(found):
            if number(cell) is None:
                name = names[index] if index < len(names) else f"column {index + 1}"
                raise fault(path, line, f'{name} is "{cell}"', "give a finite number")
    return row


def counted(count: int, thing: str) -> str:
    """Return a number and a noun: "1 point", "2 points"."""
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def plain(columns: Mapping[str, list[str]]) -> str:
    """Return a table as text: a heading, a rule and one line per row."""
    lines = list(zip(*([name, *column] for name, column in columns.items()), strict=True))
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    texts = ["  ".join(map(str.ljust, line, widths)).rstrip() for line in lines]
    return "\n".join([texts[0], "-" * (sum(widths) + 2 * (len(widths) - 1)), *texts[1:]])


def facts(*rows: tuple[str, object]) -> str:
    """Return names and values as an HTML table."""
    cells = (f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows)
    return f"<table>{''.join(cells)}</table>"


class Facts(ABC):
    """Base class of results that print as lines of a name and a value."""

    @abstractmethod
    def _rows(self) -> list[tuple[str, str]]:
        """Return the names and values."""

    def __repr__(self) -> str:
        return "\n".join(f"{name:18}  {value}" for name, value in self._rows())

    def _repr_html_(self) -> str:
        return facts(*self._rows())


def html(columns: Mapping[str, list[str]], caption: str = "") -> str:
    """Return a table as HTML, with a caption if given."""
    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    rows = zip(*columns.values(), strict=True)
    body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    above = f"<caption>{escape(caption)}</caption>" if caption else ""
    return f"<table>{above}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


#: Endings of tables that are text or lists in JSON; and of arrays of NumPy and MATLAB.
TEXTS, ARRAYS = (".csv", ".txt", ".tsv", ".dat"), (".npy", ".npz", ".mat")


def table(path: str | PathLike[str]) -> bytes:
    """Return the bytes of a table as the core reads it: text, JSON or .npy."""
    ending = Path(path).suffix.lower()
    if ending not in ARRAYS:
        return content(path, empty=True)
    try:
        found = array(path) if ending == ".npy" else _only(path, arrays(path) if ending == ".npz" else _matlab(path))
        if np.iscomplexobj(found):
            raise fault(path, None, "its numbers are complex", "give real numbers in m")
        numbers = np.ascontiguousarray(found, "<f8")
    except SceneError:
        raise
    except (ValueError, TypeError) as error:
        raise fault(path, None, f"its numbers cannot be read ({error})", "give an array (N, 3)") from error
    packed = io.BytesIO()
    np.save(packed, numbers)
    return packed.getvalue()


def _matlab(path: str | PathLike[str]) -> dict[str, Any]:
    """Return the arrays of a .mat file; those of version 7.3 are HDF5, which SciPy does not read."""
    with needs("a .mat file needs SciPy", "mesh"):
        from scipy.io import loadmat
    try:
        found = loadmat(io.BytesIO(content(path)))
    except SceneError:
        raise
    # SciPy raises errors of many kinds for a damaged file, and NotImplementedError for version 7.3.
    except Exception as error:
        cure = 'save it by save(name, variable, "-v7")'
        raise fault(path, None, "SciPy cannot read it, damaged or of version 7.3", cure) from error
    return {name: value for name, value in found.items() if not name.startswith("__")}


def _only(path: str | PathLike[str], found: dict[str, Any]) -> Any:
    """Return the positions among named arrays: `positions`, x, y and z, or the only one."""
    if "positions" in found:
        return found["positions"]
    if {"x", "y", "z"} <= set(found):
        return np.stack([np.ravel(found[axis]) for axis in "xyz"], axis=1)
    if len(found) == 1:
        return next(iter(found.values()))
    names = ", ".join(found) or "none"
    raise fault(path, None, f"its arrays are {names}", "give one array (N, 3), or name it positions")
