"""What a hand gets: radiation pressure or force at a fixed place, its spectrum and the rms by band."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Bands of the skin's slow and fast channels in Hz: steady motion, and vibration.
BANDS = ((5.0, 50.0), (50.0, 500.0))


@dataclass(frozen=True, eq=False)
class Felt:
    """Force in mN, or radiation pressure in Pa, in time and by frequency.

    times, values : (T,) in s, and in `unit`
    frequencies, spectrum : (T//2 + 1,) in Hz, and the amplitude (peak) of each line, the mean at 0 Hz
    static : mean over time
    bands, rms : (low, high) in Hz, low <= f < high, and the rms of each: sqrt(sum of spectrum^2 / 2)
    unit : "mN" where an area was given, else "Pa"
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
        """The rms of each band, in `unit`."""
        return np.array([rms(self.frequencies, self.spectrum, band) for band in self.bands])

    def __repr__(self) -> str:
        return "\n".join(f"{name:18}  {value}" for name, value in self._rows())

    def _repr_html_(self) -> str:
        rows = (f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in self._rows())
        return f"<table>{''.join(rows)}</table>"

    def _rows(self) -> list[tuple[str, str]]:
        told = [
            (f"rms {low:g} to {high:g} Hz", f"{part:.4g} {self.unit}")
            for (low, high), part in zip(self.bands, self.rms, strict=True)
        ]
        return [("static", f"{self.static:.4g} {self.unit}"), *told]


def spectrum(values: NDArray[np.float64], rate: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Frequencies in Hz, and the amplitude of each line, the mean at 0, of values (T,) at `rate` a second.

    As if they repeated for ever: without a window, so that half the sum of their squares is the power.
    """
    count = len(values)
    lines = np.abs(np.fft.rfft(values)) * (2 / count)
    lines[0] = values.mean()
    if count % 2 == 0 and count > 1:
        # At half the sampling rate a cosine a (-1)^n has the power a^2, and is counted once.
        lines[-1] /= np.sqrt(2)
    return np.fft.rfftfreq(count, 1 / rate), lines


def rms(frequencies: NDArray[np.float64], lines: NDArray[np.float64], band: Sequence[float]) -> float:
    """The rms of a band: that of its lines, sqrt(sum of amplitude^2 / 2)."""
    inside = (frequencies >= band[0]) & (frequencies < band[1])
    return float(np.sqrt(np.sum(lines[inside] ** 2) / 2))
