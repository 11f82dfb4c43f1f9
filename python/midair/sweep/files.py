"""The files of a sweep: what it may write and replace, asked before any work is done."""

from __future__ import annotations

import glob
import json
import os
import shutil
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from .. import output
from .._midair import SceneError
from . import chunks
from .request import Request

TABLES = (".csv", ".parquet")

#: What marks a Zarr group as a sweep's, among its attributes, and what such a group may hold.
MARK = {"midair": "sweep"}
ARRAYS = ("drive", "scale", "pressures", "points", "targets")


def check(asked: Request, table: Path | None, drives: Path | None) -> Path | None:
    """Refuse files that cannot be written, or that no sweep made; returns the folder of finished chunks."""
    if table is not None:
        tidy(table)
        output.check(table, TABLES)
        _spare(asked.files, table)
        if table.suffix.lower() == ".parquet":
            _need("pyarrow", table)
    if drives is not None:
        _need("zarr", drives)
        tidy(real(drives))
        check_drives(drives)
        _spare([*asked.files, *([] if table is None else [table])], drives)
    beside = table or drives
    if beside is None:
        return None
    kept = beside.with_name(f".{beside.name}.chunks")
    chunks.check(kept)
    return kept


def real(path: Path) -> Path:
    """Where links lead to."""
    return Path(os.path.realpath(path))


def _need(package: str, path: Path) -> None:
    if find_spec(package) is None:
        raise SceneError(
            f'"{path}" needs {package}: pip install "midair[sweep]", or give a .csv and no drives'
        )


def _spare(files: Sequence[Path], path: Path) -> None:
    """Refuse to write over files that are read, or a folder that they lie in, whatever links lead there."""
    for file in files:
        same = path.exists() and file.exists() and path.samefile(file)
        if same or real(path) in real(file).parents:
            raise SceneError(
                f'output "{path}" would replace "{file}", which the sweep needs: choose another name'
            )


def part_of(path: Path) -> Path:
    """The temporary name beside a path, of this process."""
    return path.with_name(f".{path.name}.{os.getpid()}.part")


def tidy(path: Path) -> None:
    """Remove what processes that are no more have left half written beside a path."""
    for part in path.parent.glob(f".{glob.escape(path.name)}.*.part"):
        process = part.name.split(".")[-2]
        if process.isdecimal() and not _alive(int(process)):
            remove(part)


def remove(path: Path) -> None:
    """Remove a file or a whole folder, if it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def check_drives(path: Path) -> None:
    """Refuse a folder of drives that cannot be made, or that is there and not a former sweep's."""
    if path.suffix != ".zarr":
        raise SceneError(f'drives "{path}" has another ending: give a name that ends in .zarr')
    check_replaceable(path)
    folder = real(path).parent
    if not folder.is_dir() or not os.access(folder, os.W_OK):
        raise SceneError(f'folder "{folder}" cannot be written: make it first, or choose another')


def check_replaceable(path: Path) -> None:
    """Refuse to replace what is not wholly a former sweep's group of drives."""
    if not path.exists():
        return
    try:
        group = json.loads((path / "zarr.json").read_text(encoding="utf-8"))
        ours = MARK.items() <= group["attributes"].items()
        strange = {part.name for part in path.iterdir()} - {"zarr.json", *ARRAYS}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        ours, strange = False, set()
    if not ours:
        raise SceneError(f'drives "{path}" is there and was made by no sweep: choose another name')
    if strange:
        raise SceneError(f'drives "{path}" holds "{min(strange)}", which no sweep made: choose another name')
