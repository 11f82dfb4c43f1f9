"""A sequence as an xarray Dataset: arrays with named dimensions and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._midair import SceneError

if TYPE_CHECKING:
    from xarray import Dataset

    from .sequence import Sequence


def dataset(sequence: Sequence) -> Dataset:
    """Points, targets, |p|, changes and drives over time, point and transducer."""
    try:
        import xarray
    except ImportError as error:
        raise SceneError('to_xarray needs xarray: pip install "midair[motion]"') from error
    board = {} if sequence.codes is None else {"phases": (sequence.quantization or {})["phases"]}
    drives = ("drives", sequence.drives, {}) if sequence.codes is None else ("codes", sequence.codes, board)
    variables: dict[str, tuple[tuple[str, ...], Any, dict[str, Any]]] = {
        "points": (("time", "point", "axis"), sequence.points, {"units": "m"}),
        "targets": (("time", "point"), sequence.targets, {"units": "Pa"}),
        "pressures": (("time", "point"), sequence.pressures, {"units": "Pa", "long_name": "|p|, peak"}),
        "changes": (("time",), sequence.changes, {"units": "rad", "long_name": "largest phase change"}),
        drives[0]: (("time", "transducer"), *drives[1:]),
        "positions": (("transducer", "axis"), sequence.array.positions, {"units": "m"}),
    }
    coordinates = {"time": ("time", sequence.times, {"units": "s"}), "axis": list("xyz")}
    told = {"rate": sequence.rate, "closed": int(sequence.closed), "solver": sequence.solver}
    bound = {} if sequence.change is None else {"change": sequence.change}
    copies = {name: (dims, np.array(values), attrs) for name, (dims, values, attrs) in variables.items()}
    return xarray.Dataset(copies, coordinates, told | bound)
