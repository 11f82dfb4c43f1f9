"""`midair.compare`: one scene by several solvers, in one table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _midair
from .._midair import Array, Plane, Propagation, Scene, SceneError, Solution, Solver, numbers, stated
from .._pictures.colours import Axes, Figure, Map, Quantity, Size
from .._support import text
from .._support.arguments import refused
from .._support.output import METRICS

#: Largest number of points for which `midair.bound` is computed.
BOUND_POINTS = 64


#: Arguments of `midair.solve` that `midair.Solver` does not accept.
OF_A_SOLVE = {"start", "progress", "trace"}

#: A solver: its name, its name with options, or a Python function.
Named: TypeAlias = tuple[str, Mapping[str, Any]]
Entry: TypeAlias = str | Named | Callable[..., Any]
Solvers: TypeAlias = Entry | Iterable[Entry] | None


@dataclass(frozen=True, repr=False)
class Comparison:
    """Solutions of one scene by several solvers, from `midair.compare`.

    Prints as a table; `["greedy"]` and `[0]` are its solutions.

    Attributes
    ----------
    scene : midair.Scene or midair.Propagation
        The scene or matrix that was solved.
    bound : float or None
        Level min |p| / target that no drive exceeds (`midair.bound`); None for over 64 points.
    solutions : tuple of midair.Solution
        One solution per solver, in the requested order.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
    >>> table = midair.compare(scene, ["naive", "uniform"])
    >>> table.names, table[0].solver
    (('naive', 'uniform'), 'naive')
    """

    scene: Scene | Propagation
    bound: float | None
    solutions: tuple[Solution, ...] = ()
    _options: tuple[Mapping[str, Any], ...] = field(default=(), compare=False)
    _received: NDArray[np.bool_] | None = field(default=None, compare=False)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the solvers, with their options if a solver occurs more than once."""
        solvers = [solution.solver for solution in self.solutions]
        names: list[str] = []
        for solver, options in zip(solvers, self._options, strict=True):
            reported = (f"{key}={value}" for key, value in options.items())
            name = ", ".join([solver, *reported]) if solvers.count(solver) > 1 else solver
            again = sum(other == name or other.startswith(f"{name} (") for other in names)
            names.append(f"{name} ({again + 1})" if again else name)
        return tuple(names)

    @property
    def gaps(self) -> list[float] | None:
        """Distance of each solution's weakest point from the bound, relative to it. None without a bound."""
        bound, received = self.bound, self._received
        if bound is None:
            return None
        parts = [np.abs(one.pressures[received]) / one.targets[received] for one in self.solutions]
        return [float(1 - np.min(part) / bound) for part in parts]

    def to_dict(self) -> dict[str, list[Any]]:
        """Return the table as columns, as `pandas.DataFrame` takes them; elapsed is in s."""
        columns: dict[str, list[Any]] = {"solver": list(self.names)}
        columns |= {name: [getattr(one.metrics, name) for one in self.solutions] for name in METRICS}
        errors = [one.complex_error for one in self.solutions]
        if any(error is not None for error in errors):
            columns["complex_error"] = errors
        if self.gaps is not None:
            columns["gap"] = list(self.gaps)
        columns["limit"] = [one.options.get("limit") for one in self.solutions]
        columns |= {
            name: [getattr(one, name) for one in self.solutions] for name in ("scale", "steps", "elapsed", "status")
        }
        return columns

    def plot(
        self,
        ax: Axes | None = None,
        *,
        plane: Plane | None = None,
        quantity: Quantity = "pressure",
        cmap: Map | None = None,
        panels: str | Iterable[str] | None = None,
        size: Size | None = None,
    ) -> Figure:
        """Draw the field of every solution, all in the same colours.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of your own for one panel, the first of `panels`.
        plane : midair.Plane, optional
            Plane of the fields, in place of those through the points.
        quantity : {"pressure", "radiation", "spl", "phase"}, optional
            Quantity to draw, as for `midair.plot`.
        cmap : str or Colormap, optional
            A colour map of matplotlib.
        panels : str or list of str, optional
            Names of the solvers to draw; by default all.
        size : float or (float, float), optional
            Size of the figure in inches: its width, or (width, height).

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        SceneError
            If the quantity, the colour map, a panel or the size is invalid; for a matrix, which has no field.
        """
        from .._pictures.figures import chosen
        from .._pictures.plot import contact_sheet

        names = chosen(panels, self.names, ax)
        fields = []
        for name in names:
            solution = self[name]
            if solution.scene is None:
                raise stated("scene", "is a matrix", "a field needs the positions of a Scene")
            fields.append(_midair.field(solution.scene, solution, plane))
        return contact_sheet(fields, names, quantity, ax=ax, cmap=cmap, size=size)

    def __getitem__(self, which: str | int) -> Solution:
        if isinstance(which, str):
            if which not in self.names:
                raise KeyError(f'no solution is named "{which}": there are {", ".join(self.names)}')
            which = self.names.index(which)
        return self.solutions[which]

    def __iter__(self) -> Iterator[Solution]:
        return iter(self.solutions)

    def __len__(self) -> int:
        return len(self.solutions)

    def __repr__(self) -> str:
        return text.plain(cells(self.solutions, self.names, self.gaps))

    def _repr_html_(self) -> str:
        return text.html(cells(self.solutions, self.names, self.gaps))


