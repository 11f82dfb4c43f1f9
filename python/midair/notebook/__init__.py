"""What notebooks show: arrays, scenes, solutions, fields, sequences and the list of solvers as HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from .._midair import Array, Batch, Field, Scene, Solution, SolverInfo
from .above import above, trails

if TYPE_CHECKING:
    from ..motion.frames import Frames

#: The most rows shown of a list of points or problems.
MOST = 12


class Solvers(dict[str, SolverInfo]):
    """The solvers by name: a dictionary that prints one a line."""

    def __repr__(self) -> str:
        width = max(map(len, self), default=0)
        return "\n".join(f"{name:{width}}  {info.summary}" for name, info in self.items())

    def _repr_html_(self) -> str:
        rows = [(name, info.summary, ", ".join(info.options), info.source) for name, info in self.items()]
        return _table(rows, ("solver", "what it does", "options", "source"))


def array(array: Array) -> str:
    """An array: its size, transducers and board."""
    extent = " x ".join(f"{size:.4g}" for size in 1e3 * np.ptp(array.positions, axis=0))
    directivity = array.directivity
    if not isinstance(directivity, str):
        directivity = ", ".join(f"{name} {parameter:.4g}" for name, parameter in directivity.items())
    board = array.quantization
    return _facts(
        ("midair.Array", f"{len(array)} transducers"),
        ("extent", f"{extent} mm"),
        ("source pressure", f"{array.source_pressure:.4g} Pa m"),
        ("directivity", directivity),
        ("phases", "any" if board is None or board["phases"] is None else board["phases"]),
        (
            "amplitudes",
            "any" if board is None or board["amplitudes"] is None else _count(board["amplitudes"]),
        ),
        ("off", int((~array.mask).sum())),
    )


def scene(scene: Scene) -> str:
    """A scene: its air, its array and its points, and where they are."""
    pressures, weights = scene.pressures, scene.weights
    rows = [
        (
            k,
            *(f"{x:.4g}" for x in 1e3 * point),
            "balanced" if pressures is None else f"{pressures[k]:.4g}",
            1 if weights is None else f"{weights[k]:.4g}",
        )
        for k, point in enumerate(scene.points[:MOST])
    ]
    facts = _facts(
        ("midair.Scene", f"{len(scene.array)} transducers, {len(scene.points)} points"),
        ("frequency", f"{scene.frequency:.6g} Hz"),
        ("sound speed", f"{scene.sound_speed:.5g} m/s"),
        ("wavelength", f"{1e3 * scene.wavelength:.4g} mm"),
        *([] if scene.solver is None else [("solver", scene.solver[0])]),
        *([("obstacles", str(scene.obstacles))] if scene.obstacles else []),
    )
    table = _table(
        rows, ("point", "x / mm", "y / mm", "z / mm", "pressure / Pa", "weight"), len(scene.points)
    )
    quiet = False if pressures is None else pressures == 0
    return facts + table + above(scene.array, scene.points, quiet=quiet)


def solution(solution: Solution) -> str:
    """A solution: how it ended, how good it is, and what the points asked for and got.

    In its picture the ring of a point is what it asked for, and the disc in it what it got.
    """
    got, targets = np.abs(solution.pressures), solution.targets
    rows = [
        (k, f"{target:.4g}", f"{pressure:.4g}", f"{pressure / target:.3f}" if target else "quiet")
        for k, (target, pressure) in enumerate(zip(targets[:MOST], got, strict=False))
    ]
    facts = _facts(
        ("midair.Solution", f"{solution.solver}, {solution.status}, {solution.steps} steps"),
        *((name, f"{value:.4f}") for name, value in solution.metrics.asdict().items()),
        *([] if solution.scale == 1 else [("scale", f"{solution.scale:.4f}")]),
        ("time", f"{1e3 * solution.elapsed:.4g} ms"),
    )
    table = _table(rows, ("point", "asked / Pa", "got / Pa", "part"), len(got))
    if solution.scene is None:
        return facts + table
    part = got / np.where(targets > 0, targets, np.inf)
    return facts + table + above(solution.scene.array, solution.scene.points, quiet=targets == 0, got=part)


def field(field: Field) -> str:
    """A field: where it is, how loud, and its picture where it has a plane."""
    loudest = f"{np.abs(field.pressure).max():.4g}{'' if field.scene.in_paper_unit else ' Pa'}"
    if field.plane is None:
        return _facts(("midair.Field", f"at {field.pressure.size} points"), ("loudest", loudest))
    from .picture import picture

    plane, panels = field.plane, len(field.panels)
    return _facts(
        ("midair.Field", f"{plane.pixels} x {plane.pixels} places"),
        ("plane", f"{plane.axis} = {1e3 * plane.at:.4g} mm, {1e3 * plane.size:.4g} mm wide"),
        *([("further planes", f"{panels - 1}, in field.panels")] if panels > 1 else []),
        ("loudest", loudest),
        *([] if field.solution is None else [("solver", field.solution.solver)]),
    ) + picture(field)


def sequence(sequence: Frames, facts: Iterable[tuple[str, object]]) -> str:
    """A sequence: its facts, and the ways of its points."""
    return _facts(*facts) + trails(sequence.array, sequence.points, sequence.closed)


def batch(batch: Batch) -> str:
    """A batch: how good its problems are, in the mean and at the worst."""
    rows = [
        (name, f"{values.mean():.4f}", f"{values.min():.4f}", f"{values.max():.4f}")
        for name, values in batch.metrics.asdict().items()
    ]
    facts = _facts(
        ("midair.Batch", f"{len(batch)} problems of {batch.pressures.shape[1]} points"),
        *((status, batch.status.count(status)) for status in sorted(set(batch.status))),
        ("time", f"{1e3 * batch.elapsed:.4g} ms"),
    )
    return facts + _table(rows, ("metric", "mean", "least", "most"))


def _count(table: object) -> int:
    return np.size(np.asarray(table))


def _facts(*rows: tuple[str, object]) -> str:
    """A table of names and values."""
    cells = (f"<tr><th>{_cell(name)}</th><td>{_cell(value)}</td></tr>" for name, value in rows)
    return f"<table>{''.join(cells)}</table>"


def _table(rows: Sequence[Iterable[object]], names: Sequence[str], count: int | None = None) -> str:
    """A table with a head; of `count` rows the first ones."""
    head = "".join(f"<th>{_cell(name)}</th>" for name in names)
    body = "".join(f"<tr>{''.join(f'<td>{_cell(cell)}</td>' for cell in row)}</tr>" for row in rows)
    more = 0 if count is None else count - len(rows)
    tail = f'<tr><td colspan="{len(names)}">and {more} more</td></tr>' if more > 0 else ""
    return f"<table><tr>{head}</tr>{body}{tail}</table>"


def _cell(value: object) -> str:
    return escape(str(value))
