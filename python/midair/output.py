"""Result files: drives as .npz, .csv and .json, every file written whole or not at all."""

from __future__ import annotations

import csv
import io
import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from ._midair import Scene, SceneError, Solution

DRIVES = (".npz", ".csv", ".json")
IMAGES = (".png", ".svg", ".pdf", ".jpg")


def check(path: Path, endings: tuple[str, ...]) -> None:
    """Refuse a path that nothing can be written to, before any work is done for it."""
    if path.suffix.lower() not in endings:
        raise SceneError(
            f'output "{path}" has no known ending: give {", ".join(endings[:-1])} or {endings[-1]}'
        )
    if path.is_dir():
        raise SceneError(f'output "{path}" is a folder: give a file')
    if not path.parent.is_dir():
        raise SceneError(f'output folder "{path.parent}" is not there: make it first')
    try:
        part = _part(path)
        part.touch()
        part.unlink()
    except OSError as error:
        reason = error.strerror or str(error)
        raise SceneError(
            f'output "{path}" cannot be written ({reason}): choose another name or folder'
        ) from error


def _part(path: Path) -> Path:
    """The temporary name beside it."""
    return path.with_name(f".{path.name}.{os.getpid()}.part")


def write(path: Path, content: bytes) -> None:
    """Write under a temporary name and rename, so that no reader ever meets half a file."""
    part = _part(path)
    try:
        part.write_bytes(content)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_drive(path: Path, scene: Scene, solution: Solution) -> None:
    """Write a drive as .npz, .csv or .json, by the path's ending (docs/conventions.md lists the keys)."""
    ending = path.suffix.lower()
    if ending == ".csv":
        content = _csv(scene, solution)
    elif ending == ".json":
        content = json.dumps(_record(scene, solution), default=_plain, allow_nan=False).encode()
    else:
        buffer = io.BytesIO()
        np.savez(buffer, **_record(scene, solution))
        content = buffer.getvalue()
    write(path, content)


def _record(scene: Scene, solution: Solution) -> dict[str, Any]:
    metrics = solution.metrics
    names = ("accuracy", "sigma", "uniformity", "level", "residual", "leak")
    return {
        "drive": solution.drive,
        "amplitudes": solution.amplitudes,
        "phases": solution.phases,
        "positions": scene.array.positions,
        "points": scene.points,
        "targets": solution.targets,
        "pressures": solution.pressures,
        "scale": solution.scale,
        **{name: getattr(metrics, name) for name in names},
        "steps": solution.steps,
        "elapsed": solution.elapsed,
        **({} if solution.trace is None else {"trace": solution.trace}),
        "scene": scene.json(solution),
        **({} if scene.solver is None else {"scene_solver": json.dumps(scene.solver)}),
    }


def _plain(value: Any) -> Any:
    """Arrays as lists, complex numbers as [re, im]."""
    array = np.asarray(value)
    if np.iscomplexobj(array):
        array = np.stack([array.real, array.imag], axis=-1)
    return array.tolist()


def _csv(scene: Scene, solution: Solution) -> bytes:
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["index", "x", "y", "z", "amplitude", "phase"])
    drives = zip(
        scene.array.positions.tolist(), solution.amplitudes.tolist(), solution.phases.tolist(), strict=True
    )
    for index, (position, amplitude, phase) in enumerate(drives):
        rows.writerow([index, *position, amplitude, phase])
    return text.getvalue().encode()
