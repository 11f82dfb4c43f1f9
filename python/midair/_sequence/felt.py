"""Radiation pressure or force at a place over time, its spectrum and rms, and tactile thresholds."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, log10, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _midair
from .._midair import memory_limit, numbers, stated
from .._support.arguments import number, refused
from .._support.ctrl_c import interruptibly
from .._support.text import Facts
from .drives import Envelope

#: Samples per second of the envelope. Frequencies above half of it alias, at least 30 dB weaker.
SAMPLES = 160e3

#: Bytes of memory per sample: six copies in double precision.
EACH = 48

#: Range of audible frequencies, in Hz.
RECEIVED = (20.0, 16e3)

#: Frequency in Hz of the amplitude modulation that defines 0 dB.
REFERENCE = 200.0

#: Level in dB that is reported for silence. Weaker levels are below the precision of float32 drives.
SILENCE = -200.0


def noise(envelope: Envelope) -> float:
    """Return the A-weighted rms, 20 Hz to 16 kHz, of d^2/dt^2 of E(t) = mean_i |y_i|^2, in dB.

    y_i is the radiation of transducer i. 0 dB is full amplitude modulation (1 + cos)/2 at 200 Hz of the same
    transducers.
    """
    return max(20 * log10(max(_loudness(envelope), 1e-30) / _reference(envelope.tau)), SILENCE)


def _loudness(envelope: Envelope) -> float:
    substeps = ceil(SAMPLES / envelope.rate)
    if (needed := EACH * len(envelope.drives) * substeps) > memory_limit():
        memory = f"{needed >> 20} MB of {memory_limit() >> 20} allowed"
        raise stated("noise", f"needs {memory}", "take a shorter part of the sequence", code="memory")
    energy = np.empty((len(envelope.drives), substeps))
    live = max(int(envelope.drives.live.sum()), 1)
    for frames, steps, y in envelope.inside(substeps):
        energy[frames, steps] = np.square(y.view(np.float32)).sum(axis=-1, dtype=np.float64) / live
    return interruptibly(_weighted, energy.ravel(), substeps * envelope.rate, envelope.closed)


def _weighted(flat: NDArray[np.float64], rate: float, closed: bool) -> float:
    """Return the A-weighted rms of the second derivative of values, `rate` of them a second."""
    if closed:
        bent = np.roll(flat, -1) - 2 * flat + np.roll(flat, 1)
        window = np.ones(len(bent))
    else:
        bent = np.diff(flat, 2)
        # An open sequence begins and ends abruptly, which would add a click; the window removes it.
        window = np.hanning(len(bent) + 2)[1:-1]
    if not len(bent):
        return 0.0
    lines = np.abs(np.fft.rfft(bent * window)) ** 2
    frequencies = np.fft.rfftfreq(len(bent), 1 / rate)
    received = (frequencies >= RECEIVED[0]) & (frequencies <= RECEIVED[1])
    power = 2 * np.sum(lines[received] * a_weighting(frequencies[received]) ** 2)
    return float(rate**2 * sqrt(power / (len(bent) * np.sum(window**2))))


def _reference(tau: float) -> float:
    """Return the rms for |y| = (1 + g cos wt)/2 at w = 2 pi 200 Hz, where g = 1/sqrt(1 + (w tau)^2).

    E = |y|^2 has the amplitudes g/2 at w and g^2/8 at 2w.
    """
    w = 2 * pi * REFERENCE
    g = 1 / sqrt(1 + (w * tau) ** 2)
    weights = a_weighting(np.array([REFERENCE, 2 * REFERENCE]))
    lines = np.array([w**2 * g / 2, (2 * w) ** 2 * g**2 / 8])
    return float(np.linalg.norm(weights * lines) / sqrt(2))


def a_weighting(frequency: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the factor of A-weighting, 1 at 1 kHz (IEC 61672-1), for frequencies in Hz."""
    f = np.square(frequency)
    low = (f + 20.598997**2) * np.sqrt((f + 107.65265**2) * (f + 737.86223**2))
    value: NDArray[np.float64] = 10 ** (2.0 / 20) * 12194.217**2 * f**2 / (low * (f + 12194.217**2))
    return value


#: Frequency bands in Hz: slow motion and vibration.
BANDS: tuple[tuple[float, float], ...] = ((5.0, 50.0), (50.0, 500.0))


