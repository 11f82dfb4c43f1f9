"""A calibration drawn: gains, phases and residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .result import Calibration


def draw(calibration: Calibration) -> Figure:
    """Gains and phases over the array from above, and how far the readings lie off the model."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 3.8), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    places = calibration.array.positions * 1e3
    shades = (
        (left, calibration.gain, "gain", "viridis", {"vmin": 0.0, "vmax": float(calibration.gain.max())}),
        (
            middle,
            np.degrees(calibration.phase),
            "phase / degrees",
            "twilight",
            {"vmin": -180.0, "vmax": 180.0},
        ),
    )
    for ax, values, title, colours, ends in shades:
        _over_array(ax, places, values, colours, ends)
        for marked, sign, name in ((calibration.dead, "x", "dead"), (calibration.reversed, "o", "reversed")):
            if len(marked):
                edge: dict[str, Any] = (
                    {"c": "red"} if sign == "x" else {"facecolors": "none", "edgecolors": "red"}
                )
                ax.scatter(*places[marked, :2].T, marker=sign, s=60, label=f"{len(marked)} {name}", **edge)
        if len(calibration.dead) + len(calibration.reversed):
            ax.legend(fontsize="x-small", loc="upper right")
        ax.set_title(title, fontsize="medium")
        ax.set_xlabel("x / mm")
    left.set_ylabel("y / mm")
    for m, heard in enumerate(np.abs(calibration.residuals).T):
        right.plot(heard, ".", markersize=3, label=f"microphone {m}")
    right.axhline(calibration.noise, color="black", linewidth=0.8, label="standard deviation found")
    right.set_title("residuals / Pa", fontsize="medium")
    right.set_xlabel("drive")
    right.legend(fontsize="x-small", loc="upper right")
    return figure


def _over_array(ax: Any, places: Any, values: Any, colours: str, ends: dict[str, float]) -> None:
    size = 1.5e4 / max(len(places), 60)
    shown = ax.scatter(*places[:, :2].T, c=values, s=size, cmap=colours, linewidths=0, **ends)
    ax.figure.colorbar(shown, ax=ax, shrink=0.8)
    ax.set_aspect("equal")
    ax.margins(0.06)
