"""Drawings: any text, read as SVG, gives an error of one line or finite points, within seconds."""

import numpy as np

from guided import REFUSALS, Data, fuzz, refused
from midair import shape

HEAD = b'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'

#: Typical elements of drawings.
PARTS = (
    b'<path d="M0 0L9 3"/>',
    b'<path id="a" d="M0 0C1 2 3 4 5 6A3 2 1 0 1 9 9Z"/>',
    b'<g id="b">',
    b"</g>",
    b'<use href="#a"/>',
    b'<use xlink:href="#b"/>',
    b'<g transform="rotate(30) scale(2 1) matrix(1 0 0 1 3 4)">',
    b'<rect x="1" y="2" width="3" height="4" rx="1"/>',
    b'<circle r="3"/>',
    b'<polyline points="0,0 1,2 3,1"/>',
    b"<style>path{display:none}</style>",
    b'<line x2="4%" y2="1e3"/>',
)


def test(content: bytes) -> None:
    data = Data(content)
    text = HEAD
    while data.remaining_bytes():
        own = data.ConsumeIntInRange(0, 3) == 0
        text += data.ConsumeBytes(data.ConsumeIntInRange(0, 16)) if own else data.PickValueInList(PARTS)
    text += b"</svg>"
    for given in (text.decode("utf-8", "replace"), "<" + content.decode("utf-8", "replace")):
        try:
            found = shape.svg(given, size=0.05, z=0.1, step=0.005)
        except REFUSALS as error:
            refused(error)
        else:
            assert len(found)
            assert np.isfinite(found).all()
            assert np.ptp(found, axis=0).max() <= 0.05 * (1 + 1e-6)


fuzz(test)
