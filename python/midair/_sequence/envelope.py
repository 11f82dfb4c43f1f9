"""Envelope of the transducers' radiation while their drives change from frame to frame.

A transducer is a first-order system: its radiation y follows its drive q by y' = (q - y)/tau. The time
constant is tau = sqrt(3)/(pi B), where B is the two-sided bandwidth at -6 dB.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .._midair import Response
from .drives import BLOCK, Drives, blocks

Hold = Literal["hold", "linear"]


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

    @property
    def response(self) -> Response:
        """The transducers' response, as the core computes it."""
        return Response(self.rate, self.tau, self.hold == "linear")

    def inside(self, substeps: int) -> Iterator[tuple[slice, slice, NDArray[np.complex64]]]:
        """Yield (frames, sub-steps, y), block by block, with the radiation y (frames, sub-steps, N).

        The time of sub-step k of frame t is (t + k/substeps)/rate.
        """
        response, start = self.response, self.before()
        count = len(self.drives.live)
        for frames, now, following in self.played(substeps):
            # A single frame can have more sub-steps than fit in a block.
            length = max(1, BLOCK // len(now) // count)
            after = start
            for first in range(0, substeps, length):
                steps = slice(first, min(first + length, substeps))
                y, after = response.inside(now, following, start, substeps, steps.start, steps.stop)
                yield frames, steps, y
            start = after

    def played(self, substeps: int) -> Iterator[tuple[slice, NDArray[np.complex64], NDArray[np.complex64]]]:
        """Yield blocks: frames, their drives (frames, N), the following frames' drives (frames, N)."""
        last = 0 if self.closed else len(self.drives) - 1
        for frames in blocks(len(self.drives), substeps * len(self.drives.live)):
            following = np.arange(frames.start, frames.stop) + 1
            following[following == len(self.drives)] = last
            yield frames, self.drives[frames], self.drives[following]

    def before(self) -> NDArray[np.complex128]:
        """Return the radiation y (N,) at the start of frame 0."""
        first = self.drives[0]
        if not self.closed:
            return first.astype(np.complex128)
        kept = self.response.memory(len(self.drives))
        return self.response.repeated(self.drives[len(self.drives) - kept : len(self.drives)], first)
