"""The fuzz targets written in Python pass for the stored inputs: seeds and past crashes."""

import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).resolve().parents[2] / "fuzz"
TARGETS = sorted(path.stem for path in (FUZZ / "python").glob("*.py") if "\nfuzz(test)\n" in path.read_text("utf-8"))


def test_every_target_is_run_by_make_fuzz() -> None:
    text = (FUZZ / "run.py").read_text("utf-8")
    assert len(TARGETS) == 8
    assert all(f'"{name}"' in text for name in TARGETS)


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_seeds_and_past_crashes_pass(name: str) -> None:
    script = FUZZ / "python" / f"{name}.py"
    reported = subprocess.run([sys.executable, script, "replay"], capture_output=True, encoding="utf-8", timeout=120)
    assert reported.returncode == 0, reported.stderr
