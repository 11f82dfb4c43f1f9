"""Files of sequences: any bytes give an error of one line, or a sequence whose drives a board can play."""

import numpy as np

from guided import REFUSALS, Data, folder, fuzz, midair, refused, spoilt
from midair._sequence import files

ARRAY = midair.Array.grid(3, 3, 10e-3)
POINTS = np.broadcast_to([0.0, 0.0, 0.1], (6, 1, 3))
FILE = folder() / "q.npz"


def made() -> list[bytes]:
    """Returns files of a sequence of drives and of one of codes, each uncompressed and compressed."""
    found = []
    for given in (
        {"drives": np.exp(1j * np.arange(54.0).reshape(6, 9))},
        {"drives": np.arange(54).reshape(6, 9) % 16, "quantization": {"phases": 16}},
    ):
        midair.Sequence(ARRAY, POINTS, 1.0, rate=100, **given).save(FILE)
        found.append(FILE.read_bytes())
        with np.load(FILE) as kept:
            np.savez_compressed(FILE, **kept)
        found.append(FILE.read_bytes())
    return found


KEPT = made()


def test(content: bytes) -> None:
    data = Data(content)
    # Arrays larger than LARGE stay in the file: the test uses the code for large or that for small files.
    files.LARGE = data.PickValueInList((0, 1 << 28))
    spoil = data.ConsumeIntInRange(0, 3)
    FILE.write_bytes(spoilt(data, data.PickValueInList(KEPT)) if spoil else content[2:])
    try:
        found = midair.Sequence.load(FILE)
        drives = found.drives
    except REFUSALS as error:
        refused(error)
        return
    assert (np.abs(drives) <= 1 + 1e-6).all()
    assert drives.shape == (len(found), len(found.array))


fuzz(test)
