"""The files of a sweep: what it may write and replace, asked before any work is done."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from .._midair import SceneError
from .._support import kept, output
from .request import Request

TABLES = (".csv", ".parquet")

#: What marks a Zarr group as a sweep's, among its attributes, and what such a group may hold.
MARK = {"midair": "sweep"}
ARRAYS = ("drive", "scale", "pressures", "points", "targets")


def check(asked: Request, table: Path | None, drives: Path | None) -> Path | None:
    """Refuse files that cannot be written, or that no sweep made; returns the folder of finished chunks."""
    if table is not None:
        output.check(table, TABLES, asked.files)
        if table.suffix.lower() == ".parquet":
            _need("pyarrow", table)
    if drives is not None:
        _need("zarr", drives)
        check_drives(drives)
        _spare([*asked.files, *([] if table is None else [table])], drives)
        output.tidy(output.real(drives))
    beside = table or drives
    if beside is None:
        return None
    folder = beside.with_name(f".{beside.name}.chunks")
    kept.check(folder)
    return folder


def _need(package: str, path: Path) -> None:
    if find_spec(package) is None:
        raise SceneError(
            f'"{path}" needs {package}: pip install "midair[sweep]", or give a .csv and no drives'
        )


def _spare(files: Sequence[Path], drives: Path) -> None:
    """Refuse to replace a folder that files of the sweep lie in, whatever links lead there."""
    for file in files:
        if output.real(drives) in output.real(file).parents:
            raise SceneError(f'drives "{drives}" would replace "{file}" in it: give another name')


def check_drives(path: Path) -> None:
    """Refuse a folder of drives that cannot be made, or that is there and not a former sweep's."""
    if path.suffix != ".zarr":
        raise SceneError(f'drives "{path}" has another ending: give a name that ends in .zarr')
    check_replaceable(path)
    folder = output.real(path).parent
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
