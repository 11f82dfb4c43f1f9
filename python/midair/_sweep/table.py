"""Output of a sweep, checked before any work: the table as CSV or Parquet, the drives as Zarr."""

import csv
import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from .._midair import stated
from .._support import cache, output
from .._support.cache import Arrays
from .._support.output import METRICS
from .block import trial_seed
from .engine import Job
from .request import Block, Request

#: Rows per chunk of the Zarr arrays with the drives.
ROWS = 1024


class Shortfall:
    """Counts problems whose targets cannot be reached, for one warning at the end."""

    def __init__(self) -> None:
        self.problems = self.beyond = self.weak = 0
        self.least = np.inf

    def add(self, arrays: Arrays) -> None:
        """Count the problems of one result."""
        beyond = arrays["beyond"]
        self.problems += len(beyond)
        self.beyond += int(beyond.sum())
        self.weak += int(arrays["weak"].sum())
        self.least = min(self.least, arrays["level"][beyond].min(initial=np.inf))

    def text(self) -> str:
        """Return the text of the warning, "" if there is nothing to report."""
        parts = []
        if self.beyond:
            parts.append(
                f"{self.beyond:,} of {self.problems:,} problems request more pressure than the array reaches"
                f" at a point, and get as little as {self.least:.2g} of it (column level): request less, or"
                " leave the pressure out for the balanced level"
            )
        if self.weak:
            parts.append(
                f"{self.weak:,} of {self.problems:,} problems request less than half the balanced level: foci"
                " this weak come out smeared, balance = true cures it"
            )
        return "; ".join(parts)


TABLES = (".csv", ".parquet")

#: The attribute that marks a Zarr group as made by a sweep, and the names of its arrays.
MARK = {"midair": "sweep"}
ARRAYS = ("drive", "scale", "pressures", "points", "targets")


def check(requested: Request, table: Path | None, drives: Path | None) -> Path | None:
    """Return the folder for unfinished results; reject files of a wrong kind or that cannot be written."""
    if table is not None:
        output.check(table, TABLES, requested.files)
        if table.suffix.lower() == ".parquet":
            _need("pyarrow", table)
    if drives is not None:
        _need("zarr", drives)
        check_drives(drives)
        _spare([*requested.files, *([] if table is None else [table])], drives)
        output.tidy(output.real(drives))
    beside = table or drives
    if beside is None:
        return None
    folder = beside.with_name(f".{beside.name}.chunks")
    cache.check(folder)
    return folder


def _need(package: str, path: Path) -> None:
    if find_spec(package) is None:
        cure = 'pip install "midair[sweep]", or give a .csv and no drives'
        raise stated(f'"{path}"', f"needs {package}", cure, code="missing")


def _spare(files: Sequence[Path], drives: Path) -> None:
    """Reject a folder for drives that contains files of the sweep, even by links: the folder is replaced."""
    for file in files:
        if output.real(drives) in output.real(file).parents:
            raise stated(f'drives "{drives}"', f'would replace "{file}" in it', "give another name")


def check_drives(path: Path) -> None:
    """Reject a folder for drives that cannot be made, or that exists and was not made by a sweep."""
    if path.suffix != ".zarr":
        raise stated(f'drives "{path}"', "has another ending", "give a name that ends in .zarr")
    check_replaceable(path)
    folder = output.real(path).parent
    if not folder.is_dir() or not os.access(folder, os.W_OK):
        cure = "make it first, or choose another"
        raise stated(f'folder "{folder}"', "cannot be written", cure, code="unwritable")


def check_replaceable(path: Path) -> None:
    """Reject a Zarr group if anything in it was not made by a sweep."""
    if not path.exists():
        return
    try:
        group = json.loads((path / "zarr.json").read_text(encoding="utf-8"))
        ours = MARK.items() <= group["attributes"].items()
        strange = {part.name for part in path.iterdir()} - {"zarr.json", *ARRAYS}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        ours, strange = False, set()
    if not ours:
        raise stated(f'drives "{path}"', "is there and was made by no sweep", "choose another name")
    if strange:
        cure = "choose another name"
        raise stated(f'drives "{path}"', f'holds "{min(strange)}", which no sweep made', cure)


Columns = dict[str, list[Any]]
Write = Callable[[Columns], None]


def rows(block: Block, job: Job, arrays: Arrays, first: int) -> Columns:
    """Return a result's part of the table; its first row has the index `first`."""
    count = job.stop - job.start
    return {
        "index": list(range(first, first + count)),
        **{name: [value] * count for name, value in block.columns.items()},
        "trial": [trial_seed(block.settings, index) for index in range(job.start, job.stop)],
        **{name: arrays[name].tolist() for name in (*METRICS, "status")},
    }


#: Type, shape of a row, and fill value of each array, by name.
Layout = dict[str, tuple[np.dtype[Any], tuple[int, ...], float]]


def _layout(blocks: Sequence[Block]) -> Layout:
    """Return the arrays of a group of drives, wide enough for the widest block."""
    settings = [block.settings for block in blocks]
    most = max(setting["count"] for setting in settings)
    wide = max(block.columns["transducers"] for block in blocks)
    layout: Layout = {
        "drive": (np.dtype(np.complex64), (wide,), 0.0),
        "scale": (np.dtype(float), (), 1.0),
        "pressures": (np.dtype(np.complex64), (most,), 0.0),
        "points": (np.dtype(float), (most, 3), np.nan),
    }
    if any(setting.get("pressure", setting.get("pressures")) is not None for setting in settings):
        layout["targets"] = (np.dtype(float), (most,), 0.0)
    return layout


