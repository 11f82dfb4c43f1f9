"""Files of Ultraino (asiermarzo/Ultraino): arrays, `.xml.gz` or `.xml`; drives, a pair of `.csv`.

An array (arrays/) is a Java object of class Simulation, written by XMLEncoder. Its y axis points up: a flat
array lies in y = 0 and faces +y. In midair it lies in z = 0 and faces +z, so (x, y, z) becomes (x, -z, y),
also for normals. A transducer has the width `apperture`, the directivity sin(x)/x (CalcField.java) and
`power`, its pressure times distance at full drive in Pa m, at `frequency`. `driverPinNumber` is its channel
on the driver board. Its drive is `amplitude` (or `pAmplitude`) and `phase`, in rad over pi. Phase corrections
belong to the board and are not read, with a warning.

A pair of .csv (ImportAnimationForm.java) has phases in rad in one file and amplitudes from 0 to 1 in the
other. There is no header. A row is a frame, a column a transducer, in the order of their numbers. Ultraino
finds the file of amplitudes by replacing 0_Phase with 0_Amp in the name of the file of phases.
"""

from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._boards.board import Layout
from .._midair import stated
from .._sequence.files import whole
from .._support.arguments import warn
from .._support.text import counted, fault, rows, text
from .played import Played, frames_of, one_or_more
from .xml import Bean, Decoder, Element

#: Ultraino's defaults (Transducer.java): power in Pa m and width in m.
POWER = 2.53
WIDTH = 0.009

#: Parts of the two file names of a pair.
PHASE, AMPLITUDE = "Phase", "Amp"
NAMED = f"0_{PHASE}"


def _transducers(path: str | PathLike[str], root: Element) -> list[Bean]:
    """Return the transducers of a Simulation, in the order of their numbers."""
    beans = Decoder(path, root).beans
    found = _listed(beans) or [bean for bean in beans if bean.kind.endswith(".Transducer")]
    if not found:
        raise fault(path, None, "no Transducer is in it", "give a file that Ultraino saved as an array")
    orders = np.array([_number(path, bean, "orderNumber", 0.0, unset=np.nan) for bean in found])
    # A number may refer to a property with a default, which the file does not state: then it is the one that
    # all others leave out, or else 0.
    free = set(range(len(found))) - set(orders)
    orders[np.isnan(orders)] = free.pop() if len(free) == 1 else 0
    # Transducers with equal numbers stay in the order of the file.
    return [found[index] for index in np.argsort(orders, kind="stable")]


def read_drive(path: str | PathLike[str], root: Element) -> NDArray[np.complex64]:
    """Return the drive (N,) that is stored in the transducers of a Simulation."""
    found = _transducers(path, root)
    sizes = np.zeros(len(found))
    for name in ("pAmplitude", "amplitude"):
        sizes = np.array([_number(path, bean, name, size) for bean, size in zip(found, sizes, strict=True)])
    if not any(name in bean.properties for bean in found for name in ("pAmplitude", "amplitude")):
        sizes[:] = 1
    for bean, size in zip(found, sizes, strict=True):
        if not 0 <= size <= 1:
            raise fault(path, bean.line, f"amplitude is {size:g}", "give 0 to 1")
    turns = np.array([_number(path, bean, "phase", 0.0) for bean in found])
    return (sizes * np.exp(1j * np.pi * turns)).astype(np.complex64)


def read(path: str | PathLike[str], root: Element) -> Layout:
    """Read the array of a Simulation."""
    found = _transducers(path, root)
    positions = np.array([_vector(path, _part(path, bean, "translation"), "xyz") for bean in found])
    rotations = np.array([_vector(path, _part(path, bean, "rot"), "wxyz", 1.0) for bean in found])
    for bean, rotation in zip(found, rotations, strict=True):
        if not 1e-6 < np.linalg.norm(rotation) < 1e6:
            raise fault(path, bean.line, f"rot is {rotation.tolist()}", "give a quaternion of length 1")
    # Transducers radiate to +y, which the quaternions rotate.
    w, x, y, z = (rotations / np.linalg.norm(rotations, axis=1, keepdims=True)).T
    power = np.array([_number(path, bean, "power", POWER) for bean in found])
    for bean, one in zip(found, power, strict=True):
        if one < 0:
            raise fault(path, bean.line, f"power is {one:g}", "give Pa m, at least 0")
    width = _common(path, found, "apperture", WIDTH, "m")
    corrected = sum(_number(path, bean, "phaseCorrection", 0.0) != 0 for bean in found)
    if corrected:
        reported = f"phaseCorrection of {counted(corrected, 'transducer')} of {path} is not read"
        cure = "for boards other than a second SonicSurface give -pi times it as corrections= of Board"
        warn(f"{reported}: {cure}")
    largest = power.max() or POWER
    return Layout(
        _upright(positions),
        _upright(np.stack([2 * (x * y - w * z), 1 - 2 * (x**2 + z**2), 2 * (y * z + w * x)], axis=1)),
        source_pressure=float(largest),
        directivity={"sinc": width},
        response=None if (power == largest).all() else power / largest,
        pins=_pins(path, found),
        frequency=_common(path, found, "frequency", 40e3, "Hz"),
    )


