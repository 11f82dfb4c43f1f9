"""Stored results of a sweep: a file gives the result that was stored, or none if it is damaged."""

import numpy as np

from guided import Data, folder, fuzz, spoilt
from midair._support.cache import digest
from midair._sweep.engine import identity, load, save

ROWS = 3
FILE = folder() / "00000000000000000000" / f"0-{ROWS}.npz"
ARRAYS = {
    "accuracy": np.arange(3.0),
    "status": np.array(["done", "stopped", "done"]),
    "drive": np.ones((3, 4), np.complex64),
}
save(FILE, ARRAYS)
KEPT = FILE.read_bytes()


def test(content: bytes) -> None:
    data = Data(content)
    way = data.ConsumeIntInRange(0, 2)
    if way == 0:
        # The stored file with some damaged bytes.
        damaged = spoilt(data, KEPT)
        FILE.write_bytes(damaged)
        found = load(FILE, ROWS)
        same = found is not None and all(np.array_equal(found[name], ARRAYS[name]) for name in ARRAYS)
        assert found is None or (damaged == KEPT and same)
    else:
        # Any bytes, with a digest that fits or without one.
        packed = data.ConsumeBytes(data.remaining_bytes())
        FILE.write_bytes(packed + (digest(identity(FILE), packed) if way == 1 else b""))
        found = load(FILE, ROWS)
        assert found is None or all(len(array) == ROWS for array in found.values())


fuzz(test)
