"""docs/traps.md: an upright slice through a trap in a TinyLev: |p|, the force, and the bead."""

import numpy as np
from numpy.typing import NDArray

import midair
from pictures import DOCS, INK, figure


def main() -> None:
    """Draws the picture."""
    scene = midair.Scene(midair.Array.preset("tinylev"), [[0, 0, 0]], signature="trap")
    solution = midair.solve(scene)
    field = midair.field(scene, solution, midair.Plane(axis="y", at=0, size=0.034, pixels=260, center=(0, 0)))
    side = np.linspace(-0.012, 0.012, 13)
    x, z = (each.ravel() for each in np.meshgrid(side, side))
    force: NDArray[np.float64] = midair.gorkov(scene, solution, points=np.c_[x, 0 * x, z]).force
    length = np.linalg.norm(force, axis=1)
    arrows = force / length[:, None] * np.minimum(length / np.quantile(length, 0.8), 1)[:, None]
    drawn, (ax,) = figure(4.9)
    pressure = np.abs(field.pressure) / 1e3
    shown = ax.pcolormesh(1e3 * field.x, 1e3 * field.z, pressure, cmap="magma", rasterized=True)
    ax.quiver(1e3 * x, 1e3 * z, arrows[:, 0], arrows[:, 2], color="white", scale=16, width=0.005)
    ax.plot(0, 0, "o", ms=13, color="white", mec=INK)
    ax.set(xlabel="x / mm", ylabel="z / mm", aspect="equal")
    drawn.colorbar(shown, ax=ax, label="|p| / kPa")
    drawn.savefig(DOCS / "traps.webp", dpi=130, pil_kwargs={"quality": 85, "method": 6})
