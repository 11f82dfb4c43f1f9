"""`midair calibrate` (from a file of readings) and `midair doctor` (with a microphone)."""

import io
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from .. import Board, Connection, Scene, SceneError, calibrate, connect, doctor
from .._boards.address import DEFAULT, parse
from .._measuring import microphone as microphones
from .._measuring.calibrate import places_of
from .._measuring.doctor import LISTEN, plan as planned
from .._measuring.player import REPORTS
from .._measuring.result import ENDINGS
from .._midair import restated, stated
from .._support import output
from .._support.arguments import refused
from .._support.text import arrays
from .keywords import OutputFile, of
from .progress import progress_bar
from .scene import check_outputs
from .tables import print_line, print_written, write_image

#: Arrays in a file of readings; the first two are required.
KEYS = ("drives", "readings", "microphones", "scene", "noise")


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
        raise stated(
            f'readings file "{readings}"', "has no scene", "give its file by --scene, or save its text"
        )
    believed = (
        Scene.load(scene) if scene is not None else Scene.parse(str(found["scene"]), name=str(readings))
    )
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
    board = Board(place.board or DEFAULT)
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
            read = microphones.from_file(readings, len(at))
        else:
            if simulate is not None:
                read = microphones.simulated(board.array, at, board.boards, simulate)
            else:
                frequency, listen = Scene(board.array, at).frequency, LISTEN
                card = microphones.sound_card(len(at), device, rate, pascals or 1.0, frequency, listen)
                read = kept.enter_context(card)
            played = kept.enter_context(connect(address, board=board))
        with progress_bar("listening") as tell:
            report = doctor(
                played,
                read,
                microphones=at,
                in_pascals=judged,
                progress=tell,
                **keywords,
            )
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
            raise stated(
                f'readings file "{path}"', f"has no {key}", f"save {', '.join(KEYS[:4])} by numpy.savez"
            )
    return found
