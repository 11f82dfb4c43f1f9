"""Colour scales of pictures: the quantity, its unit, and the ends of the scale."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import log10, pi, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from .._midair import Field
from .._points.ear import REFERENCE
from .._support.arguments import refused

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import matplotlib.image
    from matplotlib.colors import Colormap

#: Types of matplotlib, which is imported only when something is drawn.
Axes: TypeAlias = "matplotlib.axes.Axes"
AxesImage: TypeAlias = "matplotlib.image.AxesImage"
Figure: TypeAlias = "matplotlib.figure.Figure"
SubFigure: TypeAlias = "matplotlib.figure.SubFigure"

#: A colour map of matplotlib, or its name.
Map: TypeAlias = "str | Colormap"

#: Size of a figure in inches: width, or width and height.
Size: TypeAlias = float | tuple[float, float]

Quantity = Literal["pressure", "radiation", "spl", "phase"]

#: Range of a level's scale in dB: its lower end is a thousandth of the pressure at the top.
DEPTH = 60.0

#: A picture whose |p| is below this fraction of the points' is called dark, and its title says so.
DARK = 1e-4

#: Pressures in Pa from here on are shown in kPa.
KILO = 1e3

#: Distance from the points, in wavelengths, within which a field determines its own scale.
MARGIN = 2.0

#: Colour maps of matplotlib by quantity. `sheet` registers those whose names begin with "midair.".
MAPS = {"pressure": "magma", "radiation": "magma", "spl": "magma", "phase": "midair.phase"}


@cache
def table(name: Literal["field", "field_light", "phase"]) -> NDArray[np.uint8]:
    """Return the 256 colours (256, 3) of a colour map in colours.json, which all bindings share.

    "field" is matplotlib's magma. "field_light" is for light backgrounds: 0 has the colour of the page.
    "phase" is cyclic from -pi to pi, in colours that colour-blind readers can tell apart.
    """
    stops = np.array(json.loads(Path(__file__).with_name("colours.json").read_text("utf-8"))[name])
    at = np.linspace(0, len(stops) - 1, 256)
    channels = [np.interp(at, np.arange(len(stops)), channel) for channel in stops.T]
    return np.rint(channels).astype(np.uint8).T


@dataclass(frozen=True)
class Colours:
    """A colour scale. Displayed values are `factor` times those in Pa or dB."""

    quantity: Quantity
    bottom: float
    top: float
    factor: float
    label: str
    extend: str
    #: The caller's colour map, if given.
    own: Map | None = None

    def values(self, field: Field) -> NDArray[np.float64]:
        """Return the values to draw, of all quantities but the phase."""
        return _values(field, self.quantity) * self.factor

    @property
    def map(self) -> Map:
        """The colour map: the caller's, or the name of the quantity's."""
        return self.own or MAPS[self.quantity]

    def by(self, cmap: Map) -> Colours:
        """Return a copy with the caller's colour map."""
        return replace(self, own=cmap)


def beyond(over: bool, under: bool) -> str:
    """Return matplotlib's word for the ends of a colour bar beyond which there are values."""
    return {(True, True): "both", (True, False): "max", (False, True): "min"}.get((over, under), "neither")


def of_pressures(field: Field, pressures: NDArray[np.float64], colours: Colours) -> NDArray[np.float64]:
    """Return the displayed values of pressures |p| in Pa, such as targets."""
    values = [_of_pressure(field, float(pressure), colours.quantity) for pressure in pressures]
    return np.array(values) * colours.factor


