"""Envelope of the transducers' radiation while their drives change from frame to frame.

A transducer is a first-order system: its radiation y follows its drive q by y' = (q - y)/tau. The time
constant is tau = sqrt(3)/(pi B), where B is the two-sided bandwidth at -6 dB.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .drives import BLOCK, Drives, blocks

Hold = Literal["hold", "linear"]

#: Number of time constants after which an earlier drive has no effect: e^-40 is below the rounding error.
FORGOTTEN = 40


@dataclass(frozen=True)
class Envelope:
    """Drives played at `rate` frames/s by transducers with time constant `tau` in s (0: they follow at once).

    hold="hold": each drive stays for its whole frame. hold="linear": during a frame, amplitude and phase move
    in equal steps to those of the next frame; the phase takes the shorter way. An open sequence is preceded
    by its first drive for a long time, and followed by its last drive. A closed sequence repeats.
    """

    drives: Drives
    rate: float
    closed: bool
    tau: float
    hold: Hold

    def inside(self, substeps: int) -> Iterator[tuple[slice, slice, NDArray[np.complex64]]]:
        """Yield (frames, sub-steps, y), block by block, with the radiation y (frames, sub-steps, N).

        The time of sub-step k of frame t is (t + k/substeps)/rate.
        """
        times = np.arange(substeps) / (substeps * self.rate)
        decays = self._decays(times)
        before = self._before()
        count = len(self.drives.live)
        for frames in blocks(len(self.drives), substeps * count):
            course = self._course(frames)
            starts, before = self._starts(course, before)
            rest = starts - course.at(0.0)
            # A single frame can have more sub-steps than fit in a block.
            length = max(1, BLOCK // len(starts) // count)
            for first in range(0, substeps, length):
                steps = slice(first, min(first + length, substeps))
                y = np.empty((len(starts), steps.stop - first, count), np.complex64)
                for k in range(first, steps.stop):
                    y[:, k - first] = course.at(times[k]) + rest * decays[k]
                yield frames, steps, y

    def _decays(self, times: NDArray[np.float64]) -> NDArray[np.float32]:
        """Return e^(-t/tau) for each time t: the fraction of an initial deviation that remains."""
        left = np.exp(-times / self.tau) if self.tau > 0 else np.zeros_like(times)
        return left.astype(np.float32)

    def _before(self) -> NDArray[np.complex128]:
        """Return the radiation y (N,) at the start of frame 0."""
        if not self.closed:
            return self.drives[0].astype(np.complex128)
        # y after one lap from y = 0; earlier frames than FORGOTTEN time constants are left out. In the steady
        # state y = (that value) + y e^(-lap/tau), which is solved for y.
        lap = min(len(self.drives), ceil(FORGOTTEN * self.tau * self.rate) + 1)
        y = np.zeros(len(self.drives.live), np.complex128)
        for part in blocks(lap, len(y)):
            first = len(self.drives) - lap
            course = self._course(slice(first + part.start, first + part.stop))
            y = self._starts(course, y)[1]
        kept = np.exp(-lap / (self.rate * self.tau)) if self.tau > 0 else 0.0
        return y / (1 - kept)

    def _starts(
        self, course: _Course, y: NDArray[np.complex128]
    ) -> tuple[NDArray[np.complex64], NDArray[np.complex128]]:
        """Return the radiation y (frames, N) at the start of each frame of a block, and y (N,) after it."""
        begin, end = course.at(0.0), course.at(1 / self.rate)
        kept = np.exp(-1 / (self.rate * self.tau)) if self.tau > 0 else 0.0
        starts = np.empty_like(begin)
        for frame in range(len(begin)):
            starts[frame] = y
            y = end[frame] + (y - begin[frame]) * kept
        return starts, y

    def _course(self, frames: slice) -> _Course:
        now = self.drives[frames]
        if self.hold == "hold":
            return _Course(now)
        following = np.arange(frames.start, frames.stop) + 1
        following[following == len(self.drives)] = 0 if self.closed else len(self.drives) - 1
        return _line(now, self.drives[following], self.rate, self.tau)


@dataclass(frozen=True)
class _Course:
    """The part of the radiation y that follows the drive: (constant + slope t) e^(j speed t) in a frame."""

    constant: NDArray[np.complex64]
    slope: NDArray[np.complex64] | None = None
    speed: NDArray[np.float32] | None = None

    def at(self, time: float) -> NDArray[np.complex64]:
        if self.slope is None or self.speed is None:
            return self.constant
        turned = self.speed * np.float32(time)
        phasor = np.cos(turned) + 1j * np.sin(turned)
        value: NDArray[np.complex64] = (self.constant + self.slope * np.float32(time)) * phasor
        return value


def _line(now: NDArray[np.complex64], following: NDArray[np.complex64], rate: float, tau: float) -> _Course:
    """Return the course of the radiation y for a drive that moves from `now` to `following` in a frame.

    The drive is q = (a + b t) e^(j w t + j phase). In tau y' + y = q, the form y = (c + d t) e^(j w t + j
    phase) gives d = b/(1 + j w tau) and c = (a - tau d)/(1 + j w tau).
    """
    amplitude, next_amplitude = np.abs(now), np.abs(following)
    # A drive of amplitude 0 has no phase; the phase of the other drive is used for it.
    shown = np.where(amplitude > 0, now, following)
    size = np.abs(shown)
    direction = np.divide(shown, size, out=np.zeros_like(shown), where=size > 0)
    speed = np.angle(following * now.conj()) * np.float32(rate)
    lag = 1 + 1j * speed * np.float32(tau)
    slope = (next_amplitude - amplitude) * np.float32(rate) * direction / lag
    constant = (amplitude * direction - np.float32(tau) * slope) / lag
    return _Course(constant, slope, speed)
