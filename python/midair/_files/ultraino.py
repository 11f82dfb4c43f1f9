"""Ultraino's arrays, `.xml.gz` or `.xml` (asiermarzo/Ultraino, arrays/): a Simulation by XMLDecoder of Java.

Its y is up: a flat array lies in y = 0 and faces +y. Here it lies in z = 0 and faces +z: (x, y, z) is
turned to (x, -z, y), normals too. A transducer has the width `apperture`, the directivity sin(x)/x
(CalcField.java) and `power`, its pressure times distance at full drive in Pa m. Phase corrections belong
to the board and are not read.
"""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._boards.layout import Layout, turned
from .._support.text import fault
from .xml import Bean, Decoder, Element

#: Defaults of Transducer.java.
POWER = 2.53
WIDTH = 0.009


def read(path: str | PathLike[str], root: Element) -> Layout:
    """Read the transducers of a Simulation, in the order of their numbers."""
    beans = Decoder(path, root).beans
    found = _listed(beans) or [bean for bean in beans if bean.kind.endswith(".Transducer")]
    if not found:
        raise fault(path, None, "no Transducer is in it: give a file that Ultraino saved as an array")
    # Stable: transducers of one number stay in their listed order.
    found = sorted(found, key=lambda bean: _number(path, bean, "orderNumber", 0.0))
    positions = np.array([_vector(path, _part(path, bean, "translation"), "xyz") for bean in found])
    rotations = np.array([_vector(path, _part(path, bean, "rot"), "wxyz", 1.0) for bean in found])
    for bean, rotation in zip(found, rotations, strict=True):
        if not 1e-6 < np.linalg.norm(rotation) < 1e6:
            raise fault(path, bean.line, f"rot is {rotation.tolist()}: give a quaternion of length 1")
    power = np.array([_number(path, bean, "power", POWER) for bean in found])
    for bean, one in zip(found, power, strict=True):
        if one < 0:
            raise fault(path, bean.line, f"power is {one:g}: give Pa m, at least 0")
    width = sorted({_number(path, bean, "apperture", WIDTH) for bean in found})
    if len(width) > 1:
        reported = f"transducers of {width[0]:g} and of {width[-1]:g} m"
        raise fault(path, None, f"{reported} are in it: take all of one width into a file")
    largest = power.max() or POWER
    return Layout(
        _upright(positions),
        _upright(turned(rotations, [0.0, 1.0, 0.0])),
        source_pressure=float(largest),
        directivity={"sinc": width[0]},
        response=None if (power == largest).all() else power / largest,
    )


def _upright(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """From y up to z up."""
    x, y, z = vectors.T
    return np.stack([x, -z, y], axis=1) + 0.0


def _listed(beans: list[Bean]) -> list[Bean]:
    """The transducers that a Simulation lists."""
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
        raise fault(path, transducer.line, f"{name} is {found!r}: give an object")
    return found


def _vector(path: str | PathLike[str], part: Bean, axes: str, first: float = 0.0) -> list[float]:
    """Components; those left out are 0, w is 1."""
    return [_number(path, part, axis, first if axis == "w" else 0.0) for axis in axes]


def _number(path: str | PathLike[str], bean: Bean, name: str, default: float) -> float:
    found: Any = bean.properties.get(name, default)
    if not isinstance(found, float):
        reported = (
            f"an object of {found.kind or 'no class'}" if isinstance(found, Bean) else f"{str(found)[:40]!r}"
        )
        raise fault(path, bean.line, f"{name} is {reported}: give a number")
    return found
