"""`midair calibrate` (from a file of readings) and `midair doctor` (with a microphone).

Readings of the doctor come from a sound card, a file, or a simulated array with faults. A sound card measures
40 kHz if it has a rate of 96,000 samples per second or more and a microphone for ultrasound. With 48,000
samples per second it measures nothing at 40 kHz. Amplitude modulation does not help: a linear microphone does
not demodulate. For a detector with an envelope output, write a reader function of your own.
"""

import io
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter
from numpy.typing import NDArray

from .. import Array, Board, Connection, Scene, SceneError, calibrate, connect, doctor
from .._boards.address import board_at, parse
from .._measuring.calibrate import places_of
from .._measuring.doctor import LISTEN, REPORTS, plan as planned
from .._measuring.result import ENDINGS
from .._midair import restated, stated
from .._support import output
from .._support.arguments import refused
from .._support.text import arrays, content, fault, text
from .given import OutputFile, check_outputs, of
from .progress import progress_bar
from .tables import print_line, print_written, write_image

#: Arrays in a file of readings; the first two are required.
KEYS = ("drives", "readings", "microphones", "scene", "noise")


Read = Callable[[NDArray[np.complex64]], NDArray[Any]]

#: Samples per period that are needed to measure an amplitude; fraction of full scale that counts as clipped.
SAMPLES, FULL = 2.2, 0.99

#: Faults that can be simulated, and how many numbers each takes.
FAULTS = {"dead": 1, "weak": 1, "reversed": 1, "swapped": 2, "delay": 2, "level": 1, "speed": 1, "noise": 1}


@of(calibrate, "noise prior")
def calibrate_command(
    readings: Path,
    *,
    output_file: Annotated[Path, Parameter(name=["--output", "-o"])],
    scene: Path | None = None,
    image: Path | None = None,
    **keywords: Any,
) -> int:
    """Find the responses of an array and the sound speed from readings of known drives.

    Parameters
    ----------
    readings
        An .npz file with drives (K, N), readings (K, M), microphones (M, 3) in m, and scene (text of a file).
    output_file
        Where to write the corrected scene, .toml or .json; an .npz contains everything.
    scene
        The scene file, if the readings have none; its points are the microphones if they name none.
    image
        Where to write a picture of responses and residuals.
    """
    taken = [readings] if scene is None else [readings, scene]
    check_outputs((output_file, ENDINGS), (image, output.IMAGES), taken=taken)
    found = _read(readings)
    if scene is None and "scene" not in found:
        cure = "give its file by --scene, or save its text"
        raise stated(f'readings file "{readings}"', "has no scene", cure)
    kept = str(found.get("scene"))
    believed = Scene.parse(kept, name=str(readings)) if scene is None else Scene.load(scene)
    if keywords["noise"] is None and "noise" in found:
        keywords["noise"] = float(found["noise"])
    with progress_bar("calibrating") as tell:
        result = calibrate(
            believed,
            found["drives"],
            found["readings"],
            microphones=found.get("microphones"),
            progress=tell,
            **keywords,
        )
    result.save(output_file)
    print_line(str(result))
    for name in ("dead", "reversed"):
        if len(which := getattr(result, name)):
            print_line(f"{name}: {', '.join(map(str, which.tolist()))}")
    print_line(result.sentence)
    if image is not None:
        write_image(image, result.plot())
    print_written(f"{output_file}" if image is None else f"{output_file} and {image}")
    return 0


@of(doctor, "seconds temperature")
def doctor_command(
    address: str,
    *,
    microphone: Annotated[list[str], Parameter(allow_leading_hyphen=True, negative=())],
    output_file: OutputFile = None,
    device: int | None = None,
    rate: float = 192e3,
    pascals: float | None = None,
    readings: Path | None = None,
    plan: Path | None = None,
    simulate: str | None = None,
    **keywords: Any,
) -> int:
    """Find the faults of a board with a microphone: transducers, order, delays, level, sound speed.

    Parameters
    ----------
    address
        The board and its place: sonicsurface:/dev/ttyUSB0, sonicsurface:loop (docs/boards.md).
    microphone
        Place of a microphone, x,y,z in m; again for each channel of the sound card. Two or more are better.
    output_file
        Where to write the report, .txt or .json: send it to the maintainers.
    device
        Number of the sound card; by default the system's. `python -m sounddevice` lists them.
    rate
        Samples per second of the sound card, 96000 or more.
    pascals
        Peak pressure in Pa at the card's full scale; without it the level is not judged.
    readings
        A .csv instead of a sound card: one row per drive of the plan, one column per microphone.
    plan
        Write the drives to play as .npz, and do nothing else.
    simulate
        Faults of a simulated microphone, such as "dead 17, swapped 3 9, delay 1 90, speed 350".
    """
    place = parse(address)
    board = board_at(place)
    at = places_of([_place(each) for each in microphone])
    check_outputs((output_file, REPORTS), (plan, (".npz",)), taken=[] if readings is None else [readings])
    if plan is not None:
        buffer = io.BytesIO()
        np.savez(buffer, drives=planned(board, len(at), seconds=keywords["seconds"]), microphones=at)
        output.write(plan, buffer.getvalue())
        print_written(plan)
        return 0
    judged = pascals is not None or readings is not None or simulate is not None
    played: Board | Connection = board
    with ExitStack() as kept:
        if readings is not None:
            read = from_file(readings, len(at))
        else:
            if simulate is not None:
                read = simulated(board.array, at, board.boards, simulate)
            else:
                frequency, listen = Scene(board.array, at).frequency, LISTEN
                card = sound_card(len(at), device, rate, pascals or 1.0, frequency, listen)
                read = kept.enter_context(card)
            played = kept.enter_context(connect(address, board=board))
        with progress_bar("listening") as tell:
            report = doctor(played, read, microphones=at, in_pascals=judged, progress=tell, **keywords)
    print_line(report.table)
    if output_file is not None:
        report.write(output_file)
        print_written(output_file)
    return 0


def _place(words: str) -> list[float]:
    try:
        x, y, z = map(float, words.split(","))
    except ValueError:
        raise refused("--microphone", words, "give x,y,z in m, as 0.03,0.02,0.15") from None
    return [x, y, z]


def _read(path: Path) -> dict[str, Any]:
    try:
        found = arrays(path, KEYS)
    except SceneError as error:
        raise restated(error, inside=f'readings file "{path}"') from error
    except ValueError as error:
        cure = "give what numpy.savez wrote"
        raise stated(f'readings file "{path}"', "is damaged, or no .npz", cure, code="unreadable") from error
    for key in KEYS[:2]:
        if key not in found:
            cure = f"save {', '.join(KEYS[:4])} by numpy.savez"
            raise stated(f'readings file "{path}"', f"has no {key}", cure)
    return found


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
            cure = f"give one for each of {microphones} microphones"
            raise fault(path, k, f"it has {len(row)} numbers", cure)
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
            cure = "give one for each drive of the plan"
            raise fault(path, None, f"{len(readings)} rows are too few", cure)
        return np.asarray(row)

    return read


def simulated(array: Array, microphones: NDArray[np.float64], boards: int, faults: str, seed: int = 0) -> Read:
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
