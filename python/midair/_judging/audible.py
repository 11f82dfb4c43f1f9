"""Audible sound that the air makes of ultrasound that changes in time, at ears, by Westervelt's equation.

With the complex amplitude P of the ultrasound, E = |P|^2/2 is the slow part of the squared pressure. Its
sound at an ear is an integral over the air in front of the array (Westervelt 1963, J. Acoust. Soc. Am. 35,
535; as in Zhong's AWPAL, github.com/JiaxinZhong/AWPAL):

    p(t) = beta/(4 pi rho c^4) integral of d^2 E(t - R/c)/dt^2 / R dV,    R: distance to the ear.

Far from a narrow beam of amplitude P0 f(t) and area S this is Berktay's formula (1965, J. Sound Vib. 2, 435),
beta P0^2 S/(16 pi rho c^4 r alpha) d^2 f^2/dt^2.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._midair import Scene, memory_limit
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

#: Largest number of entries of G, and of frames times points, in a block.
BLOCK = 1 << 23


class Beam(NamedTuple):
    """Planes in front of an array that hold its ultrasound.

    Attributes
    ----------
    middle, axis, across
        Middle of the transducers (3,) in m, mean of their normals (3,), and two directions (2, 3) across it.
    width
        (2,): width of the array in m along these directions.
    first, most, end
        Distances in m of the planes along the axis: of the first, of those that count fully, of the last.
    ears
        (K,): distances of the ears in m along the axis.
    """

    middle: NDArray[np.float64]
    axis: NDArray[np.float64]
    across: NDArray[np.float64]
    width: NDArray[np.float64]
    first: float
    most: float
    end: float
    ears: NDArray[np.float64]

    @classmethod
    def of(cls, scene: Scene, ears: NDArray[np.float64]) -> "Beam":
        axis, middle = scene.array.normals.mean(axis=0), scene.array.positions.mean(axis=0)
        if np.linalg.norm(axis) < 0.5:
            raise refused("array", "transducers that face each other", "give an array that radiates to one side")
        axis /= np.linalg.norm(axis)
        across = np.linalg.svd(axis[None])[2][1:]
        apart = scene.array.positions - middle
        width = 2 * np.abs(apart @ across.T).max(axis=0) + scene.wavelength
        along, first = (ears - middle) @ axis, float((apart @ axis).max())
        most = max(float(along.max()), float(np.linalg.norm(width))) + BEYOND
        end = min(2 * most, END / (2 * max(scene.absorption, 1e-9)))
        return cls(middle, axis, across, width, first, most, end, along - first)

    def planes(self, wavelength: float) -> Iterator[tuple[NDArray[np.float64], float]]:
        """Yield the points (V, 3) of each plane, and the volume in m^3 of each point.

        |P|^2 has no spatial frequency above k D/sqrt(z^2 + D^2/4), where D is the width of the array. A
        regular grid that is finer than the shortest period integrates exactly, near to an ear a finer one.
        """
        z, step, turn = 0.0, STEP, 0.0
        while z < self.end:
            at = z + step / 2
            taper = 1.0 if at < self.most else float(np.cos(np.pi / 2 * (at / self.most - 1)) ** 2)
            fine = FINE * wavelength * np.sqrt(at**2 + self.width**2 / 4) / self.width
            fine = np.minimum(fine, max(CLOSE, float(np.abs(self.ears - at).min()) / 2))
            half = np.ceil((0.6 * self.width + SLANT * at) / fine)
            # The grids of successive planes are shifted, so that their errors do not add.
            sides = [(np.arange(-n, n + 1) + turn) * d for n, d in zip(half, fine, strict=True)]
            grid = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
            points = self.middle + (self.first + at) * self.axis + grid @ self.across
            yield points, taper * step * float(np.prod(fine))
            z, step, turn = z + step, min(step * GROWTH, WIDEST), (turn + 0.618) % 1


def distances(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distances (V, K) in m of points (V, 3) from others (K, 3)."""
    squares = np.sum(points**2, axis=1)[:, None] + np.sum(others**2, axis=1) - 2 * points @ others.T
    found: NDArray[np.float64] = np.sqrt(np.maximum(squares, 0))
    return found


