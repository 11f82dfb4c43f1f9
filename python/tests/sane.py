"""Checks that the numbers of an example can be shown to a reader: finite, within limits, even enough."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import pyarrow.parquet

import midair

#: Limits of the level. The weakest method of docs/how-to-choose.md reaches 0.42; far above 1 is a fault, too.
LEAST, MOST = 0.3, 1.2
#: Limit of sigma: the most uneven method has 0.24.
UNEVEN = 0.3


def sane(thing: object, where: str) -> int:
    """Checks the results that an example made, and returns their number."""
    if isinstance(thing, midair.Solution | midair.Batch):
        status = thing.status
        ended = [status] if isinstance(status, str) else status
        # A missed target is also a warning, which the example must catch.
        assert set(ended) <= {"done", "out_of_steps", "missed"}, f"{where}: {set(ended)}"
        drives = thing.drive if isinstance(thing, midair.Solution) else thing.drives
        # The margin allows for rounding to f32.
        assert (np.abs(drives) <= 1 + 1e-6).all(), where
        assert (np.abs(drives) > 0).any(), f"{where} is silent"
        sane(thing.pressures, where)
        return sane(thing.metrics, where)
    if isinstance(thing, midair.Comparison):
        return sane(thing.solutions, where)
    if isinstance(thing, midair.Solver):
        return sane(thing.metrics, where)
    if isinstance(thing, midair.Metrics | midair.BatchMetrics):
        return columns({name: getattr(thing, name) for name in ("accuracy", "sigma", "level")}, where)
    if isinstance(thing, midair.Sequence):
        assert (np.abs(thing.drives[:]) <= 1 + 1e-6).all(), where
        metrics = thing.metrics
        assert LEAST <= metrics.level <= MOST, f"{where}: level {metrics.level}"
        assert metrics.uniformity > UNEVEN, f"{where}: uniformity {metrics.uniformity}"
        return 1
    if isinstance(thing, midair.Field):
        assert np.abs(thing.pressure).max() > 0, f"{where} is silent"
        return sane(thing.pressure, where)
    if isinstance(thing, Mapping) and "accuracy" in thing:
        return columns(thing, where)
    if isinstance(thing, Mapping):
        return sum(sane(value, f"{where}[{key!r}]") for key, value in thing.items())
    if isinstance(thing, list | tuple):
        return sum(sane(value, f"{where}[{k}]") for k, value in enumerate(thing))
    if isinstance(thing, np.ndarray) and thing.dtype.kind in "fc":
        assert np.isfinite(thing).all(), f"{where} is not finite"
    return 0


def columns(table: Mapping[str, object], where: str) -> int:
    """Checks the columns of a table of metrics, by name, and returns the number of checked values."""
    within = {"accuracy": (LEAST, MOST), "level": (LEAST, MOST), "sigma": (0, UNEVEN)}
    found = {name: np.asarray(table[name], float) for name in within.keys() & table.keys()}
    for name, values in found.items():
        least, most = within[name]
        assert values.size, f"{where}: no rows"
        lowest, highest = values.min(), values.max()
        assert least <= lowest <= highest <= most, f"{where}: {name} {lowest} to {highest}"
    return max(values.size for values in found.values())


def printed(text: str) -> dict[str, list[float]]:
    """Returns the columns that `columns` checks, from the command line's table of methods or of faults."""
    lines = text.splitlines()
    heads = [k for k, line in enumerate(lines) if line.split()[:1] == ["solver"] and "level" in line.split()]
    if not heads:
        faults = r"^ (?:phase|dead|temperature|tilt|together) .*? (\d\.\d{4}) "
        levels = [float(level) for level in re.findall(faults, text, re.MULTILINE)]
        return {"level": levels} if levels else {}
    names = lines[heads[0]].split()
    rows = [line.split() for line in lines[heads[0] + 2 :] if re.match(r" \w+ +[-\d.]", line)]
    wanted = [name for name in ("accuracy", "sigma", "level") if name in names]
    return {name: [float(row[names.index(name)]) for row in rows] for name in wanted}


def written(paths: Iterable[Path]) -> int:
    """Checks the numbers in the files that a command wrote, and returns the number of checked values."""
    count = 0
    for path in paths:
        if path.suffix == ".npz":
            with np.load(path) as saved:
                count += sane(dict(saved), path.name)
        elif path.suffix == ".parquet":
            count += sane(pyarrow.parquet.read_table(path).to_pydict(), path.name)
        elif path.suffix == ".csv":
            head, *rows = (line.split(",") for line in path.read_text("utf-8").splitlines())
            count += sane(dict(zip(head, zip(*rows, strict=True), strict=True)), path.name)
        elif path.suffix == ".png":
            assert path.stat().st_size > 1000, path
    return count
