"""Resume folders: whatever they contain, the finished sequence is the requested one."""

import shutil

import numpy as np

from guided import Data, folder, fuzz, midair, refused, spoilt
from midair._sequence import solve as motion

BOARD = midair.Array.grid(4, 4, 10e-3, quantization={"phases": 16})
POINTS = np.array([[[0.001 * k, 0.0, 0.1]] for k in range(12)])
FOLDER = folder()
FILE = FOLDER / "x.npz"
RESUME = FOLDER / "x.npz.resume"
motion.BLOCK = 4


class Enough(Exception):
    """Raised when all parts but the last have been computed."""


def solved(stop: bool) -> midair.Sequence:
    def progress(done: int, total: int) -> None:
        if stop and done == 8:
            raise Enough

    return midair.sequence(BOARD, POINTS, rate=1000, change=3.2, resume=FILE, progress=progress)


WHOLE = solved(stop=False)
# A finished file is read instead of solved again.
FILE.unlink()
try:
    solved(stop=True)
except Enough:
    KEPT = {file.name: file.read_bytes() for file in RESUME.iterdir()}


def test(content: bytes) -> None:
    data = Data(content)
    FILE.unlink(missing_ok=True)
    shutil.rmtree(RESUME, ignore_errors=True)
    RESUME.mkdir()
    for name, kept in KEPT.items():
        way = data.ConsumeIntInRange(0, 4)
        if way == 1:
            (RESUME / name).write_bytes(spoilt(data, kept))
        elif way == 2:
            (RESUME / name).write_bytes(KEPT[data.PickValueInList(sorted(KEPT))])
        elif way != 3:
            (RESUME / name).write_bytes(kept)
    try:
        assert solved(stop=False) == WHOLE
    except midair.SceneError as error:
        # A file of another request may have been put there, which is an error.
        refused(error)


fuzz(test)