def audible_lines(played: Sequence, ears: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return frequencies (L,) in Hz and peak pressures (K, L) in Pa of the audible lines at ears (K, 3).

    The envelope reaches a point by the mean way from the transducers, weighted by their energy there. The
    sequence repeats, each drive stays for its frame, and the transducers follow it
    with the time constant `TAU`. So in a frame P = a + b e^(-t/tau), and E has three terms of known lines.
    """
    scene = played._scene.replace(signature=None)
    rate, count = played.rate, len(played)
    drives, which = np.unique(played.drives, axis=0, return_inverse=True)
    which = which.ravel()
    e = np.exp(-1 / (rate * TAU))
    turns = np.exp(-2j * np.pi * np.arange(count) / count)
    late = (1 - e) * turns / (1 - e * turns)
    beam = Beam.of(scene, ears)
    farthest = np.linalg.norm(ears - beam.middle, axis=1).max() + 4 * (beam.width.sum() + (1 + SLANT) * beam.end)
    bins = int(farthest / BIN)
    size, most = 24 * len(ears) * bins * count, memory_limit()
    if size > most:
        places = counted(len(ears), "place")
        raise MemoryError(
            f"the audible sound of {count} frames at {places} needs {size * 1e-9:.3f} GB, the limit is "
            f"{most * 1e-9:.3f} GB: give fewer frames, or a higher limit (MIDAIR_MEMORY in the environment)"
        )
    sums = np.zeros((len(ears), 3, bins, count))
    some, used = slice(None, None, max(len(scene.array) // COUNTED, 1)), 0
    for points, volume in beam.planes(scene.wavelength):
        length = max(1, BLOCK // max(len(scene.array), count))
        for start in range(0, len(points), length):
            part = points[start : start + length]
            gains = rows(scene, part)
            a = (gains @ drives.T)[:, which]
            shares = np.square(np.abs(gains[:, some]))
            ways = distances(part, scene.array.positions[some])
            way = np.sum(shares * ways, axis=1) / np.maximum(shares.sum(axis=1), 1e-30)
            b = np.fft.ifft(np.fft.fft(a, axis=1) * late, axis=1).astype(np.complex64) - a
            terms = np.abs(a) ** 2 / 2, (a * b.conj()).real, np.abs(b) ** 2 / 2
            for sound, ear in zip(sums, ears, strict=True):
                away = distances(part, ear[None])[:, 0]
                bin_of = ((way + away) / BIN).astype(np.int64)
                order = np.argsort(bin_of, kind="stable")
                found, begins = np.unique(bin_of[order], return_index=True)
                used = max(used, int(found[-1]) + 1)
                weights = (volume / np.maximum(away, scene.wavelength)).astype(np.float32)[order, None]
                for total, term in zip(sound, terms, strict=True):
                    total[found] += np.add.reduceat(term[order] * weights, begins, axis=0)
    lines = np.arange(1, int(RECEIVED[1] * count / rate) + 1)
    frequencies = np.asarray(lines * (rate / count), np.float64)
    w = 2j * np.pi * frequencies
    far = (np.arange(used) + 0.5) * BIN
    summed = np.zeros((len(ears), len(lines)), np.complex128)
    for k in range(3):
        decay = w + k / TAU
        inside = (1 - np.exp(-decay / rate)) / decay
        delays = np.exp(-np.outer(far, w) / scene.sound_speed)
        for sound, line in zip(sums, summed, strict=True):
            spectra = np.fft.fft(sound[k, :used], axis=1)[:, lines % count]
            line += inside * np.sum(delays * spectra, axis=0)
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
