"""The sweep file: reads and checks it before any solve; returns blocks of problems in the table's order."""

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from .. import _midair
from .._midair import Scene, SceneError, read_sweep, restated, solve, solver_name, solvers, stated, sweep_keys
from .._support.arguments import path_of
from .._support.output import METRICS
from .._support.text import content
from .block import Settings
from .problems import Tables, few, known, plain, read_axes, read_sets, short, tables_of, whole

#: A sweep with more problems is rejected as a mistake.
MOST = 10**9


class Block(NamedTuple):
    """Problems that differ only in their trial; `columns` are the cells that their rows have in common."""

    settings: Settings
    columns: Mapping[str, Any]
    trials: int


class Request(NamedTuple):
    """The blocks in order, the names of their common columns, and the files that were read."""

    blocks: Sequence[Block]
    names: tuple[str, ...]
    files: Sequence[Path] = ()

    @property
    def columns(self) -> list[str]:
        """Names of all columns of the table."""
        return ["index", *self.names, "trial", *METRICS, "status"]

    @property
    def problems(self) -> int:
        """Number of rows of the table."""
        return sum(block.trials for block in self.blocks)


def read(source: str | PathLike[str] | Mapping[str, Any], *, drives: bool = False) -> Request:
    """Return the request in a sweep file (TOML or JSON), or in a mapping of the same keys.

    A mapping may contain arrays and scenes. Paths of scenes are relative to the file's folder. Raises
    SceneError, with the place in the file, for invalid values; warns of probable mistakes.
    """
    if isinstance(source, Mapping):
        return _read(source, None, drives)
    path = path_of("request", source, "give a sweep file or a mapping of its keys")
    text = content(path)
    tables = read_sweep(text, str(path))
    try:
        return _read(tables, path, drives)
    except SceneError as error:
        raise (_midair.placed(text, str(path), error) or error) from error


def _read(given: Mapping[str, Any], path: Path | None, drives: bool) -> Request:
    try:
        known(given, sweep_keys()[""], "sweep")
        tables = plain(given)
    except RecursionError as error:
        cure = "give tables as a sweep file has them"
        raise stated("the sweep", "is nested too deep, or holds itself", cure) from error
    seed = whole(tables.get("seed", 0), "seed")
    trials, seeds = _trials(tables.get("seeds", 1))
    axes = read_axes(tables)
    methods = [method for table in tables_of(tables, "solver") for method in _methods(table)]
    if not methods:
        raise stated("solver", "is missing", "give one or more [[solver]] with a name", code="missing")
    common = {"seed": seed, "seeds": seeds, "drives": drives}
    sets, files = read_sets(tables, axes, path.parent if path else Path(), common)
    few(len(sets) * len(methods))
    if len(sets) * len(methods) * trials > MOST:
        cure = "at most 10^9, shorten an axis"
        raise stated("the sweep", f"has {len(sets)} x {len(methods)} x {trials} problems", cure)
    options = list(dict.fromkeys(key for _, chosen in methods for key in chosen))
    for name, chosen in methods:
        _check_method(name, chosen)
    blocks = [
        Block(
            {**settings, "solver": name, "options": chosen},
            {**columns, "solver": labelled(name), **{key: chosen.get(key) for key in options}},
            trials,
        )
        for (settings, columns), (name, chosen) in product(sets, methods)
    ]
    requested = Request(blocks, (*sets[0][1], "solver", *options), [*([path] if path else []), *files])
    twice = [name for name, times in Counter(requested.columns).items() if times > 1]
    if twice:
        raise stated("two columns", f'of the table would be called "{twice[0]}"', "leave that option out")
    return requested


def _trials(given: Any) -> tuple[int, list[int] | None]:
    """Return the number of trials, and their seeds if the request lists them."""
    if isinstance(given, list):
        if not given:
            raise stated("seeds", "is empty", "give a count or a list of seeds", code="missing")
        return len(given), [whole(seed, f"seeds[{index}]") for index, seed in enumerate(given)]
    return whole(given, "seeds", least=1), None


def labelled(solver: Any) -> str:
    """Return the name of a solver, which may be a function or a functools.partial of one."""
    return (
        solver
        if isinstance(solver, str)
        else getattr(getattr(solver, "func", solver), "__name__", type(solver).__name__)
    )


def _methods(table: Tables) -> list[tuple[Any, dict[str, Any]]]:
    """Return (solver, options) of a solver's table for each combination of lists in it."""
    name = table.pop("name", None)
    if not (isinstance(name, str) or callable(name)):
        raise stated("solver.name", f"is {short(name)}", f"give one of {', '.join(solvers())}")
    if isinstance(name, str):
        name = solver_name(name)
        options = ("balance", "aim", *solvers()[name].options)
        table = {spelt(key, options): value for key, value in table.items()}
        for key, value in table.items():
            if key not in options:
                _refuse(name, key, value)
    axes = [value if isinstance(value, list) else [value] for value in table.values()]
    for key, values in zip(table, axes, strict=True):
        if not values:
            raise stated(f"option {key}", f"of {labelled(name)} is an empty list", "give a value or some")
    few(math.prod(map(len, axes)))
    return [(name, dict(zip(table, chosen, strict=True))) for chosen in product(*axes)]


def spelt(word: Any, words: Iterable[str]) -> str:
    """Return the known word that equals `word` apart from case, "-" and "_"; else `word` itself."""
    plainly = {known.lower().replace("_", ""): known for known in words}
    return plainly.get(str(word).lower().replace("-", "").replace("_", ""), str(word))


def _refuse(name: str, option: str, value: Any) -> NoReturn:
    """Raise the core's error for an option that a solver does not have."""
    array = {"grid": {"nx": 1, "ny": 1, "pitch": 0.01}}
    solver = {"name": name, option: value}
    try:
        Scene.parse(json.dumps({"array": array, "points": [{"position": [0, 0, 1]}], "solver": solver}))
    except SceneError as error:
        raise restated(error, place="") from error
    raise stated(option, f"is no option of {name}", "leave it out")


def _check_method(name: Any, options: Mapping[str, Any]) -> None:
    """Let the solver reject invalid options, on a tiny scene. A function may be meant for one array."""
    if isinstance(name, str) and not isinstance(options.get("order"), list):
        array = _midair.Array.grid(2, 2, 0.01)
        solve(Scene(array, [[0.0, 0.0, 0.1]]), name, **options)
