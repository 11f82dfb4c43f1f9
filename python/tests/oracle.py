"""Double-precision reference for the kernels, written from the definitions.

SI units, time factor e^{-jwt}: an outgoing wave is e^{+jkr}. The propagation matrix G has a row per point
and a column per transducer, so that a field is G @ drive.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator
from scipy.special import j1

T4010A1 = (1.0, 1.0, 1.0, 0.8913, 0.7079, 0.5012, 0.3548, 0.2512, 0.1995, 0.1778)
# In the greedy search, a later candidate replaces an earlier one only if its energy is lower by this part of
# E(0), the energy of the all-zero drive. So rounding never decides between candidates of equal energy.
TIE = 1e-12

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Directivity = str | tuple[str, float]


def pattern(directivity: Directivity, k: float, theta: Real) -> Real:
    """Returns the far-field pattern at angles from the normal; only point sources radiate backwards."""
    name, size = (directivity, 0.0) if isinstance(directivity, str) else directivity
    front = np.minimum(theta, np.pi / 2)
    x = k * size * np.sin(front)
    if name == "point":
        return np.ones_like(theta)
    if name == "piston":
        d = np.divide(2 * j1(x), x, out=np.ones_like(x), where=x != 0)
    elif name == "sinc":
        d = np.sinc(x / 2 / np.pi)
    elif name == "cos":
        d = np.cos(front) ** size
    elif name == "t4010a1":
        d = PchipInterpolator(np.arange(0, 91, 10), T4010A1)(np.degrees(front))
    else:
        raise ValueError(f"unknown directivity {name!r}")
    return np.where(theta <= np.pi / 2, d, 0.0)


def air(f: float, celsius: float, percent: float, pascals: float) -> tuple[float, float, float]:
    """Returns sound speed in m/s, absorption in dB/m and density in kg/m^3: ISO 9613-1, ideal gases."""
    kelvin, ratio, standard = celsius + 273.15, (celsius + 273.15) / 293.15, pascals / 101325
    saturated = 10 ** (4.6151 - 6.8346 * (273.16 / kelvin) ** 1.261)
    h = percent * saturated / standard
    oxygen = standard * (24 + 4.04e4 * h * (0.02 + h) / (0.391 + h))
    nitrogen = standard * ratio**-0.5 * (9 + 280 * h * math.exp(-4.170 * (ratio ** (-1 / 3) - 1)))
    classical = 1.84e-11 / standard * ratio**0.5
    relaxing = 0.01275 * math.exp(-2239.1 / kelvin) / (oxygen + f**2 / oxygen)
    relaxing += 0.1068 * math.exp(-3352.0 / kelvin) / (nitrogen + f**2 / nitrogen)
    loss = 8.686 * f**2 * (classical + ratio**-2.5 * relaxing)
    moist, gas = percent / 100 * saturated * 101325, 8.314462
    density = ((pascals - moist) * 0.0289647 + moist * 0.0180153) / (gas * kelvin)
    return 331.3 * math.sqrt(kelvin / 273.15), loss, density


def propagation(
    positions: ArrayLike,
    points: ArrayLike,
    *,
    normals: ArrayLike | None = None,
    response: ArrayLike | None = None,
    source_pressure: float = 4.386,
    directivity: Directivity = "point",
    frequency: float = 40e3,
    sound_speed: float = 340.0,
    absorption: float = 0.0,
) -> Complex:
    """Returns pressures (M, N) per unit of drive; normals default to +z. No point may be on a source."""
    k = 2 * np.pi * frequency / sound_speed
    way = np.asarray(points, float)[:, None] - np.asarray(positions, float)
    normal = np.broadcast_to([0.0, 0.0, 1.0] if normals is None else np.asarray(normals, float), way.shape)
    r = np.linalg.norm(way, axis=2)
    # arctan2 keeps digits near the axis that arccos would lose.
    theta = np.arctan2(np.linalg.norm(np.cross(normal, way), axis=2), np.sum(normal * way, axis=2))
    wave = source_pressure / r * pattern(directivity, k, theta) * np.exp((1j * k - absorption) * r)
    return wave * (1.0 if response is None else np.asarray(response, complex))


def reach(G: Complex) -> Real:
    """Returns the largest pressure that a drive with all |q| <= 1 can give at each point alone."""
    return np.abs(G).sum(axis=1)


def balanced_factor(G: Complex, targets: ArrayLike, weights: ArrayLike | None = None) -> float:
    """Returns the factor s for which the sum of (s t / p1)^2 over the points is 1.
    t are the targets and p1 is `reach`. The factor is 0 if a target has p1 = 0.
    """
    t, w = _targets(targets, weights)
    use = (w > 0) & (t > 0)
    with np.errstate(divide="ignore"):
        return float(1 / np.linalg.norm(t[use] / reach(G)[use]))


def _targets(targets: ArrayLike, weights: ArrayLike | None) -> tuple[Real, Real]:
    t = np.asarray(targets, float)
    return t, np.ones_like(t) if weights is None else np.asarray(weights, float)


class _Walk:
    """The state of the greedy search, which sets one transducer after the other. It uses the points of weight
    > 0.
    """

    def __init__(
        self,
        G: Complex,
        targets: ArrayLike,
        *,
        weights: ArrayLike | None = None,
        phases: int = 16,
        amplitudes: int = 1,
        objective: str = "l2",
    ) -> None:
        t, w = _targets(targets, weights)
        live = w > 0
        self.G, self.t, self.w = np.asarray(G)[live], t[live], w[live]
        self.power = {"l1": 1, "l2": 2}[objective]
        steps = np.exp(2j * np.pi * np.arange(phases) / phases)
        self.grid = (np.arange(1, amplitudes + 1) / amplitudes)[:, None] * steps
        self.P = np.zeros(len(self.t), complex)
        self.silent = float(self.w @ np.abs(self.t) ** self.power)

    def candidates(self, i: int) -> Complex:
        """Returns the candidates: for each amplitude, all phases.
        While the pressures P are 0, all phases have the same energy, so only phase 0 is returned.
        """
        if not self.G[:, i].any():
            return np.zeros(0, complex)
        return (self.grid if self.P.any() else self.grid[:, :1]).ravel()

    def changes(self, i: int, q: Complex) -> Real:
        """Returns the change of the energy, E(P + G q) - E(P), for each candidate q of transducer i.
        It sums small differences, because subtracting two energies would lose digits.
        """
        step = np.multiply.outer(q, self.G[:, i])
        before, after = np.abs(self.P), np.abs(self.P + step)
        squares = 2 * np.real(self.P.conj() * step) + np.abs(step) ** 2
        rise = np.divide(squares, before + after, out=np.zeros_like(after), where=before + after > 0)
        gap = self.t - before
        cost = rise * (rise - 2 * gap) if self.power == 2 else np.abs(gap - rise) - np.abs(gap)
        return cost @ self.w

    def add(self, i: int, q: complex) -> None:
        self.P += self.G[:, i] * q


def greedy(G: Complex, targets: ArrayLike, *, order: ArrayLike, **search: Any) -> Complex:
    """Returns the drive of Algorithm 2 of Suzuki et al. 2021; `search` has the keywords of _Walk."""
    walk = _Walk(G, targets, **search)
    drive = np.zeros(G.shape[1], complex)
    for i in np.asarray(order):
        candidates, best = walk.candidates(i), np.inf
        for q, change in zip(candidates, walk.changes(i, candidates), strict=True):
            if change < best - TIE * walk.silent:
                drive[i], best = q, change
        walk.add(i, drive[i])
    return drive


def regrets(G: Complex, targets: ArrayLike, drive: ArrayLike, *, order: ArrayLike, **search: Any) -> Real:
    """Returns, for each step, the energy of this drive minus the least energy of all candidates,
    divided by E(0) unless E(0) is 0.
    """
    walk = _Walk(G, targets, **search)
    drive = np.asarray(drive, complex)
    steps = []
    for i in np.asarray(order):
        candidates = walk.candidates(i)
        taken = walk.changes(i, drive[i : i + 1])[0]
        steps.append(taken - walk.changes(i, candidates).min() if candidates.size else 0.0)
        walk.add(i, drive[i])
    return np.array(steps) / (walk.silent or 1.0)


def naive(G: Complex, targets: ArrayLike, limit: str = "clamp") -> Complex:
    """Returns the limited sum of the back-propagated drives of all single foci.
    A point that no transducer reaches adds nothing.
    """
    power = np.sum(np.abs(G) ** 2, axis=1)
    share = np.divide(np.asarray(targets, float), power, out=np.zeros_like(power), where=power > 0)
    q = G.conj().T @ share
    size = np.abs(q)
    divisor = {"clamp": np.maximum(size, 1), "normalize": np.full_like(size, size.max()), "full": size}[limit]
    return np.divide(q, divisor, out=np.zeros_like(q), where=size > 0)


def metrics(p_abs: ArrayLike, targets: ArrayLike, weights: ArrayLike | None = None) -> dict[str, float]:
    """Returns the metrics of the magnitudes |p|. Some point must have a target > 0 and a weight > 0."""
    p, (t, w) = np.asarray(p_abs, float), _targets(targets, weights)
    leak = p[(w > 0) & (t == 0)].max(initial=0)
    use = (w > 0) & (t > 0)
    p, t, w = p[use], t[use], w[use]
    x = p / t
    # If all pressures are 0, no ratio is above 0: sigma and uniformity are then 0.
    unit = x.max() or 1.0
    return {
        "accuracy": float(p.sum() / t.sum()),
        "sigma": float(np.std(x / unit)),
        "uniformity": float(x.min() / unit),
        "level": float(x.mean()),
        "residual": float(w @ (t - p) ** 2 / (w @ t**2)),
        "leak": float(leak / t.max()),
    }
