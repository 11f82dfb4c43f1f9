"""Sources of readings for `midair.doctor`: a sound card, a file, or a simulated array with faults.

A sound card measures 40 kHz if it has a rate of 96,000 samples per second or more and a microphone for
ultrasound. With 48,000 samples per second it measures nothing at 40 kHz. Amplitude modulation does not help:
a linear microphone does not demodulate. For a detector with an envelope output, write a reader function of
your own.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene, stated
from .._support.arguments import refused
from .._support.text import content, fault, text

Read = Callable[[NDArray[np.complex64]], NDArray[Any]]

#: Samples per period that are needed to measure an amplitude; fraction of full scale that counts as clipped.
SAMPLES, FULL = 2.2, 0.99

#: Faults that can be simulated, and how many numbers each takes.
FAULTS = {"dead": 1, "weak": 1, "reversed": 1, "swapped": 2, "delay": 2, "level": 1, "speed": 1, "noise": 1}


@contextmanager
def sound_card(
    channels: int, device: int | None, rate: float, pascals: float, frequency: float, listen: float
) -> Iterator[Read]:
    """Return a reader of |p| (M,) from M channels of a sound card; `pascals` is the peak at full scale."""
    if rate < SAMPLES * frequency:
        cure = f"a card that hears {frequency / 1e3:g} kHz takes 96000 or 192000 samples a second"
        raise refused("rate", rate, cure)
    try:
        import sounddevice
    except (ImportError, OSError) as error:
        cure = 'pip install "midair[sound]", and PortAudio where the system lacks it'
        raise stated("a sound card", "needs sounddevice", cure, code="missing") from error
    count = round(listen * rate)
    window = np.hanning(count)[:, None]
    tone = window * np.exp(-2j * np.pi * frequency / rate * np.arange(count))[:, None]
    try:
        stream = sounddevice.InputStream(samplerate=rate, device=device, channels=channels)
    except (sounddevice.PortAudioError, ValueError) as error:
        cure = "`python -m sounddevice` lists the devices"
        raise stated("the sound card", f"cannot be opened ({' '.join(str(error).split())})", cure) from error

    def read(drive: NDArray[np.complex64]) -> NDArray[Any]:
        # Discard sound that was recorded before the drive played.
        stream.read(stream.read_available)
        received, _ = stream.read(count)
        if np.abs(received).max() > FULL:
            raise stated("", "the sound card clips", "turn its gain down, or move the microphone away")
        return np.asarray(pascals * 2 * np.abs(np.sum(received * tone, axis=0)) / window.sum())

    with stream:
        yield read


def from_file(path: Path, microphones: int) -> Read:
    """Return a reader of a .csv file: one row per drive, one column per microphone, p or |p| in Pa.

    Complex numbers are written as 1.5-2j.
    """
    lines = text(path, content(path)).splitlines()
    rows = [(k, line.split(",")) for k, line in enumerate(lines, 1) if line.strip()]
    found = []
    for k, row in rows:
        if len(row) != microphones:
            raise fault(
                path, k, f"it has {len(row)} numbers", f"give one for each of {microphones} microphones"
            )
        try:
            found.append([complex(cell.strip().replace("i", "j")) for cell in row])
        except ValueError:
            raise fault(path, k, "give numbers, as 1.5 or 1.5-2j") from None
    readings = np.array(found).reshape(-1, microphones)
    readings = readings if readings.imag.any() else readings.real
    left = iter(readings)

    def read(drive: NDArray[np.complex64]) -> NDArray[Any]:
        row = next(left, None)
        if row is None:
            raise fault(
                path, None, f"{len(readings)} rows are too few", "give one for each drive of the plan"
            )
        return np.asarray(row)

    return read


def simulated(
    array: Array, microphones: NDArray[np.float64], boards: int, faults: str, seed: int = 0
) -> Read:
    """Return a reader that simulates |p| (M,) with faults, such as "dead 17, swapped 3 9, noise 0.01".

    Weak transducers have half the gain. "delay B D" delays board B by D degrees, "level L" multiplies all
    readings, "speed C" sets the sound speed in m/s. "noise X" is the readings' standard deviation relative to
    their rms.
    """
    response, order, speed, noise = np.ones(len(array), complex), np.arange(len(array)), None, 0.01
    board = np.arange(len(array)) * boards // len(array)
    for each in filter(None, map(str.strip, faults.split(","))):
        kind, *given = each.split()
        try:
            numbers = [float(number) for number in given]
            if len(numbers) != FAULTS[kind]:
                raise ValueError
            which = [int(number) for number in numbers]
            if kind in ("dead", "weak", "reversed"):
                response[which[0]] *= {"dead": 0.0, "weak": 0.5, "reversed": -1.0}[kind]
            elif kind == "swapped":
                order[which] = order[which[::-1]]
            elif kind == "delay":
                response[board == which[0]] *= np.exp(1j * np.radians(numbers[1]))
            elif kind == "level":
                response *= numbers[0]
            elif kind == "speed":
                speed = numbers[0]
            else:
                noise = numbers[0]
        except (KeyError, ValueError, IndexError):
            known = ", ".join(f"{name}{' N' * count}" for name, count in FAULTS.items())
            raise refused("simulate", each, f"give some of {known}, with commas between") from None
    scene = Scene(array, microphones) if speed is None else Scene(array, microphones, sound_speed=speed)
    matrix = scene.propagation()[:, order] * response
    usual = np.sqrt(np.mean(np.sum(np.abs(matrix) ** 2, axis=1)))
    rng = np.random.default_rng(seed)
    return lambda drive: np.abs(np.abs(matrix @ drive) + noise * usual * rng.normal(size=len(matrix)))
