"""Golden vectors: with the scalar instruction set, Python computes the bits that Rust recorded."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import midair

GOLDEN = sorted(Path(__file__).parents[2].joinpath("golden").glob("*.json"))

#: A program that solves the scenes named on its command line and writes their drives one after the other.
PROGRAM = """
import json, sys, warnings, midair
warnings.simplefilter("ignore")
for path in sys.argv[1:]:
    record = json.load(open(path))
    json.dump(record["scene"], open("scene.json", "w"))
    solution = midair.solve(midair.Scene.load("scene.json"), balance=record["balance"])
    sys.stdout.buffer.write(solution.drive.tobytes())
"""


def recorded(path: Path) -> np.ndarray:
    return np.array(json.loads(path.read_text("utf-8"))["drive"], dtype=np.float32)


def test_there_are_golden_vectors() -> None:
    assert len(GOLDEN) >= 6


@pytest.mark.slow
def test_golden_vectors_come_out_bit_for_bit_under_the_scalar_set(tmp_path: Path) -> None:
    environment = {**os.environ, "MIDAIR_SIMD": "scalar"}
    command = [sys.executable, "-c", PROGRAM, *map(str, GOLDEN)]
    done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, check=True)
    drives = np.frombuffer(done.stdout, dtype=np.float32)
    for path in GOLDEN:
        expected = recorded(path).reshape(-1)
        # Bits are compared, so that -0.0 and 0.0 differ.
        assert drives[: expected.size].tobytes() == expected.tobytes(), path.stem
        drives = drives[expected.size :]
    assert drives.size == 0


#: A program that solves the motions named on its command line, and prints the bytes of their boards' frames.
PLAYED = """
import json, pathlib, sys, warnings, midair
from midair._sequence.solve import motion_of, solve_motion
warnings.simplefilter("ignore")
for path in sys.argv[1:]:
    record = json.load(open(path))
    pathlib.Path("motion.json").write_text(json.dumps(record["motion"]))
    solved = solve_motion(motion_of(pathlib.Path("motion.json")))
    board = midair.Board(record["board"], solved.array)
    assert solved.points.reshape(-1, 3).tolist() == record["points"]
    assert solved.targets.ravel().tolist() == record["targets"]
    print(json.dumps([board.encode(drive).hex() for drive in solved.drives]))
"""


@pytest.mark.slow
def test_a_board_gets_the_bytes_of_a_motion_under_the_scalar_set(tmp_path: Path) -> None:
    motions = sorted(GOLDEN[0].parent.joinpath("motion").glob("*.json"))
    environment = {**os.environ, "MIDAIR_SIMD": "scalar"}
    command = [sys.executable, "-c", PLAYED, *map(str, motions)]
    done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, check=True, encoding="utf-8")
    for path, line in zip(motions, done.stdout.splitlines(), strict=True):
        assert json.loads(line) == json.loads(path.read_text("utf-8"))["bytes"], path.stem


# Some targets are weak on purpose, which causes a warning.
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_golden_vectors_are_as_good_under_the_best_set(path: Path, tmp_path: Path) -> None:
    record = json.loads(path.read_text("utf-8"))
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(record["scene"]), encoding="utf-8")
    metrics = midair.solve(midair.Scene.load(file), balance=record["balance"]).metrics
    # docs/reproducibility.md lists the allowed differences between instruction sets.
    assert metrics.accuracy == pytest.approx(record["metrics"]["accuracy"], abs=2e-3)
    assert metrics.sigma == pytest.approx(record["metrics"]["sigma"], abs=5e-3)
