"""Audible sound that the air makes of ultrasound that changes in time, at ears, by Westervelt's equation.

With the complex amplitude P of the ultrasound, E = |P|^2/2 is the slow part of the squared pressure. Its
sound at an ear is an integral over the air in front of the array (Westervelt 1963, J. Acoust. Soc. Am. 35,
535; as in Zhong's AWPAL, github.com/JiaxinZhong/AWPAL):

    p(t) = beta/(4 pi rho c^4) integral of d^2 E(t - R/c)/dt^2 / R dV,    R: distance to the ear.

Far from a narrow beam of amplitude P0 f(t) and area S this is Berktay's formula (1965, J. Sound Vib. 2, 435),
beta P0^2 S/(16 pi rho c^4 r alpha) d^2 f^2/dt^2.
"""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, demodulate, memory_limit
from .._sequence import Sequence
from .._sequence.drives import rows
from .._sequence.felt import RECEIVED, a_weighting
from .._support.arguments import refused
from .._support.text import counted

#: Coefficient of nonlinearity of air: (1 + 1.4)/2 for a gas of two atoms a molecule.
BETA = 1.2

#: Time constant of the transducers in s, in the middle of .1 to .5 ms (docs/motion.md, "Limits of motion").
TAU = 2e-4

#: Planes of the integral: first distance in m, growth, largest distance, and length beyond the ears in m.
STEP, GROWTH, WIDEST, BEYOND = 0.015, 1.03, 0.05, 0.7

#: Distance of neighbouring points, over the longest that integrates exactly.
FINE = 1.0

#: Distance of points in m beside an ear; half of the distance to the ear, farther away.
CLOSE = 0.03

#: Tangent of the largest angle from the array's axis; the beam ends where e^(-2 alpha z) is e^-END.
SLANT, END = 1.2, 7.0

#: Number of transducers, about, from which the mean way to a point is computed.
COUNTED = 32

#: Width in m of the bins of ways to an ear: a tenth of a radian at 7 kHz.
BIN = 2.5e-3

#: Largest number of products (transducers x frames x points) in a block, and of delays and lines: they take a tenth
#: of a second.
WORK, CELLS = 1 << 29, 1 << 20


def planes(scene: Scene, ears: NDArray[np.float64]) -> Iterator[tuple[NDArray[np.float64], float]]:
    """Yield the points (V, 3) in m of planes in front of an array, and the volume in m^3 of each point.

    |P|^2 has no spatial frequency above k D/sqrt(z^2 + D^2/4), where D is the width of the array. A regular
    grid that is finer than the shortest period integrates exactly, near to an ear a finer one.
    """
    axis, middle = scene.array.normals.mean(axis=0), scene.array.positions.mean(axis=0)
    if np.linalg.norm(axis) < 0.5:
        raise refused("array", "transducers that face each other", "give an array that radiates to one side")
    axis /= np.linalg.norm(axis)
    across, apart = np.linalg.svd(axis[None])[2][1:], scene.array.positions - middle
    width = 2 * np.abs(apart @ across.T).max(axis=0) + scene.wavelength
    along, first = (ears - middle) @ axis, float((apart @ axis).max())
    # Planes up to here count fully.
    most = max(float(along.max()), float(np.linalg.norm(width))) + BEYOND
    z, step, turn = 0.0, STEP, 0.0
    while z < min(2 * most, END / (2 * max(scene.absorption, 1e-9))):
        at = z + step / 2
        taper = 1.0 if at < most else float(np.cos(np.pi / 2 * (at / most - 1)) ** 2)
        fine = FINE * scene.wavelength * np.sqrt(at**2 + width**2 / 4) / width
        fine = np.minimum(fine, max(CLOSE, float(np.abs(along - first - at).min()) / 2))
        half = np.ceil((0.6 * width + SLANT * at) / fine)
        # The grids of successive planes are shifted, so that their errors do not add.
        sides = [(np.arange(-n, n + 1) + turn) * d for n, d in zip(half, fine, strict=True)]
        grid = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
        yield middle + (first + at) * axis + grid @ across, taper * step * float(np.prod(fine))
        z, step, turn = z + step, min(step * GROWTH, WIDEST), (turn + 0.618) % 1


