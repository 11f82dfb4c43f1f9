"""Golden vectors: the bits that Rust wrote are the bits that Python gets."""

import json
from pathlib import Path

import numpy as np
import pytest

import midair

GOLDEN = sorted(Path(__file__).parents[2].joinpath("golden").glob("*.json"))


def test_there_are_golden_vectors() -> None:
    assert len(GOLDEN) >= 6


# Some targets are weak on purpose.
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_golden_vectors_come_out_bit_for_bit(path: Path, tmp_path: Path) -> None:
    record = json.loads(path.read_text())
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(record["scene"]))
    solution = midair.solve(midair.Scene.load(file), balance=record["balance"])
    expected = np.array(record["drive"], dtype=np.float32).view(np.complex64).reshape(-1)
    # Compared as bits: -0.0 and 0.0 differ there.
    assert solution.drive.tobytes() == expected.tobytes()
    for name, value in record["metrics"].items():
        # Decimal text of a double, written and read.
        assert getattr(solution.metrics, name) == pytest.approx(value, abs=1e-12), name
