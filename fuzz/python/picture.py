"""Pictures: any bytes give an error of one line, or points with finite pressures."""

import io

import numpy as np
from PIL import Image

from guided import REFUSALS, Data, folder, fuzz, midair, refused, spoilt

FILE = folder() / "picture.png"


def made() -> list[bytes]:
    """Returns a small picture in each format and mode that can be read."""
    found = []
    pixels = np.random.default_rng(0).integers(0, 256, (7, 5, 4), np.uint8)
    for kind in ("PNG", "JPEG", "GIF", "BMP", "WEBP", "TIFF", "PPM"):
        for mode in ("RGBA", "RGB", "L", "1", "P"):
            content = io.BytesIO()
            try:
                Image.fromarray(pixels, "RGBA").convert(mode).save(content, kind)
            except OSError:
                # Some formats do not have every mode.
                continue
            found.append(content.getvalue())
    return found


KEPT = made()


def test(content: bytes) -> None:
    data = Data(content)
    spoil = data.ConsumeBool()
    FILE.write_bytes(spoilt(data, data.PickValueInList(KEPT)) if spoil else content[1:])
    try:
        found = midair.image(FILE, size=0.05, z=0.1, pixels=9)
    except REFUSALS as error:
        refused(error)
        return
    assert 0 < len(found.points) <= 81
    assert np.isfinite(found.points).all()
    assert np.isfinite(found.pressures).all()
    assert found.pressures.max() > 0


fuzz(test)
