"""Texts of pictures: solver, targets, level and plane."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Field, Scene, Solution, Wall, solvers
from .colours import is_dark


def heading(fields: Sequence[Field]) -> list[str]:
    """Return the lines above a field: its solver, its targets and level, and the meaning of the marks."""
    solution, scene = fields[0].solution, fields[0].scene
    if solution is not None:
        lines = [solver(solution), reported(solution, scene)]
    else:
        lines = [] if scene.pressures is None else [requested(np.abs(scene.pressures), scene)]
    return [*lines, *filter(None, [marks(fields)])]


def quiet(field: Field) -> NDArray[np.bool_]:
    """Return (M,) bool: which points have the target 0."""
    targets = field.scene.pressures if field.solution is None else field.solution.targets
    return np.zeros(len(field.scene.points), dtype=bool) if targets is None else targets == 0


def has_arrows(field: Field) -> bool:
    """Return whether force arrows are drawn: in vertical planes through traps, without spheres or meshes."""
    scene, plane = field.scene, field.plane
    bodies = any(not isinstance(obstacle, Wall) for obstacle in scene.obstacles)
    trapped = field.solution is not None and scene.signature is not None and not bodies
    return trapped and plane is not None and plane.axis != "z" and bool(np.any(field.shown))


def marks(fields: Sequence[Field]) -> str:
    """Return the meaning of rings and crosses, and the number of points that lie in no plane."""
    shown = np.array([field.shown for field in fields])
    dark = all(map(is_dark, fields))
    silent = quiet(fields[0])
    hidden = int((~shown.any(axis=0)).sum()) if len(fields) > 1 else 0
    reported = {
        "rings are points off the plane": bool((~shown & ~silent).any()),
        "crosses are quiet points": bool(silent.any()),
        f"{hidden} more point{'s' * (hidden > 1)} in other planes": hidden > 0,
        "arrows are the force on a small bead": any(map(has_arrows, fields)),
        "dark: |p| is below 1e-4 of what the points get": dark,
    }
    return ", ".join(text for text, true in reported.items() if true)


def solver(solution: Solution) -> str:
    """Return the solver's name, and those of its most important options that differ from the defaults."""
    info = solvers().get(solution.solver)
    options = {key: solution.options.get(key) for key in ("phases", "amplitudes", "order", "limit")}
    given = (
        f"{key}={value}"
        for key, value in options.items()
        if isinstance(value, str | int) and (info is None or value != info.options[key].default)
    )
    return ", ".join([solution.solver, *given])


def reported(solution: Solution, scene: Scene | None) -> str:
    """Return targets, level and scale of a solution."""
    return f"{requested(solution.targets, scene)}, {level(solution)}{scale(solution)}"


def level(solution: Solution) -> str:
    """Return the level as text."""
    return f"level {number(solution.metrics.level)}"


def number(value: float) -> str:
    """Return a metric as text: three decimals, or few significant digits if it is very large or small."""
    if value == 0 or 1e-3 <= value < 100:
        return f"{value:.3f}"
    return f"{value:.3g}" if value > 1 else f"{value:.1g}"


def scale(solution: Solution) -> str:
    """Return the scale as text, "" if it is 1."""
    return "" if solution.scale == 1 else f", scale {solution.scale:.3g}"


def requested(targets: ArrayLike, scene: Scene | None) -> str:
    """Return the range of the targets above 0, and the number of quiet points."""
    targets = np.asarray(targets, dtype=float)
    received = targets[targets > 0]
    silent = f"{targets.size - received.size} quiet" if received.size < targets.size else ""
    if not received.size:
        return silent
    unit = "" if scene is not None and scene.in_paper_unit else " Pa"
    low, high = (f"{end:.4g}" for end in (received.min(), received.max()))
    span = low if low == high else f"{low} to {high}"
    return ", ".join(filter(None, [f"target{'s' * (received.size > 1)} {span}{unit}", silent]))


def place(field: Field) -> str:
    """Return the plane as text, and how many points lie in it if not all do."""
    plane, shown = field.plane, field.shown
    assert plane is not None
    assert shown is not None
    count = "" if shown.all() else f", {int(shown.sum())} of {shown.size} points"
    return f"{plane.axis} = {plane.at * 1e3:.4g} mm{count}"
