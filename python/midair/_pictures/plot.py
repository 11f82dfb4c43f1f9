"""Pictures: a field in a plane, what was asked and got at the points, and sheets of several solutions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, overload

from .._midair import Field, Plane, SceneError, Solution, field
from .answer import answer
from .colours import Quantity, colours
from .panel import add_bar, draw, grid, shape
from .sheet import Size, contact_sheet, resize
from .words import heading, place

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Quantity", "answer", "contact_sheet", "plot"]


class OwnPicture(Protocol):
    """What has a figure of its own, as a `midair.Sequence` has."""

    def plot(self) -> Figure: ...


@overload
def plot(  # type: ignore[overload-overlap]
    what: Field | Solution,
    ax: Axes | None = None,
    *,
    plane: Plane | None = None,
    quantity: Quantity = "pressure",
    vmax: float | None = None,
    cmap: str | None = None,
    size: Size | None = None,
) -> Axes: ...
@overload
def plot(what: OwnPicture) -> Figure: ...
def plot(
    what: Field | Solution | OwnPicture,
    ax: Axes | None = None,
    *,
    plane: Plane | None = None,
    quantity: Quantity = "pressure",
    vmax: float | None = None,
    cmap: str | None = None,
    size: Size | None = None,
) -> Axes | Figure:
    """Draw a field on a plane, the field of a solution in the plane through its points, or a sequence.

    ax : the axes to draw in; left out, matplotlib's present ones
    plane : of a solution, the midair.Plane in place of those through its points
    quantity : |p| in Pa ("pressure"), the radiation pressure on a wall in Pa ("radiation"), the sound
        pressure level in dB ("spl") or the phase of p ("phase")
    vmax : the value at the top of the colour scale, in Pa or dB; left out, the picture's largest, unless that
        is over twice as loud as all within two wavelengths of the points, as a transducer is
    cmap : the name of a colour map of matplotlib; left out, the quantity's own
    size : of a new figure in inches, its width or (width, height)

    Points of the plane are dots, quiet ones crosses; points off it are hollow rings where they project. Where
    it takes several planes to show the points, each has a panel if ax is left out. Returns the (first) axes.

    Of a `midair.Sequence`, which takes none of these arguments: waterfalls of |p| / target at the points and
    of the transducers' phase changes, and the spectrum of the radiation pressure. Returns the figure.

    Raises SceneError for another quantity, colour map or size, a field at single points and a solution of a
    matrix; TypeError for anything else to draw.
    """
    if isinstance(what, Solution):
        if what.scene is None:
            raise SceneError(
                "solution is of a matrix: a field needs a Scene, give midair.field(scene, solution)"
            )
        what = field(what.scene, what, plane)
    elif plane is not None:
        raise SceneError("plane is for a solution: a field has its own, leave it out")
    if not isinstance(what, Field) and callable(getattr(what, "plot", None)):
        if ax is not None or quantity != "pressure" or any(x is not None for x in (vmax, cmap, size)):
            kind = type(what).__name__.lower()
            raise SceneError(f"a {kind} has a figure of its own: leave ax, quantity, vmax, cmap and size out")
        return what.plot()
    if not isinstance(what, Field):
        kinds = "a midair.Field, midair.Solution or midair.Sequence"
        raise TypeError(f"expected {kinds} first, not {type(what).__qualname__}")
    if what.plane is None:
        raise SceneError("field is at single points: a picture needs a midair.Plane")
    panels = what.panels
    if ax is None:
        import matplotlib.pyplot as plt

        if plt.gcf().axes and not plt.gca().has_data():
            axes = [plt.gca()]
        else:
            # What has a picture keeps it.
            figure = plt.figure() if plt.gcf().axes else plt.gcf()
            figure.set_layout_engine("constrained")
            if len(panels) > 1:
                columns, rows = shape(panels)
                figure.set_size_inches(3.4 * columns + 0.9, 3.4 * rows + 1.0)
            axes = grid(figure, panels)
            resize(figure, size)
    else:
        axes = [ax]
    scale = colours(panels[: len(axes)], quantity, vmax=vmax).by(cmap)
    for panel, place_ax in zip(panels, axes, strict=False):
        image = draw(panel, place_ax, scale)
    add_bar(image, axes, scale)
    if len(axes) == 1:
        axes[0].set_title("\n".join([*heading(panels[: len(axes)]), place(what)]), fontsize="medium")
    else:
        for panel, place_ax in zip(panels, axes, strict=True):
            place_ax.set_title(place(panel), fontsize="medium")
        axes[0].figure.suptitle("\n".join(heading(panels[: len(axes)])), fontsize="medium")
    return axes[0]
