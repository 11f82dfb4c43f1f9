"""Four usual techniques on the skin, by `midair.skin`: docs/touch.png, and their strength.

`make touch` runs it.
"""

from __future__ import annotations

import math
from pathlib import Path

from matplotlib import pyplot as plt

import midair

HEIGHT = 0.2
MIDDLE = (0.0, 0.0, HEIGHT)
PLANE = midair.Plane(z=HEIGHT, size=0.08, pixels=64)
PANELS = ("pressure", "motion", "spectrum")

TECHNIQUES = {
    "AM at 200 Hz": midair.path.still(MIDDLE, duration=0.005).modulated(200, "cosine"),
    "LM at 100 Hz, radius 8.5 mm": midair.path.circle(MIDDLE, 0.0085, frequency=100),
    "STM at 7 m/s, radius 20 mm": midair.path.circle(MIDDLE, 0.02, speed=7),
    "two foci at 7 m/s, radius 20 mm": midair.path.circle(MIDDLE, 0.02, speed=7, points=2),
}


def main() -> None:
    """Draw and print."""
    array = midair.Array.preset("autd3", tiles=(2, 2))
    figure, axes = plt.subplots(4, 3, figsize=(10, 12.5), layout="constrained")
    for row, (name, path) in zip(axes, TECHNIQUES.items(), strict=True):
        drawn = midair.sequence(array, path, rate=20e3, change=math.pi)
        touch = midair.skin(drawn, PLANE)
        for panel, ax in zip(PANELS, row, strict=True):
            touch.plot(ax=ax, panels=panel)
        row[0].set_title(name, fontsize="medium")
        width, focus = 1e3 * touch.width(), 1e3 * touch.focus_width()
        print(f"{name:32} {touch.level:5.1f} dB, {width:.1f} mm felt, {focus:.1f} mm of pressure")
    figure.savefig(Path(__file__).parents[1] / "docs" / "touch.png", dpi=75)


if __name__ == "__main__":
    main()
