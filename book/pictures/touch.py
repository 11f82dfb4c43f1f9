"""docs/touch.md: common tactile techniques by `midair.skin`, and `midair.haptic` beside them (5 min)."""

import math

import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray

import midair
from midair._midair import HIGHEST, Membrane, threshold
from midair._touch.haptic import _Judge
from midair._touch.schedule import Curve
from pictures import DOCS

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


#: Boards, the height of the hand in m, and frames per second.
BOARDS = {
    "four AUTD3 boards": (midair.Array.preset("autd3", tiles=(2, 2)), HEIGHT, 4e3),
    "SonicSurface": (midair.Array.preset("sonicsurface"), 0.15, 89.0),
}

#: The largest number of sweeps over the spectral lines in `bound`.
SWEEPS = 12


def letter(height: float) -> NDArray[np.float64]:
    """Returns points of an S 3 cm high, from two arcs of three quarters of a circle."""
    turn = np.linspace(0, 1.5 * np.pi, 80)
    upper = 0.0075 * np.stack([np.cos(turn), 1 + np.sin(turn)], axis=1)
    lower = 0.0075 * np.stack([np.sin(turn), np.cos(turn) - 1], axis=1)
    places = np.concatenate([upper, lower])
    return np.column_stack([places, np.full(len(places), height)])


def bound(answers: NDArray[np.complex64]) -> float:
    """Returns an upper bound of the root mean square that fast receptors feel on a curve, over all schedules.

    A schedule plays one focus per frame. Its lines I_f over T frames have sum_f (I_f I_f^H + conj.) <= T
    diag(n), where n counts the frames of each focus. So sum_f I_f^H M_f I_f <= T^2 max(diag Z) for every
    real symmetric Z with 2 Z >= M_f for all f. Here M_f = A_f^H A_f / X, and A_f are the skin's responses to
    focus f at X places.
    """
    strongest = np.argsort([-np.linalg.norm(a, 2) for a in answers])
    matrices = [a.conj().T @ a / len(a) for a in answers[strongest].astype(np.complex128)]
    total = np.zeros(matrices[0].shape)
    least = 1e-9 * max(float(np.trace(m).real) for m in matrices)
    for _ in range(SWEEPS):
        enough = True
        for matrix in matrices:
            values, vectors = np.linalg.eigh(matrix / 2 - total)
            if values[-1] > least:
                part = vectors[:, values > 0]
                total += ((part * values[values > 0]) @ part.conj().T).real
                enough = False
        if enough:
            break
    return float(np.sqrt(np.diag(total).max()))


#: Sizes of the linear program in `on_circle`: angular orders, time lags in frames, and angles.
ORDERS, LAGS, ANGLES = 14, 60, 61

#: Largest spatial frequency of the radiation pressure of a focus 20 cm from four AUTD3 boards, in rad/m: 2 k
#: times the sine of half the angle of the focus's cone.
FINEST = 1150.0


