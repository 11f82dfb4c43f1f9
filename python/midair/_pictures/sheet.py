"""The sheet that a picture is drawn on: its size, a journal's style, its panels and its fonts.

Drawing imports this module, and `import midair` does not: it loads matplotlib.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from matplotlib import colormaps, rc_context, rcParams
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure

from .._midair import SceneError
from .colours import MAPS, Map, table

#: Width in inches, or width and height.
Size = float | tuple[float, float]

Name = TypeVar("Name", bound=str)

#: Letters of a file as TrueType fonts and as text: journals refuse Type 3 fonts and outlines.
FONTS: dict[Any, Any] = {"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}


@dataclass(frozen=True)
class Style:
    """How a journal wants figures.

    Attributes
    ----------
    columns
        Widths of one column and of a page in inches.
    settings
        Matplotlib's; a style holds while figure.figsize is its own.
    """

    columns: tuple[float, float]
    settings: dict[Any, Any]


STYLES = {
    # IEEE, "Create graphics for your article": 3.5 and 7.16 inches, Times or Arial of 8 to 10 points.
    "ieee": Style(
        (3.5, 7.16),
        {
            **FONTS,
            "figure.figsize": [3.5, 2.625],
            "font.family": ["serif"],
            # matplotlib brings STIX along, whose letters are those of Times.
            "font.serif": ["Times New Roman", "STIXGeneral"],
            "mathtext.fontset": "stix",
            "font.size": 8.0,
            "axes.titlesize": "medium",
            "axes.labelsize": "medium",
            "xtick.labelsize": "medium",
            "ytick.labelsize": "medium",
            "legend.fontsize": "medium",
            "legend.title_fontsize": "medium",
            "axes.linewidth": 0.6,
            "lines.linewidth": 1.0,
            "xtick.major.width": 0.6,
            "ytick.major.width": 0.6,
            "xtick.major.size": 2.5,
            "ytick.major.size": 2.5,
            "savefig.dpi": 600,
        },
    )
}


def style(name: str) -> AbstractContextManager[object]:
    """Draw figures as a journal wants them, from now on or within a `with` statement.

    Parameters
    ----------
    name : {"ieee"}
        Columns of 3.5 and 7.16 inches, letters of 8 points, TrueType fonts.

    Returns
    -------
    context manager
        For a `with` statement; at its end all is as before.

    Raises
    ------
    SceneError
        For another name.

    Notes
    -----
    Figures of midair are then one column wide, or a page wide where they have several panels. They have no
    heading: that is the caption's. The setting is matplotlib's: figures of your own follow it, and
    `matplotlib.rcdefaults()` ends it.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.preset("paper20")
    >>> solution = midair.solve(midair.Scene(array, [[-0.02, 0, 0.15], [0.02, 0, 0.15]]))
    >>> with midair.style("ieee"):
    ...     figure = solution.plot(panels="field")
    >>> float(figure.get_figwidth())
    3.5
    """
    if name not in STYLES:
        known = " or ".join(f'"{known}"' for known in STYLES)
        raise SceneError(f"style is {name!r}: give {known}")
    settings = STYLES[name].settings
    before: dict[Any, Any] = {key: rcParams[key] for key in settings}
    rcParams.update(settings)
    back = ExitStack()
    back.callback(lambda: rcParams.update(before))
    return back


def holding() -> Style | None:
    """The style that holds."""
    size = list(rcParams["figure.figsize"])
    return next((style for style in STYLES.values() if style.settings["figure.figsize"] == size), None)


class Sheet(Figure):
    """A figure whose files have TrueType fonts and text."""

    def savefig(self, *arguments: Any, **keywords: Any) -> None:
        """Write the figure, as matplotlib does."""
        with rc_context(FONTS):
            super().savefig(*arguments, **keywords)


def head(figure: Figure, *lines: str) -> None:
    """The lines above all panels, those that are not empty; a journal has a caption in their place."""
    if holding() is None:
        figure.suptitle("\n".join(filter(None, lines)), fontsize="medium", wrap=True)


def sheet(
    width: float, height: float, size: Size | None = None, make: Callable[..., Any] | None = None
) -> Sheet:
    """A new sheet of `size`, else as wide as the style's column or page, else of width and height in inches.

    Parameters
    ----------
    make
        Pyplot's `figure`, where the picture is to have a window.

    Raises
    ------
    SceneError
        For another size.
    """
    style = holding()
    if size is None:
        wide = width if style is None else style.columns[width > 2 * style.columns[0]]
        sides: Sequence[float] = (wide, height * wide / width)
    elif isinstance(size, int | float):
        sides = (size, height * size / width)
    else:
        sides = size
    if len(sides) != 2 or not all(np.isfinite(side) and side > 0 for side in sides):
        raise SceneError(f"size is {size!r}: give a width in inches, or (width, height)")
    if make is None:
        return Sheet(figsize=(sides[0], sides[1]), layout="constrained")
    made: Sheet = make(FigureClass=Sheet, figsize=sides, layout="constrained")
    return made


def chosen(panels: Name | Iterable[Name] | None, known: Sequence[Name], ax: Axes | None = None) -> list[Name]:
    """The panels to be drawn, left out all; axes of the caller's own hold one, left out the first.

    Raises SceneError for another name, and for several in one axes.
    """
    names = [panels] if isinstance(panels, str) else list(known if panels is None else panels)
    if not names or set(names) - set(known):
        listed = ", ".join(f'"{name}"' for name in known)
        raise SceneError(f"panels is {panels!r}: give one of {listed}, or several in a list")
    if ax is None or panels is None:
        return names if ax is None else names[:1]
    if len(names) > 1:
        raise SceneError(f"panels is {panels!r}: ax holds one panel, name one or leave ax out")
    return names


colormaps.register(ListedColormap(table("phase") / 255, MAPS["phase"]), force=True)
colormaps.register(ListedColormap(table("field_light") / 255, "midair.light"), force=True)


def colour_map(cmap: Map | None, own: str) -> Map:
    """A colour map of the caller's, left out our own. Raises SceneError for a name that matplotlib lacks."""
    if cmap is None:
        return own
    if not isinstance(cmap, Colormap) and cmap not in colormaps:
        raise SceneError(f"cmap is {cmap!r}: give a name that matplotlib has, such as {own}")
    return cmap


def whole(ax: Axes) -> Figure:
    """The figure that axes of the caller's own belong to."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure
