"""Octave with the package of matlab/ on its path; `make test-matlab` compiles the package before."""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1]


@pytest.fixture
def octave(tmp_path: Path) -> Callable[[str], str]:
    """Returns a function that runs a program in an empty folder, and returns what it prints."""
    if shutil.which("octave-cli") is None:
        pytest.skip("octave-cli is not installed")

    def run(program: str) -> str:
        script = tmp_path / "program.m"
        paths = "".join(f"addpath('{folder}');" for folder in (FOLDER, FOLDER / "tests"))
        script.write_text(f"{paths}\n{program}\n", "utf-8")
        command = ["octave-cli", "--norc", "--quiet", str(script)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, encoding="utf-8")
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run