def _common(path: str | PathLike[str], beans: list[Bean], name: str, default: float, unit: str) -> float:
    """Return the number that all transducers have."""
    found = sorted({_number(path, bean, name, default) for bean in beans})
    if len(found) > 1:
        reported = f"transducers of {found[0]:g} and of {found[-1]:g} {unit} are in it"
        raise fault(path, None, reported, f"take all of one {name} into a file")
    return found[0]


def _pins(path: str | PathLike[str], transducers: list[Bean]) -> NDArray[np.int64] | None:
    """Return the channel of each transducer; None if the file leaves them out, or has one for several."""
    pins = np.array([_number(path, bean, "driverPinNumber", 0.0) for bean in transducers])
    if not pins.any():
        return None
    wrong = next((pin for pin in pins if pin < 0 or pin % 1 or (pins == pin).sum() > 1), None)
    if wrong is None:
        return pins.astype(np.int64)
    warn(f"driverPinNumber {wrong:g} of {path} is no channel of one transducer: no pins are read, give pins=")
    return None


def _upright(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotate vectors so that Ultraino's y axis becomes z."""
    x, y, z = vectors.T
    return np.stack([x, -z, y], axis=1) + 0.0


def _listed(beans: list[Bean]) -> list[Bean]:
    """Return the transducers in the list of a Simulation; an empty list if there is no such list."""
    for bean in beans:
        listed = bean.properties.get("transducers")
        if bean.kind.endswith(".Simulation") and isinstance(listed, Bean):
            return [one for one in listed.items if isinstance(one, Bean)]
    return []


def _part(path: str | PathLike[str], transducer: Bean, name: str) -> Bean:
    transform = transducer.properties.get("transform")
    found = transform.properties.get(name) if isinstance(transform, Bean) else None
    if found is None:
        return Bean("", transducer.line)
    if not isinstance(found, Bean):
        raise fault(path, transducer.line, f"{name} is {found!r}", "give an object")
    return found


def _vector(path: str | PathLike[str], part: Bean, axes: str, first: float = 0.0) -> list[float]:
    """Return the components of a vector; missing ones are 0, a missing w is `first`."""
    return [_number(path, part, axis, first if axis == "w" else 0.0) for axis in axes]


def _number(path: str | PathLike[str], bean: Bean, name: str, default: float, unset: float = 0.0) -> float:
    """Return a property; `unset` is the value of a reference to a property that was never set, in Java 0."""
    found: Any = bean.properties.get(name, default)
    if isinstance(found, Bean) and not (found.kind or found.properties or found.items):
        return unset
    if not isinstance(found, float):
        reported = f"an object of {found.kind or 'no class'}" if isinstance(found, Bean) else f"{str(found)[:40]!r}"
        raise fault(path, bean.line, f"{name} is {reported}", "give a number")
    return found


def write_pair(path: Path, drives: Played) -> None:
    """Write the files of phases and amplitudes, each completely or not at all."""
    if NAMED not in path.name:
        cure = f'put {NAMED} into the name, as in "{path.stem}{NAMED}.csv", or Ultraino finds no amplitudes'
        raise stated(f'output "{path}"', "is the phases of a pair", cure, code="unwritable")
    beside = path.with_name(path.name.replace(NAMED, f"0_{AMPLITUDE}"))
    with ExitStack() as opened:
        parts = [opened.enter_context(whole(one, (".csv",))) for one in (beside, path)]
        streams = (part.open("w", encoding="ascii", newline="\n") for part in parts)
        amplitudes, phases = map(opened.enter_context, streams)
        for drive in drives:
            for stream, values in ((amplitudes, np.abs(drive).clip(0, 1)), (phases, np.angle(drive))):
                stream.write(",".join(f"{value:.9g}" for value in values.tolist()) + "\n")


def partners(path: str | PathLike[str]) -> tuple[Path, Path] | None:
    """Return the files of phases and of amplitudes if the name belongs to a pair, else None."""
    name = Path(path)
    for one, other in ((PHASE, AMPLITUDE), (AMPLITUDE, PHASE)):
        if one in name.name:
            both = name, name.with_name(other.join(name.name.rsplit(one, 1)))
            return both if one == PHASE else both[::-1]
    return None


def read_pair(phases: Path, amplitudes: Path) -> NDArray[np.complex64]:
    """Read drives from a pair of files: (N,) for one frame, else (T, N)."""
    if not amplitudes.exists():
        raise fault(phases, None, f'its amplitudes, "{amplitudes.name}", are not beside it', "put them there")
    if not phases.exists():
        raise fault(amplitudes, None, f'its phases, "{phases.name}", are not beside it', "put them there")
    turned, sizes = (frames_of(one, rows(text(one))) for one in (phases, amplitudes))
    if turned.shape != sizes.shape:
        (frames, transducers), reported = turned.shape, f"{sizes.shape[0]} x {sizes.shape[1]} amplitudes"
        raise fault(amplitudes, None, reported, f"give as many as phases, {frames} x {transducers}")
    wrong = np.argwhere((sizes < 0) | (sizes > 1))
    if len(wrong):
        frame, column = wrong[0]
        value = f"amplitude {sizes[frame, column]:g} in frame {frame}, column {column + 1}"
        raise fault(amplitudes, None, value, "give 0 to 1")
    return one_or_more((sizes * np.exp(1j * turned)).astype(np.complex64))