def threshold(frequency: ArrayLike) -> NDArray[np.float64]:
    """Return the smallest vibration that the palm perceives at frequencies in Hz, as peak displacement in m.

    The result is the threshold of the more sensitive channel, and inf outside of 1 to 500 Hz.
    """
    frequencies = np.atleast_1d(numbers("frequency", frequency, None, "give frequencies in Hz"))
    return np.minimum(*(_midair.threshold(fast, frequencies) for fast in (False, True)))


@dataclass(frozen=True, eq=False, repr=False)
class Felt(Facts):
    """Force in mN, or radiation pressure in Pa, in time and by frequency; from `Sequence.felt`.

    Attributes
    ----------
    times, values : (T,) ndarray
        Times in s, and values in `unit`.
    frequencies, spectrum : (T//2 + 1,) ndarray
        Frequency in Hz and amplitude (peak) of each spectral line; the mean is at 0 Hz.
    bands : tuple of (float, float)
        (low, high) in Hz, low <= f < high.
    unit : str
        "mN" where an area was given, else "Pa".

    Examples
    --------
    >>> import midair
    >>> scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    >>> felt = midair.solve(scene).modulated(200).felt([0, 0, 0.15])
    >>> float(felt.frequencies[felt.spectrum[1:].argmax() + 1])
    200.0
    """

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    frequencies: NDArray[np.float64]
    spectrum: NDArray[np.float64]
    bands: tuple[tuple[float, float], ...]
    unit: str

    @property
    def static(self) -> float:
        """Mean over time, in `unit`."""
        return float(self.spectrum[0])

    @property
    def rms(self) -> NDArray[np.float64]:
        """Rms of each band, in `unit`: sqrt(sum of spectrum^2 / 2); 0 for a band without lines."""
        return np.array([rms(self.frequencies, self.spectrum, band) for band in self.bands])

    @property
    def thresholds(self) -> NDArray[np.float64]:
        """Smallest peak displacement of the palm that is felt at each frequency, in m; inf beyond 500 Hz.

        The levels are not verified (docs/touch.md). `midair.skin` compares displacements with them.
        """
        return threshold(self.frequencies)

    def _rows(self) -> list[tuple[str, str]]:
        reported = [
            (f"rms {low:g} to {high:g} Hz", f"{part:.4g} {self.unit}")
            for (low, high), part in zip(self.bands, self.rms, strict=True)
        ]
        return [("static", f"{self.static:.4g} {self.unit}"), *reported]


def spectrum(values: NDArray[np.float64], rate: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return frequencies in Hz and the amplitude of each spectral line of values (T,); line 0 is the mean.

    `rate` is the number of values per second. The values count as one period of a repeating signal. No window
    is applied, so half the sum of the squares of the lines above 0 Hz is the power.
    """
    count = len(values)
    lines = np.abs(np.fft.rfft(values)) * (2 / count)
    lines[0] = values.mean()
    if count % 2 == 0 and count > 1:
        # At half the sampling rate, a cosine a (-1)^n has the power a^2, not a^2/2, and appears once in the
        # sum.
        lines[-1] /= np.sqrt(2)
    return np.fft.rfftfreq(count, 1 / rate), lines


def rms(frequencies: NDArray[np.float64], lines: NDArray[np.float64], band: Sequence[float]) -> float:
    """Return the rms of the lines in a band (low, high): sqrt(sum of amplitude^2 / 2)."""
    inside = (frequencies >= band[0]) & (frequencies < band[1])
    return float(np.sqrt(np.sum(lines[inside] ** 2) / 2))


def places_of(given: Any) -> NDArray[np.float64]:
    """Return one place (3,) or the places (K, 3) of a patch, in m, as (K, 3)."""
    return numbers("place", given, [(3,), (-1, 3)], "give (3,) in m, or (K, 3) for a patch").reshape(-1, 3)


def bands_of(given: Any) -> tuple[tuple[float, float], ...]:
    """Return frequency bands as pairs (low, high) in Hz."""
    try:
        found = [(band[0], band[1]) for band in given if len(band) == 2]
        whole = len(found) == len(given)
    except TypeError:
        found, whole = [], False
    if not whole:
        raise refused("bands", given, "give pairs (low, high) in Hz")
    read = []
    for k, (low, high) in enumerate(found):
        low, high = number(f"bands[{k}][0]", low, above=0), number(f"bands[{k}][1]", high, above=0)
        if not low < high:
            raise refused(f"bands[{k}]", (low, high), "give low < high, in Hz")
        read.append((low, high))
    return tuple(read)
