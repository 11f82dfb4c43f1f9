"""Kept results of a sweep: what lies in such a file is the result that was kept, or not there."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from guided import Data, fuzz
from midair._support.kept import digest
from midair._sweep.engine import identity, load, save

ROWS = 3
FOLDER = Path(tempfile.mkdtemp(dir="/dev/shm"))
FILE = FOLDER / "00000000000000000000" / f"0-{ROWS}.npz"
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
        # What was kept, spoilt here and there.
        spoilt = bytearray(KEPT)
        for _ in range(data.ConsumeIntInRange(1, 4)):
            at = data.ConsumeIntInRange(0, len(spoilt) - 1)
            cut = data.ConsumeIntInRange(0, 8)
            spoilt[at : at + cut] = data.ConsumeBytes(data.ConsumeIntInRange(0, 8))
        FILE.write_bytes(spoilt)
        found = load(FILE, ROWS)
        same = found is not None and all(np.array_equal(found[name], ARRAYS[name]) for name in ARRAYS)
        assert found is None or (bytes(spoilt) == KEPT and same)
    else:
        # Anything, with a digest that fits or without.
        packed = data.ConsumeBytes(data.remaining_bytes())
        FILE.write_bytes(packed + (digest(identity(FILE), packed) if way == 1 else b""))
        found = load(FILE, ROWS)
        assert found is None or all(len(array) == ROWS for array in found.values())


fuzz(test)
