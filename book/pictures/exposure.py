"""docs/exposure.md: levels at ears, tolerance to faults, and streaming (30 s)."""

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import midair
from pictures import DOCS, head, line

#: Four foci 6 cm apart, 0.15 m above 20 x 20 transducers.
FOCI = np.array([[x, y, 0.15] for x in (-0.03, 0.03) for y in (-0.03, 0.03)])


def ears() -> None:
    """Prints the levels at a head over four AUTD3 boards, without and with quiet points at its ears."""
    array = midair.Array.preset("autd3", tiles=(2, 2))
    middle = array.positions.mean(axis=0)
    scene = midair.Scene(array, middle + np.array([[-0.03, 0, 0.2], [0.03, 0, 0.2]]))
    scene = scene.replace(pressures=0.9 * scene.reach().level)
    places = {
        side: midair.ear(middle + np.array([x, 0.12, 0.5]), size=0.03) for side, x in (("left", -0.07), ("right", 0.07))
    }
    quiet = places["right"].quieten(places["left"].quieten(scene))
    for what, one in (("as it is", scene), ("quiet ears", quiet)):
        solution = midair.solve(one, "uniform")
        print(f"{what}: foci {np.abs(solution.pressures[:2]) / scene.pressures}")
        print(midair.exposure(scene, solution, places), "\n")


def others() -> None:
    """Prints the reported maximum of a box minus the loudest of 400 and of 40,000 places in it, in dB."""
    array = midair.Array.grid(20, 20, 10e-3)
    random = np.random.default_rng(0)
    focused = midair.solve(midair.Scene(array, FOCI), "uniform").drive
    apart = []
    for trial in range(200):
        low = random.uniform([-0.1, -0.1, 0.02], [0.1, 0.1, 0.5])
        high = low + random.uniform(0.003, 0.04, 3)
        drive = focused if trial % 2 else np.exp(2j * np.pi * random.random(400))
        scene = midair.Scene(array, FOCI)
        stated = midair.exposure(scene, drive, {"box": [low, high]}).worst.spl
        pressure = np.abs(midair.field(scene, drive, random.uniform(low, high, (40_000, 3))).pressure)
        loudest = [pressure[:count].max() for count in (400, 40_000)]
        apart.append(stated - 20 * np.log10(np.array(loudest) / np.sqrt(2) / 20e-6))
    print("reported - other places (400, 40,000), least and most in dB:")
    print(np.min(apart, axis=0), np.max(apart, axis=0), "\n")


def tolerance() -> None:
    """Prints the tolerance of eight foci of 16 x 16 transducers to every fault."""
    array = midair.Array.grid(16, 16, 10e-3)
    points = np.c_[np.random.default_rng(1).uniform(-0.05, 0.05, (8, 2)), np.full(8, 0.15)]
    sizes = {"phase": 20, "gain": 0.2, "dead": 0.05, "reversed": 0.05, "temperature": 5, "tilt": 1}
    table = midair.tolerate(midair.Scene(array, points), "uniform", position=0.5e-3, trials=500, **sizes)
    print(table, "\n")
    table.plot().savefig(DOCS / "tolerance.png", dpi=110)


def behind(count: int, seed: int) -> NDArray[np.float64]:
    """Returns random points in four vertical columns of 5 mm radius, 2 to 10 cm above the foci."""
    random = np.random.default_rng(seed)
    around = 0.005 * np.sqrt(random.random(count)) * np.exp(2j * np.pi * random.random(count))
    return FOCI[random.integers(4, size=count)] + np.c_[around.real, around.imag, random.uniform(0.02, 0.1, count)]


def streaming() -> None:
    """Prints the force in the columns above four foci, by the number and weight of quiet points there."""
    scene = midair.Scene(midair.Array.grid(20, 20, 10e-3), FOCI)
    level = scene.reach().level
    places = behind(4000, 2)
    loud = midair.solve(scene, "lm", pressures=level)
    whole = midair.streaming(scene, loud, places).force.mean()
    print(f"mean force behind four foci: {whole:.3g} N/m^3\n")
    head("quiet points", "weight of each", "force left", "level left", "uniformity")
    for count in (60, 240):
        for weight in (0.003, 0.01, 0.03):
            weights = np.r_[np.ones(4), np.full(count, weight)]
            points, pressures = np.r_[FOCI, behind(count, 1)], np.r_[level, np.zeros(count)]
            quiet = scene.replace(points=points, pressures=pressures, weights=weights)
            found = midair.solve(quiet, "lm")
            force = midair.streaming(scene, found, places).force.mean() / whole
            made = np.abs(found.pressures[:4])
            kept, even = made.mean() / np.abs(loud.pressures).mean(), made.min() / made.max()
            line(count, f"{weight:g}", f"{force:.2f}", f"{kept:.3f}", f"{even:.3f}")
            if (count, weight) == (240, 0.01):
                drives = {"four foci": loud, "quiet behind": found}
    draw(scene, drives)


def draw(scene: midair.Scene, drives: dict[str, midair.Solution]) -> None:
    """Draws the force in the plane through two of the foci, with one colour scale."""
    plane = midair.Plane(size=0.14, pixels=200, center=(0, 0.17), axis="y", at=0.03)
    maps = {name: midair.streaming(scene, drive, plane) for name, drive in drives.items()}
    top = max(one.force.max() for one in maps.values())
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
    for ax, (name, one) in zip(axes, maps.items(), strict=True):
        one.plot(ax)
        ax.images[0].set_clim(0, 0.3 * top)
        ax.set_title(name, fontsize="medium")
    figure.savefig(DOCS / "streaming.png", dpi=110)


def main() -> None:
    """Prints the tables and draws the pictures."""
    ears()
    others()
    tolerance()
    streaming()