def fits(job: Job, arrays: Arrays) -> bool:
    """Return whether a stored result has all arrays that the table, and the drives if requested, need."""
    block: Block = job.owner
    expected: Layout = dict.fromkeys(METRICS, (np.dtype(float), (), 0.0))
    expected |= dict.fromkeys(("beyond", "weak"), (np.dtype(bool), (), False))
    if block.settings["drives"]:
        expected |= _layout([block])
    status = arrays.get("status", np.empty(0)).dtype.kind == "U"
    found = {name: (array.dtype, array.shape[1:]) for name, array in arrays.items() if name != "status"}
    return status and found == {name: (dtype, shape) for name, (dtype, shape, _) in expected.items()}


@contextmanager
def temporary(path: Path) -> Iterator[Path]:
    """Yield a temporary path, which replaces `path` if no error occurs."""
    part = output.part_of(path)
    try:
        with output.refusing(f'"{path}"'):
            yield part
            if path.is_dir():
                # Another program may have written there meanwhile.
                check_replaceable(path)
                shutil.rmtree(path)
            part.replace(path)
    finally:
        if part.is_dir():
            shutil.rmtree(part, ignore_errors=True)
        part.unlink(missing_ok=True)


@contextmanager
def open_table(path: Path, request: Request) -> Iterator[Write]:
    """Open a table in the format of the path's ending; yields a function that takes columns of rows."""
    write = _parquet if path.suffix.lower() == ".parquet" else _csv
    with temporary(output.real(path)) as part, write(part, request) as give:
        yield give


@contextmanager
def _csv(path: Path, request: Request) -> Iterator[Write]:
    header = request.columns
    with path.open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(header)
        yield lambda columns: out.writerows(zip(*(columns[name] for name in header), strict=True))


@contextmanager
def _parquet(path: Path, request: Request) -> Iterator[Write]:
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    kinds = {name: _kind([block.columns[name] for block in request.blocks]) for name in request.names}
    kinds |= {"index": int, "trial": int, "status": str} | dict.fromkeys(METRICS, float)
    types = {bool: pa.bool_(), int: pa.int64(), float: pa.float64(), str: pa.string()}
    schema = pa.schema([(name, types[kinds[name]]) for name in request.columns])
    with ParquetWriter(path, schema) as out:

        def give(columns: Columns) -> None:
            plain = {
                name: [None if value is None else kinds[name](value) for value in columns[name]]
                for name in schema.names
            }
            out.write_table(pa.table(plain, schema=schema))

        yield give


def _kind(values: Sequence[Any]) -> type:
    """Return the type of all values of a column; str if they differ."""
    found = {type(value) for value in values if value is not None}
    if found == {int, float}:
        return float
    return found.pop() if len(found) == 1 and found <= {bool, int, float} else str


@contextmanager
def open_drives(path: Path, request: Request) -> Iterator[Callable[[Arrays, int], None]]:
    """Open a Zarr group with a row for each row of the table.

    Yields a function to call with a result and the index of its first row.

    Arrays: drive (rows, N), the resulting pressures (rows, M), complex64; scale (rows,); points (rows, M, 3)
    in m; targets (rows, M) in Pa if pressures were requested. N and M are the largest of the sweep. Unused
    elements are 0, of points NaN.
    """
    import zarr

    with temporary(output.real(path)) as part:
        layout = _layout(request.blocks)
        group = zarr.open_group(part, mode="w", attributes=dict(MARK))
        arrays = {
            name: group.create_array(
                name,
                shape=(request.problems, *shape),
                chunks=(min(request.problems, ROWS), *shape),
                dtype=dtype,
                fill_value=fill,
            )
            for name, (dtype, shape, fill) in layout.items()
        }
        # A chunk of the file is written once, when it is full.
        memory = {name: np.full((ROWS, *shape), fill, dtype) for name, (dtype, shape, fill) in layout.items()}
        filled = written = 0

        def flush() -> None:
            nonlocal filled, written
            for name, rows in memory.items():
                arrays[name][written : written + filled] = rows[:filled]
                rows[:] = layout[name][2]
            written, filled = written + filled, 0

        def give(chunk: Arrays, first: int) -> None:
            nonlocal filled
            count, taken = len(chunk["scale"]), 0
            while taken < count:
                more = min(count - taken, ROWS - filled)
                for name in arrays.keys() & chunk.keys():
                    values = chunk[name][taken : taken + more]
                    place = (slice(filled, filled + more), *(slice(length) for length in values.shape[1:]))
                    memory[name][place] = values
                filled, taken = filled + more, taken + more
                if filled == ROWS:
                    flush()

        yield give
        flush()


def as_columns(parts: Sequence[Mapping[str, list[Any]]], request: Request) -> dict[str, np.ndarray[Any, Any]]:
    """Return the whole table as arrays; a column with missing values has dtype object."""
    whole = {name: [value for part in parts for value in part[name]] for name in request.columns}
    return {
        name: np.array(values, object if None in values or len({type(v) for v in values}) > 1 else None)
        for name, values in whole.items()
    }
