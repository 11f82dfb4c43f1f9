"""Texts of pictures: solver, targets, level and plane."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Field, Scene, Solution, Wall, solvers
from .._points.ear import REFERENCE
from .._support.text import counted
from .colours import KILO, is_dark

#: Pressures that differ by less than this factor are written as one number in sentences.
EVEN = 1.002


def heading(fields: Sequence[Field]) -> list[str]:
    """Return the lines above a field: a sentence, its solver, and the meaning of the marks."""
    solution, scene = fields[0].solution, fields[0].scene
    if solution is not None:
        lines = [sentence(solution), f"{solver(solution)}, {reported(solution)}"]
    else:
        lines = [] if scene.pressures is None else [requested(np.abs(scene.pressures), scene)]
    return [*lines, *filter(None, [marks(fields)])]


def sentence(solution: Solution) -> str:
    """Return a sentence about a solution: points, pressure, transducers, distance from the request."""
    loud = solution.targets > 0
    got, quiet = np.abs(solution.pressures[loud]), np.abs(solution.pressures[~loud])
    if not got.size:
        return f"{counted(len(quiet), 'quiet point')}, at most {quiet.max():.3g} Pa"
    low, high = float(got.min()), float(got.max())
    paper = solution.scene is not None and solution.scene.in_paper_unit
    most = f"{high:.4g} in the paper's unit" if paper else _spl(high)
    level = most if high <= EVEN * low else f"{low:.4g} to {most}"
    driven = counted(len(np.flatnonzero(solution.drive)), "transducer")
    words = [f"{counted(len(got), 'point')} at {level} with {driven}"]
    if is_requested(solution):
        words.append(f"within {_percent(off(solution))} of what was requested")
    elif len(got) > 1:
        words.append(f"even to {_percent(off(solution))}")
    if quiet.size:
        words.append(f"{counted(len(quiet), 'quiet point')} at most {quiet.max():.3g} Pa")
    return ", ".join(words)


def beads(solution: Solution) -> str:
    """Return how many beads the traps of a solution hold; an empty text without known traps."""
    scene, counts = solution.scene, solution.beads
    if scene is None or counts is None:
        return ""
    across, density = 2e3 * scene.bead.radius, scene.bead.density
    return f"traps hold {counts[0]} of {counts[1]} beads of {across:g} mm and {density:g} kg/m3"


def pascals(pressure: float) -> str:
    """Return a pressure with its unit, as short as in a picture."""
    return f"{pressure / 1e3:#.3g} kPa" if pressure >= KILO else f"{pressure:#.3g} Pa".replace(". Pa", " Pa")


def is_requested(solution: Solution) -> bool:
    """Return whether a scene requests pressures; otherwise only their ratios count."""
    return solution.scene is not None and solution.scene.pressures is not None


def off(solution: Solution) -> float:
    """Return the largest relative deviation of |p| from the targets above 0, or from their ratios."""
    loud = solution.targets > 0
    parts = np.abs(solution.pressures[loud]) / solution.targets[loud]
    whole = 1.0 if is_requested(solution) else parts.sum() / max(len(parts), 1)
    return float(np.abs(parts / max(whole, 1e-30) - 1).max(initial=0.0))


def _percent(part: float) -> str:
    """Return a fraction as a percentage with two digits, at least 0.1 %; whole percents from 100 % on."""
    return f"{100 * part:.0f} %" if part >= 0.995 else f"{max(100 * part, 0.1):.2g} %"


def _spl(pressure: float) -> str:
    """Return a peak pressure as text, in Pa and in dB SPL."""
    decibels = 20 * np.log10(max(pressure, 1e-12) / np.sqrt(2) / REFERENCE)
    return f"{pressure:.4g} Pa ({decibels:.0f} dB)"


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


def reported(solution: Solution) -> str:
    """Return targets, level and scale of a solution."""
    level = number(solution.metrics.level)
    return f"{requested(solution.targets, solution.scene)}, level {level}{scale(solution)}"


def numbers(solution: Solution) -> str:
    """Return accuracy and sigma as text."""
    return f"accuracy {number(solution.metrics.accuracy)}, sigma {number(solution.metrics.sigma)}"


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
