"""Figures: their size, journal styles, choice of panels, and fonts.

Only drawing imports this module, because it loads matplotlib; `import midair` does not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from matplotlib import colormaps, rc_context, rcParams
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure

from .._support.arguments import refused
from .colours import MAPS, Map, Size, table

Name = TypeVar("Name", bound=str)

#: Fonts of a saved file: text in TrueType. Journals reject Type 3 fonts and letters as outlines.
FONTS: dict[Any, Any] = {"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}


@dataclass(frozen=True)
class Style:
    """A journal's rules for figures.

    Attributes
    ----------
    columns
        Widths of one column and of a page in inches.
    settings
        Matplotlib's settings. The style is active while matplotlib's figure.figsize has the value in them.
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
            # matplotlib includes STIX, whose letters look like those of Times.
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
    """Draw figures in the style of a journal, from now on or within a `with` statement.

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
        If the style is unknown.

    Notes
    -----
    Figures of midair are then one column wide, or a page wide where they have several panels. They have no
    heading, since a caption contains it. The settings are matplotlib's: your own figures follow them, and
    `matplotlib.rcdefaults()` ends them.

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
        raise refused("style", name, f"give {known}")
    settings = STYLES[name].settings
    before: dict[Any, Any] = {key: rcParams[key] for key in settings}
    rcParams.update(settings)
    back = ExitStack()
    back.callback(lambda: rcParams.update(before))
    return back


def holding() -> Style | None:
    """Return the active style, None if there is none."""
    size = list(rcParams["figure.figsize"])
    return next((style for style in STYLES.values() if style.settings["figure.figsize"] == size), None)


class FontFigure(Figure):
    """A figure whose saved files contain text in TrueType fonts."""

    def savefig(self, *arguments: Any, **keywords: Any) -> None:
        """Save the figure, as matplotlib does."""
        with rc_context(FONTS):
            super().savefig(*arguments, **keywords)


def head(figure: Figure, *lines: str) -> None:
    """Write the lines that are not empty above all panels. Journal styles have no heading."""
    if holding() is None:
        figure.suptitle("\n".join(filter(None, lines)), fontsize="medium", wrap=True)


def new_figure(
    width: float, height: float, size: Size | None = None, make: Callable[..., Any] | None = None
) -> FontFigure:
    """Return a new figure of `size`. By default it is as wide as a column or page of the journal's style.

    Parameters
    ----------
    width, height
        Default size in inches if no style is set; a style keeps their ratio.
    size
        Width, or width and height, in inches.
    make
        Pyplot's `figure`, if the picture needs a window.

    Raises
    ------
    SceneError
        For an invalid size.
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
        raise refused("size", size, "give a width in inches, or (width, height)")
    if make is None:
        return FontFigure(figsize=(sides[0], sides[1]), layout="constrained")
    made: FontFigure = make(FigureClass=FontFigure, figsize=sides, layout="constrained")
    return made


def check_axes(ax: Axes | None) -> None:
    """Raise TypeError for what is no Axes, such as the name of a file."""
    if ax is not None and not hasattr(ax, "imshow"):
        raise TypeError(f"ax is {ax!r}: give Axes of matplotlib; .plot().savefig(...) writes a file")


def chosen(panels: Name | Iterable[Name] | None, known: Sequence[Name], ax: Axes | None = None) -> list[Name]:
    """Return the panels to draw, by default all; for the caller's axes one, by default the first.

    Raises SceneError for an unknown name, and for several panels in one pair of axes.
    """
    check_axes(ax)
    names = [panels] if isinstance(panels, str) else list(known if panels is None else panels)
    if not names or set(names) - set(known):
        listed = ", ".join(f'"{name}"' for name in known)
        raise refused("panels", panels, f"give one of {listed}, or several in a list")
    if ax is None or panels is None:
        return names if ax is None else names[:1]
    if len(names) > 1:
        raise refused("panels", panels, "ax holds one panel, name one or leave ax out")
    return names


def row(
    panels: Name | Iterable[Name] | None,
    known: Sequence[Name],
    ax: Axes | None,
    size: Size | None,
    *,
    width: float,
    height: float,
    sharey: bool = False,
) -> tuple[Figure, dict[Name, Axes]]:
    """Return the figure and the axes of each panel by its name: the caller's axes, or a row of new ones.

    A new panel has `width` and `height` in inches unless `size` is given for the figure.
    """
    names = chosen(panels, known, ax)
    if ax is not None:
        return whole(ax), {names[0]: ax}
    figure = new_figure(width * len(names), height, size)
    axes = figure.subplots(1, len(names), squeeze=False, sharey=sharey)[0]
    return figure, dict(zip(names, axes, strict=True))


colormaps.register(ListedColormap(table("phase") / 255, MAPS["phase"]), force=True)
colormaps.register(ListedColormap(table("field_light") / 255, "midair.light"), force=True)


def colour_map(cmap: Map | None, own: str) -> Map:
    """Return the caller's colour map, by default `own`; raises SceneError for an unknown name."""
    if cmap is None:
        return own
    if not isinstance(cmap, Colormap) and cmap not in colormaps:
        raise refused("cmap", cmap, f"give a name that matplotlib has, such as {own}")
    return cmap


def dots(ax: Axes, values: Mapping[str, float], label: str, marked: tuple[str, ...], line: float | None = None) -> None:
    """Draw levels in dB as dots, one a row, with their values; rows `marked` in colour, and an upright line."""
    finite = [value for value in (*values.values(), line) if value is not None and np.isfinite(value)]
    low, high = (min(finite), max(finite)) if finite else (0.0, 1.0)
    for row, (name, value) in enumerate(values.items()):
        none = not np.isfinite(value)
        at = low if none else value
        ax.plot(at, row, "<" if none else "o", color="tab:orange" if name in marked else "tab:blue")
        ax.text(at, row - 0.2, "none" if none else f"{value:.1f}", ha="center", va="bottom", fontsize="small")
    if line is not None:
        ax.axvline(line, color="black", linewidth=0.9)
    spare = max(0.15 * (high - low), 1.0)
    ax.set(xlabel=label, xlim=(low - spare, high + spare), ylim=(len(values) - 0.5, -0.7))
    ax.set_yticks(range(len(values)), list(values))
    ax.grid(axis="y", alpha=0.3)


def whole(ax: Axes) -> Figure:
    """Return the figure that contains the caller's axes."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure
