"""Reads marks out of figures for the tests of plots, and makes scenes that are quick to draw."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import midair
from scenes import small


def flat(**scene) -> midair.Scene:
    """Returns a scene of three points at the same height."""
    points = scene.pop("points", [[-0.02, 0, 0.15], [0.02, 0.01, 0.15], [0, -0.02, 0.15]])
    return small(points=points, **scene)


def marks(ax: Axes) -> dict[str, np.ndarray]:
    """Returns the positions in mm of the dots, rings and crosses of a plot."""
    found = {name: np.zeros((0, 2)) for name in ("dots", "rings", "crosses")}
    for mark in ax.collections:
        name = "rings" if len(mark.get_facecolor()) == 0 else "dots"
        name = name if mark.get_paths()[0].codes is not None and len(mark.get_paths()[0].codes) > 10 else "crosses"
        found[name] = np.concatenate([found[name], np.asarray(mark.get_offsets())])
    return found


def images(figure: Figure) -> list[np.ndarray]:
    """Returns the values of the images, in Pa where they are drawn in kPa."""
    unit = kilo(figure)
    return [unit * image.get_array() for ax in figure.axes for image in ax.images]


def kilo(figure: Figure) -> float:
    """Returns 1000 for a figure in kPa, else 1."""
    return 1e3 if any(ax.get_ylabel().endswith("/ kPa") for ax in figure.axes) else 1.0


def titles(figure: Figure) -> str:
    return "\n".join([figure.get_suptitle(), *(ax.get_title() for ax in figure.axes)])
