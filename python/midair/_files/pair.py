"""Ultraino's pair of `.csv` (ImportAnimationForm.java): phases in rad and, beside them, amplitudes 0 to 1.

There is no header; a row is a frame, a column a transducer, in the order of their numbers. Ultraino finds the
amplitudes by putting 0_Amp where the name of the phases has 0_Phase.
"""

from __future__ import annotations

from contextlib import ExitStack
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._midair import SceneError
from .._motion.files import whole
from .._support.text import fault, numbers, rows, text
from .played import Played, one_or_more

PHASE, AMPLITUDE = "Phase", "Amp"
NAMED = f"0_{PHASE}"


def write(path: Path, drives: Played) -> None:
    """Write both files, each whole or not at all."""
    if NAMED not in path.name:
        cure = f'put {NAMED} into the name, as in "{path.stem}{NAMED}.csv", or Ultraino finds no amplitudes'
        raise SceneError(f'output "{path}" is the phases of a pair: {cure}')
    beside = path.with_name(path.name.replace(NAMED, f"0_{AMPLITUDE}"))
    with ExitStack() as opened:
        parts = [opened.enter_context(whole(one, (".csv",))) for one in (beside, path)]
        amplitudes, phases = [
            opened.enter_context(part.open("w", encoding="ascii", newline="\n")) for part in parts
        ]
        for drive in drives:
            for stream, values in ((amplitudes, np.abs(drive).clip(0, 1)), (phases, np.angle(drive))):
                stream.write(",".join(f"{value:.9g}" for value in values.tolist()) + "\n")


def partners(path: str | PathLike[str]) -> tuple[Path, Path] | None:
    """The files of phases and of amplitudes, if the name belongs to a pair."""
    name = Path(path)
    for one, other in ((PHASE, AMPLITUDE), (AMPLITUDE, PHASE)):
        if one in name.name:
            both = name, name.with_name(other.join(name.name.rsplit(one, 1)))
            return both if one == PHASE else both[::-1]
    return None


def read(phases: Path, amplitudes: Path) -> NDArray[np.complex64]:
    """Read drives, (N,) of one frame, else (T, N)."""
    if not amplitudes.exists():
        raise fault(phases, None, f'its amplitudes, "{amplitudes.name}", are not beside it: put them there')
    if not phases.exists():
        raise fault(amplitudes, None, f'its phases, "{phases.name}", are not beside it: put them there')
    turned, sizes = _frames(phases), _frames(amplitudes)
    if turned.shape != sizes.shape:
        (frames, transducers), reported = turned.shape, f"{sizes.shape[0]} x {sizes.shape[1]} amplitudes"
        raise fault(amplitudes, None, f"{reported}: give as many as phases, {frames} x {transducers}")
    wrong = np.argwhere((sizes < 0) | (sizes > 1))
    if len(wrong):
        frame, column = wrong[0]
        value = f"amplitude {sizes[frame, column]:g} in frame {frame}, column {column + 1}"
        raise fault(amplitudes, None, f"{value}: give 0 to 1")
    return one_or_more((sizes * np.exp(1j * turned)).astype(np.complex64))


def _frames(path: Path) -> NDArray[np.float64]:
    found: list[NDArray[np.float64]] = []
    for line, row in rows(text(path)):
        values = numbers(path, line, row)
        if found and len(values) != len(found[0]):
            raise fault(path, line, f"{len(values)} columns: give {len(found[0])}, as in the first row")
        found.append(values)
    if not found:
        raise fault(path, None, "no row is in it: give a row of numbers for each frame")
    return np.array(found)
