"""Noise: a proxy for what is heard of drives that change, to compare sequences of one array.

Sound demodulated in air follows Berktay's far field, p ~ d^2/dt^2 of the squared envelope (Berktay,
J. Sound Vib. 2(4), 435-461, 1965). Directions, the near field and the transducers' own sound are left out: it
is no level at an ear.
"""

from __future__ import annotations

from math import ceil, log10, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from .envelope import Envelope

#: Samples/s of the envelope; what lies above half of it folds back at least 30 dB down.
SAMPLES = 160e3

#: What is heard, in Hz.
HEARD = (20.0, 16e3)

#: The amplitude modulation that is 0 dB, in Hz.
REFERENCE = 200.0

#: Silence, in dB: f32 drives do not tell less from nothing.
SILENCE = -200.0


def noise(envelope: Envelope) -> float:
    """A-weighted rms, 20 Hz to 16 kHz, of d^2/dt^2 of E(t) = mean_i |y_i|^2, in dB.

    0 dB is full amplitude modulation (1 + cos)/2 at 200 Hz by the same transducers.
    """
    return max(20 * log10(max(_loudness(envelope), 1e-30) / _reference(envelope.tau)), SILENCE)


def _loudness(envelope: Envelope) -> float:
    substeps = ceil(SAMPLES / envelope.rate)
    energy = np.empty((len(envelope.drives), substeps))
    live = max(int(envelope.drives.live.sum()), 1)
    for frames, steps, y in envelope.inside(substeps):
        energy[frames, steps] = np.square(y.view(np.float32)).sum(axis=-1, dtype=np.float64) / live
    rate = substeps * envelope.rate
    flat = energy.ravel()
    if envelope.closed:
        bent = np.roll(flat, -1) - 2 * flat + np.roll(flat, 1)
        window = np.ones(len(bent))
    else:
        bent = np.diff(flat, 2)
        # A cut in the middle of something would click.
        window = np.hanning(len(bent) + 2)[1:-1]
    if not len(bent):
        return 0.0
    lines = np.abs(np.fft.rfft(bent * window)) ** 2
    frequencies = np.fft.rfftfreq(len(bent), 1 / rate)
    heard = (frequencies >= HEARD[0]) & (frequencies <= HEARD[1])
    power = 2 * np.sum(lines[heard] * a_weighting(frequencies[heard]) ** 2)
    return float(rate**2 * sqrt(power / (len(bent) * np.sum(window**2))))


def _reference(tau: float) -> float:
    """The same of |y| = (1 + g cos wt)/2, where g = 1/sqrt(1 + (w tau)^2) is left by the transducers.

    E = |y|^2 has the amplitudes g/2 at w and g^2/8 at 2w.
    """
    w = 2 * pi * REFERENCE
    g = 1 / sqrt(1 + (w * tau) ** 2)
    weights = a_weighting(np.array([REFERENCE, 2 * REFERENCE]))
    lines = np.array([w**2 * g / 2, (2 * w) ** 2 * g**2 / 8])
    return float(np.linalg.norm(weights * lines) / sqrt(2))


def a_weighting(frequency: NDArray[np.floating]) -> NDArray[np.float64]:
    """A-weighting as a factor, 1 at 1 kHz (IEC 61672-1); frequency in Hz."""
    f = np.square(frequency)
    low = (f + 20.598997**2) * np.sqrt((f + 107.65265**2) * (f + 737.86223**2))
    value: NDArray[np.float64] = 10 ** (2.0 / 20) * 12194.217**2 * f**2 / (low * (f + 12194.217**2))
    return value
