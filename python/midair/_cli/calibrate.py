"""`midair calibrate`: an array as it is, from a file of readings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import Scene, SceneError, calibrate
from .._measuring.result import ENDINGS
from .._support import output
from .._support.text import arrays
from .progress import progress_bar
from .scene import check_outputs
from .tables import print_written

#: What a file of readings may hold; the first two it has to.
KEYS = ("drives", "readings", "microphones", "scene", "noise")


def calibrate_command(
    readings: Path,
    *,
    output_file: Annotated[Path, Parameter(name=["--output", "-o"])],
    scene: Path | None = None,
    noise: float | None = None,
    prior: float | None = None,
    image: Path | None = None,
) -> int:
    """Find the responses of an array and the sound speed from readings of known drives.

    Parameters
    ----------
    readings
        An .npz file with drives (K, N), readings (K, M), microphones (M, 3) in m and scene, a file's text.
    output_file
        Where the corrected scene goes, .toml or .json; an .npz holds everything.
    scene
        The scene file, where the readings have none; its points are the microphones where they name none.
    noise
        Least standard deviation of a reading, in Pa.
    prior
        Standard deviation of re and im of the responses; left out, it is learnt.
    image
        Where a picture of responses and residuals goes.
    """
    taken = [readings] if scene is None else [readings, scene]
    check_outputs((output_file, ENDINGS), (image, output.IMAGES), taken=taken)
    found = _read(readings)
    if scene is None and "scene" not in found:
        raise SceneError(
            f'readings file "{readings}" has no scene: give its file by --scene, or save its text'
        )
    believed = (
        Scene.load(scene) if scene is not None else Scene.parse(str(found["scene"]), name=str(readings))
    )
    if noise is None and "noise" in found:
        noise = float(found["noise"])
    with progress_bar("calibrating") as tell:
        result = calibrate(
            believed,
            found["drives"],
            found["readings"],
            microphones=found.get("microphones"),
            noise=noise,
            prior=prior,
            progress=tell,
        )
    result.save(output_file)
    print(result)
    for name in ("dead", "reversed"):
        if len(which := getattr(result, name)):
            print(f"{name}: {', '.join(map(str, which.tolist()))}")
    if image is not None:
        result.plot().savefig(image)
    print_written(f"{output_file}" if image is None else f"{output_file} and {image}")
    return 0


def _read(path: Path) -> dict[str, Any]:
    try:
        found = arrays(path, KEYS)
    except SceneError as error:
        raise SceneError(f'readings file "{path}": {error}') from error
    except ValueError as error:
        raise SceneError(
            f'readings file "{path}" is damaged, or no .npz: give what numpy.savez wrote'
        ) from error
    for key in KEYS[:2]:
        if key not in found:
            raise SceneError(
                f'readings file "{path}" has no {key}: save {", ".join(KEYS[:4])} by numpy.savez'
            )
    return found