def cells(
    solutions: Iterable[Solution], names: Iterable[str], gaps: Iterable[float] | None = None
) -> dict[str, list[str]]:
    """Return the table's columns as text.

    The leak is shown only if there are quiet points, the complex error if targets have phases, the gap if it
    is known.
    """
    solutions = list(solutions)
    quiet = any(solution.metrics.leak > 0 for solution in solutions)
    columns = {"solver": list(names)}
    for name in METRICS if quiet else METRICS[:-1]:
        columns[name] = [f"{getattr(solution.metrics, name):.4f}" for solution in solutions]
    errors = [solution.complex_error for solution in solutions]
    if any(error is not None for error in errors):
        columns["complex error"] = ["-" if error is None else f"{error:.4f}" for error in errors]
    if gaps is not None:
        columns["gap"] = [f"{gap:.1%}" for gap in gaps]
    columns["limit"] = [str(solution.options.get("limit", "-")) for solution in solutions]
    columns["steps"] = [str(solution.steps) for solution in solutions]
    columns["time"] = [_duration(solution.elapsed) for solution in solutions]
    columns["status"] = [_status(solution) for solution in solutions]
    return columns


def weakest(solution: Solution) -> float:
    """Return the least |p| / target of the points with a target above 0."""
    loud = solution.targets > 0
    parts = np.abs(solution.pressures[loud]) / solution.targets[loud]
    return float(parts.min()) if parts.size else 0.0


def _duration(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 1 else f"{seconds * 1e3:.2f} ms"


def _status(solution: Solution) -> str:
    return solution.status if solution.scale == 1 else f"{solution.status}, scale {solution.scale:.3g}"


def compare(
    scene: Scene | Propagation,
    solvers: Solvers = None,
    *,
    pressures: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    quantization: Mapping[str, Any] | None = None,
    mask: ArrayLike | None = None,
    positions: ArrayLike | None = None,
    balance: bool | None = None,
) -> Comparison:
    """Solve one scene by several solvers, and return a table that prints and plots.

    Parameters
    ----------
    scene : midair.Scene or midair.Propagation
        The request.
    solvers : str, callable, (str, mapping), or list of these, optional
        Names, (name, options) pairs or functions; by default every solver there is.
    pressures, weights, quantization, mask, positions, balance
        As for `midair.solve`; they apply to every solver.

    Returns
    -------
    midair.Comparison
        The solutions.

    Raises
    ------
    SceneError, TypeError
        As for `midair.solve`, about the first solver that is rejected.

    See Also
    --------
    midair.bound : the level that no drive exceeds.

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("paper20"), [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
    >>> table = midair.compare(scene, ["naive", ("greedy", {"phases": 8})])
    >>> table["greedy"].metrics.accuracy > 0.8
    True
    """
    settings = {"pressures": pressures, "weights": weights, "balance": balance}
    board = {"quantization": quantization, "mask": mask, "positions": positions}
    *_, table = growing(scene, solvers, **settings, **board)
    return table


def growing(scene: Scene | Propagation, solvers: Solvers, **settings: Any) -> Iterator[Comparison]:
    """Yield the comparison after each solver, so that an interruption does not lose the finished ones."""
    if not isinstance(scene, Scene | Propagation):
        kinds = "midair.Scene or midair.Propagation"
        raise TypeError(f"expected a {kinds} first, not {type(scene).__qualname__}")
    entries = choices(scene, solvers)
    settings = {key: value for key, value in settings.items() if value is not None}
    beside = {key: settings[key] for key in ("pressures", "weights", "mask") if key in settings}
    weights = beside.get("weights", getattr(scene, "weights", None))
    pressures = beside.get("pressures", getattr(scene, "pressures", None))
    count = len(scene.points) if isinstance(scene, Scene) else scene.shape[0]
    wanted = _above_zero(pressures, count) & _above_zero(weights, count)
    # For more points the bound would take too long.
    bound = _midair.bound(scene, **beside) if wanted.sum() <= BOUND_POINTS else None
    table = Comparison(scene, bound, _received=wanted)
    for solver, options in entries:
        solution = _midair.solve(scene, solver, **settings, **options)
        table = replace(table, solutions=(*table.solutions, solution), _options=(*table._options, options))
        yield table


def _above_zero(given: ArrayLike | None, count: int) -> NDArray[np.bool_]:
    """Return (M,) bool: pressures or weights above 0. Invalid values are left for `solve` to reject."""
    try:
        sizes = numbers("given", 1.0 if given is None else given, [(), (count,)], "", kinds="iufc")
    except SceneError:
        return np.ones(count, dtype=bool)
    # Complex pressures count by their moduli. Negative real numbers do not count; `solve` rejects them.
    return np.broadcast_to(np.abs(sizes) if np.iscomplexobj(sizes) else sizes, count) > 0


def choices(scene: Scene | Propagation, solvers: Solvers) -> list[tuple[Any, dict[str, Any]]]:
    """Return the solvers and their options; rejects invalid ones before any solve."""
    if solvers is None:
        solvers = list(_midair.solvers())
    elif isinstance(solvers, str) or callable(solvers) or _is_pair(solvers):
        solvers = [solvers]
    if not isinstance(solvers, Iterable):
        raise refused("solvers", solvers, "give names, (name, options) pairs or functions")
    entries: list[tuple[Any, dict[str, Any]]] = []
    for entry in solvers:
        entries.append((entry[0], dict(entry[1])) if _is_pair(entry) else (entry, {}))
    if not entries:
        raise stated("solvers", "is empty", "give at least one, or leave it out for all", code="missing")
    array = scene.array if isinstance(scene, Scene) else Array.grid(1, 1, 0.01)
    for solver, options in entries:
        if not callable(solver):
            Solver(array, solver, points=1, **{key: options[key] for key in options.keys() - OF_A_SOLVE})
    return entries


def _is_pair(entry: Any) -> TypeGuard[Named]:
    return isinstance(entry, tuple | list) and len(entry) == 2 and isinstance(entry[1], Mapping)
