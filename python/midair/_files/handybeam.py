"""HandyBeam's arrays, `.xml` of "Acoustic Renderer" (ultraleap/HandyBeam, tx_array_library.py), in mm.

Each System/Transducers/Transducer has Index, Xmm, Ymm, Zmm, and ABX, which is "X" if the transducer is off.
Normals are +z. HandyBeam's directivity is cos(theta)^3.376.
"""

from os import PathLike

import numpy as np

from .._boards.layout import Layout
from .._support.text import fault, number
from .xml import Element


def read(path: str | PathLike[str], root: Element) -> Layout:
    """Read all System/Transducers/Transducer elements, in the order of Index."""
    found = [root]
    for name in ("System", "Transducers", "Transducer"):
        found = [child for element in found for child in element.children if child.name == name]
    if not found:
        raise fault(
            path, None, "no System/Transducers/Transducer is in it", "give an array of HandyBeam or Ultraino"
        )
    positions = np.full((len(found), 3), np.nan)
    mask = np.ones(len(found), np.bool_)
    for element in found:
        index = element.attributes.get("Index", "")
        cure = f"give each of 0 to {len(found) - 1} once"
        if not (index.isascii() and index.isdecimal() and int(index[:9]) < len(found)):
            raise fault(path, element.line, f'Index is "{index[:40]}"', cure)
        place = int(index)
        if not np.isnan(positions[place, 0]):
            raise fault(path, element.line, f"Index {place} is there twice", cure)
        for axis, name in enumerate(("Xmm", "Ymm", "Zmm")):
            cell = element.attributes.get(name, "")
            value = number(cell)
            if value is None:
                raise fault(path, element.line, f'{name} is "{cell[:40]}"', "give a finite number in mm")
            positions[place, axis] = value / 1e3
        mask[place] = element.attributes.get("ABX") != "X"
    return Layout(positions, directivity={"cos": 3.376}, mask=None if mask.all() else mask)
