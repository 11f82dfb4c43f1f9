"""The output of `make test` and `make demo`: a line above each command, and the name of a step that fails."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="make is missing")


def make(*arguments: str) -> subprocess.CompletedProcess[str]:
    # If make runs these tests, the inner make must not inherit the options of the outer one.
    alone = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
    return subprocess.run(["make", *arguments], cwd=ROOT, capture_output=True, encoding="utf-8", env=alone)


@pytest.mark.parametrize("target", ["check", "test", "demo"])
def test_every_command_is_announced(target: str) -> None:
    # A dry run only prints the commands. The environment counts as ready: its own rule is not tested here.
    lines = make("--dry-run", "--assume-old=.venv/ready", target).stdout.splitlines()
    assert len(lines) >= 4
    for line in lines:
        assert line.startswith(("echo", "make", "mkdir", "touch .venv/", "\t||", "||")), line


def test_no_name_of_a_step_has_a_comma() -> None:
    # Make would take the text after a comma for the command.
    names = re.findall(r"call step,([^(]*)\(", (ROOT / "Makefile").read_text("utf-8"))
    assert len(names) > 20
    assert [name for name in names if "," in name] == []


def test_a_step_that_fails_is_named(tmp_path: Path) -> None:
    steps = "\t$(call step,one (1 s),true)\n\t$(call step,two (1 s),false)\n"
    (tmp_path / "Makefile").write_text(f"include {ROOT / 'Makefile'}\nbroken:\n{steps}", "utf-8")
    done = make("-f", str(tmp_path / "Makefile"), "broken")
    assert done.returncode == 2
    printed = ["== one (1 s)", "-- one (1 s): it took 0 s", "== two (1 s)"]
    assert [line for line in done.stdout.splitlines() if line] == printed
    assert done.stderr.startswith("== failed: two (1 s)\n")
