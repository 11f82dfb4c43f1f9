"""Pictures of fields: |p|^2, what the paper draws, and the radiation pressure, what a hand feels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from ._midair import Field, SceneError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage
    from numpy.typing import NDArray

Quantity = Literal["pressure", "radiation"]


def plot(
    field: Field, ax: Axes | None = None, *, quantity: Quantity = "pressure", vmax: float | None = None
) -> Axes:
    """Draw a field on a plane: |p|^2 (quantity="pressure") or the radiation pressure, points marked.

    ax : the axes to draw in; left out, matplotlib's present ones
    vmax : the value at the top of the colour scale, in Pa^2 or Pa; left out, the field's own largest

    Points of the plane are dots; points off it are hollow rings where they project. Returns the axes.
    """
    if not isinstance(field, Field):
        raise TypeError(f"expected a midair.Field first, not {type(field).__qualname__}")
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.gca()
    image, label = _draw(field, ax, quantity, vmax)
    ax.figure.colorbar(image, ax=ax, fraction=0.046, pad=0.03, label=label)
    return ax


def _draw(field: Field, ax: Axes, quantity: Quantity, vmax: float | None) -> tuple[AxesImage, str]:
    """The image, and what its colours mean."""
    plane = field.plane
    if plane is None:
        raise SceneError("field is at single points: a picture needs a midair.Plane")
    values = _values(field, quantity)
    top = float(values.max()) if vmax is None else vmax
    factor, label = _scale(quantity, top, field.scene.in_paper_unit)
    half = plane.size / (plane.pixels - 1) / 2
    x, y = plane.x * 1e3, plane.y * 1e3
    edge = half * 1e3
    image = ax.imshow(
        values * factor,
        origin="lower",
        extent=(x[0] - edge, x[-1] + edge, y[0] - edge, y[-1] + edge),
        cmap="magma" if quantity == "pressure" else "viridis",
        vmin=0.0,
        vmax=top * factor or 1.0,
        interpolation="nearest",
    )
    _mark(ax, field)
    ax.set(
        xlabel="x / mm", ylabel="y / mm", xlim=(x[0] - edge, x[-1] + edge), ylim=(y[0] - edge, y[-1] + edge)
    )
    return image, label


def _values(field: Field, quantity: Quantity) -> NDArray[np.float64]:
    if quantity == "radiation":
        return field.radiation
    if quantity == "pressure":
        values: NDArray[np.float64] = np.abs(field.pressure).astype(np.float64) ** 2
        return values
    given = " ".join(str(quantity).split())
    raise SceneError(f'quantity is "{given}": give "pressure" or "radiation"')


def _scale(quantity: Quantity, top: float, paper: bool) -> tuple[float, str]:
    """The factor and label that keep the colour bar's numbers short."""
    if quantity == "radiation":
        units = ((1.0, "Pa"), (1e3, "mPa"), (1e6, "µPa"))
        factor, unit = next((scale for scale in units if top * scale[0] >= 0.5), units[-1])
        return factor, f"radiation pressure / {unit}"
    if paper:
        return 1.0, "|p|², eq. (5) in mm"
    return (1e-6, "|p|² / kPa²") if top >= 1e5 else (1.0, "|p|² / Pa²")


def _mark(ax: Axes, field: Field) -> None:
    assert field.plane is not None
    points = field.scene.points
    # Within half a pixel in height a point is in the plane as far as a picture can tell.
    inside = np.abs(points[:, 2] - field.plane.z) <= field.plane.size / field.plane.pixels / 2
    for chosen, face in ((inside, "white"), (~inside, "none")):
        ax.scatter(
            points[chosen, 0] * 1e3,
            points[chosen, 1] * 1e3,
            s=12,
            facecolors=face,
            edgecolors="deepskyblue",
            linewidths=0.9,
        )


def picture(field: Field, title: str) -> Figure:
    """One field: |p|^2 and, beside it, the radiation pressure."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    plot(field, left)
    plot(field, right, quantity="radiation")
    assert field.plane is not None
    figure.suptitle(f"{title}, z = {field.plane.z * 1e3:g} mm")
    return figure


def contact_sheet(fields: Sequence[Field], titles: Sequence[str]) -> Figure:
    """|p|^2 of several fields of one scene on one colour scale."""
    from matplotlib.figure import Figure

    columns = min(len(fields), 3)
    rows = -(-len(fields) // columns)
    figure = Figure(figsize=(5.2 * columns, 4.5 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).flatten()
    top = max(float(_values(field, "pressure").max()) for field in fields)
    for panel, field, title in zip(panels, fields, titles, strict=False):
        image, label = _draw(field, panel, "pressure", top)
        panel.set_title(title, fontsize="medium")
    figure.colorbar(image, ax=list(panels), fraction=0.046, pad=0.02, label=label)
    for panel in panels[len(fields) :]:
        panel.set_axis_off()
    return figure
