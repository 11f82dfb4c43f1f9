"""The body force of the sound in a plane: a map in N/m^3, with arrows along it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._midair import SceneError
from .panel import paint, sides
from .words import place

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..streaming import Streaming

#: Arrows along a side, and the part of the largest force below which there is none.
ARROWS, FAINT = 20, 0.05


def draw(streaming: Streaming, ax: Axes | None = None) -> Axes:
    """The map."""
    field = streaming.field
    if field.plane is None:
        raise SceneError("the force is at single points: a picture needs a midair.Plane")
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.gca()
    top = float(streaming.force.max())
    image = paint(field, ax, streaming.force, "cividis", (0.0, top or 1.0))
    across, up = sides(field)
    every = max(field.plane.pixels // ARROWS, 1)
    here = (slice(every // 2, None, every),) * 2
    names = field.x, field.y, field.z
    u, v = np.meshgrid(names[across], names[up])  # type: ignore[arg-type]
    strong = streaming.force[here] > FAINT * top
    ax.quiver(
        1e3 * u[here][strong],
        1e3 * v[here][strong],
        streaming.direction[here][strong][:, across],
        streaming.direction[here][strong][:, up],
        color="white",
        alpha=0.8,
        scale=1.3 * ARROWS,
        width=0.004,
    )
    ax.set_title(place(field), fontsize="medium")
    label = f"force / (N/m³), absorption {streaming.absorption:.3g} Np/m"
    ax.figure.colorbar(image, ax=ax, fraction=0.046, pad=0.03, label=label)
    return ax