def on_circle(radius: float, speed: float, rate: float = 4e3) -> float:
    """Returns an upper bound in dB of the gain by jumping between foci on a circle, in the best order.

    The gain is relative to a focus that moves steadily at `speed` m/s.

    Let C(a, l) be the probability of a focus at an angle a from that of l frames ago, and S_m(f) >= 0 its
    spectral lines: sum_f S_m(f) = 1, and S_0 is at 0 Hz alone. The mean square on the circle is the sum over
    m, f of |R_m(f)|^2 S_m(f), where R_m is the skin's response to the order m. Let D(a, l) >= 0 satisfy
    -D_m(f) >= |R_m(f)|^2 for every m > 0. Then the mean square is at most D_0(0), because sum D C >= 0. A
    linear program finds the least D_0(0); the errors of its grids are added.
    """
    from scipy.optimize import linprog
    from scipy.sparse import block_diag, csr_array, eye_array, hstack, kron, vstack
    from scipy.special import jv

    sheet, lags = Membrane(), np.arange(LAGS + 1)
    k = (np.arange(4000) + 0.5) * FINEST / 4000
    orders = np.arange(1, 27)
    waves = jv(orders[:, None], k * radius) ** 2 * k * (FINEST / 4000)

    def powers(frequencies: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns |R_m(f)|^2 in squares of the threshold, for a force of 1 N."""
        felt = (frequencies > 0) & (frequencies <= HIGHEST)
        f = np.where(felt, frequencies, HIGHEST)
        answers = waves @ (1 / (k[:, None] ** 2 + sheet.decay(f) ** 2)) / (2 * np.pi * sheet.tension)
        found: NDArray[np.float64] = np.abs(answers / threshold(True, f)) ** 2 * felt
        return found

    def cosines(frequencies: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.cos(2 * np.pi * np.outer(frequencies, lags) / rate) * np.where(lags == 0, 1, 2)

    def turns(count: int) -> NDArray[np.float64]:
        m = np.arange(ORDERS + 1)
        return np.cos(np.outer(np.linspace(0, np.pi, count), m)) * np.where(m == 0, 1, 2)

    grid, fine = np.arange(0, rate / 2 + 1, 8.0), np.arange(0, rate / 2 + 1, 2.0)
    exact = powers(fine)
    scale = exact.max()
    needed = powers(grid)[:ORDERS] / scale
    lines = hstack([csr_array((needed.size, LAGS + 1)), block_diag([cosines(grid)] * ORDERS)])
    weights = np.where(lags == 0, 1.0, 2.0)
    found = linprog(
        np.concatenate([weights, np.zeros(ORDERS * (LAGS + 1))]),
        A_ub=vstack([lines, -kron(turns(ANGLES), eye_array(LAGS + 1))]),
        b_ub=np.concatenate([-needed.ravel(), np.zeros(ANGLES * (LAGS + 1))]),
        bounds=(None, None),
        method="highs-ipm",
    )
    d = found.x.reshape(ORDERS + 1, LAGS + 1)
    above = np.maximum((exact[:ORDERS] / scale + d[1:] @ cosines(fine).T).max(axis=1), 0).sum()
    above += exact[ORDERS:].max(axis=1).sum() / scale
    below = np.maximum(-(turns(4000) @ d).min(axis=0), 0) @ weights
    most = found.fun + below + 2 * above
    laps = speed / (2 * np.pi * radius)
    drawn = 2 * sum(np.interp(m * laps, fine, exact[m - 1]) for m in orders) / scale
    return float(10 * np.log10(most / drawn))


def chosen() -> None:
    """Prints the gain of `midair.haptic` for several shapes, and upper bounds of the gain."""
    gain = on_circle(0.015, 7.0)
    print(f"foci on a circle of 3 cm, in any order: at most {gain:.2f} dB above one at 7 m/s")
    for board, (array, height, rate) in BOARDS.items():
        circle = midair.path.circle([0, 0, height], 0.015, speed=1)
        line = [[-0.025, 0, height], [0.025, 0, height]]
        for name, shape in (
            ("circle of 3 cm", circle),
            ("line of 5 cm", line),
            ("S of 3 cm", letter(height)),
        ):
            for aim in ("strong", "even"):
                found = midair.haptic(shape, array, rate=rate, aim=aim)
                usual = ", ".join(f"{value:.1f}" for value in found.standards.values())
                print(
                    f"{board}, {name}, {aim}: {usual}; {found.strength:.1f} dB, weakest {found.weakest:.1f}, "
                    f"{found.gain:+.1f} dB, {found.technique}"
                )
            if rate > 1e3:
                judge = _Judge(array, Curve.of(shape, closed=False), rate, 0.014, Membrane(), {})
                foci = judge.foci
                best = max(foci.strengths(foci.climb(start, "strong")).mean() for start in judge.starts())
                above = 20 * np.log10(foci.frames * bound(foci.answers) / best)
                print(f"{board}, {name}: no schedule of these foci is more than {above:.1f} dB above it")


def main() -> None:
    """Draws the picture and prints the tables."""
    chosen()
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
    figure.savefig(DOCS / "touch.png", dpi=75)