def colours(
    fields: Sequence[Field], quantity: Quantity, *, loudest: float | None = None, vmax: float | None = None
) -> Colours:
    """Return the scale for fields of one scene, up to |p| = `loudest` in Pa or `vmax` in its own unit."""
    if quantity not in get_args(Quantity):
        given = " ".join(str(quantity).split())
        raise refused("quantity", given, 'give "pressure", "radiation", "spl" or "phase"')
    paper = fields[0].scene.in_paper_unit
    if quantity == "phase":
        if vmax is not None:
            raise refused("vmax", vmax, "phases go from -pi to pi, leave it out")
        return Colours(quantity, -pi, pi, 1.0, "phase of p / rad", "neither")
    if vmax is None:
        loudest = max(map(loud, fields)) if loudest is None else loudest
        # In a plane through a trap |p| may be almost 0. The top of the scale has a lower limit; otherwise the
        # picture would show only rounding errors.
        least = max(DARK * at_points(field) for field in fields)
        top = _of_pressure(fields[0], max(loudest, least), quantity)
    elif isinstance(vmax, (int, float, np.number)) and np.isfinite(vmax) and (vmax > 0 or quantity == "spl"):
        top = float(vmax)
    else:
        raise refused("vmax", vmax, "give a finite number above 0")
    factor, label = _unit(quantity, top, paper)
    values = [_values(field, quantity) for field in fields]
    brighter = max(map(np.max, values)) > top + 1e-6 * abs(top)
    if quantity == "spl":
        darker = min(map(np.min, values)) < top - DEPTH
        extend = beyond(bool(brighter), bool(darker))
        return Colours(quantity, top - DEPTH, top, factor, label, extend)
    return Colours(quantity, 0.0, top * factor or 1.0, factor, label, "max" if brighter else "neither")


def at_points(field: Field) -> float:
    """Return the largest |p| at a point in Pa, 0 for a drive without a solution."""
    solution = field.solution
    return 0.0 if solution is None else float(np.abs(solution.pressures).max(initial=0.0))


def is_dark(field: Field) -> bool:
    """Return whether |p| in a picture is almost 0 compared with |p| at the points."""
    return float(np.abs(field.pressure).max()) < DARK * at_points(field)


def loud(field: Field) -> float:
    """Return the largest |p| of a picture in Pa, without the surroundings of a transducer.

    Near a transducer 1/r exceeds every focus. So values above twice the largest |p| within two wavelengths of
    the points do not count.
    """
    assert field.plane is not None
    pressure = np.abs(field.pressure)
    assert field.shown is not None
    # If no point lies in the plane, the projections of all points count.
    points = field.scene.points[field.shown if field.shown.any() else slice(None)]
    margin = MARGIN * field.scene.wavelength
    whole = float(pressure.max())
    sides = [(axis, samples) for axis, samples in enumerate((field.x, field.y, field.z)) if samples is not None]
    across, up = (
        (samples >= points[:, axis].min() - margin) & (samples <= points[:, axis].max() + margin)
        for axis, samples in sides
    )
    near = float(pressure[np.ix_(up, across)].max(initial=0.0))
    return near if 0 < 2 * near < whole else whole


def _values(field: Field, quantity: Quantity) -> NDArray[np.float64]:
    pressure: NDArray[np.float64] = np.abs(field.pressure).astype(np.float64)
    if quantity == "radiation":
        # The paper draws |p|^2, since its pressures are not in Pa and it states no density.
        return pressure**2 if field.scene.in_paper_unit else field.radiation
    if quantity == "pressure":
        return pressure
    return 20 * np.log10(np.maximum(pressure, 1e-30) / _zero_decibel(field))


def _zero_decibel(field: Field) -> float:
    """Return the peak pressure of 0 dB: 20 uPa rms, or 1 in the paper's unit, which is not the pascal."""
    return 1.0 if field.scene.in_paper_unit else REFERENCE * sqrt(2)


def _of_pressure(field: Field, pressure: float, quantity: Quantity) -> float:
    """Return the quantity's value at |p| = `pressure`."""
    if quantity == "radiation":
        scene = field.scene
        return pressure**2 / (1.0 if scene.in_paper_unit else scene.density * scene.sound_speed**2)
    if quantity == "spl":
        return 20 * log10(max(pressure, 1e-30) / _zero_decibel(field))
    return pressure


def _unit(quantity: Quantity, top: float, paper: bool) -> tuple[float, str]:
    """Return a factor for the values that keeps the numbers at the colour bar short, and the bar's label."""
    if quantity == "spl":
        return 1.0, "|p| / dB re the paper's unit" if paper else "sound pressure level / dB re 20 µPa"
    if paper:
        return 1.0, f"{'|p|' if quantity == 'pressure' else '|p|²'} in the paper's unit"
    name = "|p|" if quantity == "pressure" else "radiation pressure"
    units = ((1e-3, "kPa"), (1.0, "Pa"), (1e3, "mPa"), (1e6, "µPa"))
    factor, unit = next(
        (unit for unit in units if top * unit[0] >= (1e-3 * KILO if unit[1] == "kPa" else 0.5)), units[-1]
    )
    return factor, f"{name} / {unit}"