def distances(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distances (V, K) in m of points (V, 3) from others (K, 3)."""
    found: NDArray[np.float64] = np.linalg.norm(points[:, None] - others, axis=2)
    return found


def audible_lines(
    played: Sequence, ears: NDArray[np.float64], progress: Callable[[int, int], object] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return frequencies (L,) in Hz and peak pressures (K, L) in Pa of the audible lines at ears (K, 3).

    The envelope reaches a point by the mean way from the transducers, weighted by their energy there. The
    sequence repeats, each drive stays for its frame, and the transducers follow it
    with the time constant `TAU`. So in a frame P = a + b e^(-t/tau), and E has three terms of known lines.
    """
    scene = played._scene.replace(signature=None)
    rate, count = played.rate, len(played)
    drives, which = np.unique(played.drives, axis=0, return_inverse=True)
    order = which.ravel().astype(np.uintp)
    air, positions = list(planes(scene, ears)), scene.array.positions
    # The longest way to an ear ends before this bin.
    corners = np.concatenate([points[[0, -1]] for points, _ in air])
    bins = int((distances(corners, positions).max() + 2 * distances(corners, ears).max()) / BIN)
    size, most = 24 * len(ears) * bins * count, memory_limit()
    if size > most:
        places = counted(len(ears), "place")
        raise MemoryError(
            f"the audible sound of {count} frames at {places} needs {size * 1e-9:.3f} GB, the limit is "
            f"{most * 1e-9:.3f} GB: give fewer frames, or a higher limit (MIDAIR_MEMORY in the environment)"
        )
    sums = np.zeros((len(ears), bins, 3, count))
    some, used, done = slice(None, None, max(len(positions) // COUNTED, 1)), 0, 0
    total = sum(len(points) for points, _ in air)
    length = max(WORK // drives.size, 64)
    for points, volume in air:
        for start in range(0, len(points), length):
            if progress is not None and progress(done, total) is False:
                raise KeyboardInterrupt
            part = points[start : start + length]
            gains = rows(scene, part)
            shares = np.square(np.abs(gains[:, some]))
            ways = distances(part, positions[some])
            way = np.sum(shares * ways, axis=1) / np.maximum(shares.sum(axis=1), 1e-30)
            away = distances(ears, part)
            bin_of = ((way + away) / BIN).astype(np.uintp)
            weights = (volume / np.maximum(away, scene.wavelength)).astype(np.float32)
            demodulate(gains @ drives.T, order, np.exp(-1 / (rate * TAU)), weights, bin_of, sums)
            used, done = max(used, int(bin_of.max()) + 1), done + len(part)
    if progress is not None:
        progress(total, total)
    return _summed(sums[:, :used], scene, rate)


def _summed(sums: NDArray[np.float64], scene: Scene, rate: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lines' frequencies (L,) in Hz and pressures (K, L) in Pa, of sums (K, bins, 3, T)."""
    used, _, count = sums.shape[1:]
    lines = np.arange(1, int(RECEIVED[1] * count / rate) + 1)
    frequencies = np.asarray(lines * (rate / count), np.float64)
    w = 2j * np.pi * frequencies
    inside = [(1 - np.exp(-(w + k / TAU) / rate)) / (w + k / TAU) for k in range(3)]
    spectra = [np.fft.fft(sums[:, :, k]) for k in range(3)]
    summed = np.zeros((len(sums), len(lines)), np.complex128)
    far = (np.arange(used) + 0.5) * (BIN / scene.sound_speed)
    length = max(CELLS // used, 1)
    for start in range(0, len(lines), length):
        part = slice(start, start + length)
        delays = np.exp(-np.outer(far, w[part]))
        for k in range(3):
            turned = np.einsum("rl,krl->kl", delays, spectra[k][..., lines[part] % count])
            summed[:, part] += inside[k][part] * turned
    scale = BETA / (4 * np.pi * scene.density * scene.sound_speed**4) * np.abs(w) ** 2
    pressures: NDArray[np.float64] = np.abs(summed) * scale * 2 * rate / count
    return frequencies, pressures


def loudness(frequencies: NDArray[np.float64], pressures: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the A-weighted levels (K,) in dB re 20 uPa of lines (K, L) in Pa, peak, from 20 Hz to 16 kHz."""
    within = (frequencies >= RECEIVED[0]) & (frequencies <= RECEIVED[1])
    weighted = pressures[:, within] * a_weighting(frequencies[within])
    power = np.sum(weighted**2, axis=1) / 2
    with np.errstate(divide="ignore"):
        levels: NDArray[np.float64] = 10 * np.log10(power / 20e-6**2)
    return levels
