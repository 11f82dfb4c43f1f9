"""Guided fuzzing of every target in turns of some minutes; each turn is recorded in docs/reliability.md.

A target is finished when it has run for the requested number of seconds or executions with the present code.
Earlier runs with this code count, too, so an interrupted run can be continued later.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import record

FUZZ = record.ROOT / "fuzz"
#: Inputs that fuzzing has found, kept between runs; not in the repository.
WORK = FUZZ / ".work"
TARGET = "x86_64-unknown-linux-gnu"
#: The length of a turn in seconds. After it, the record is written and the next target runs.
SLICE = 600

RUST = ("scene", "positions", "sweep", "solve", "field", "session", "instruction_sets", "frames")
PYTHON = ("arguments", "functions", "chunks", "sweep_file", "picture", "drawing", "resume", "sequence_file")

#: The largest length of an input in bytes: short inputs are faster and find as much.
LENGTHS = dict.fromkeys(RUST, 1024) | {"positions": 256, "frames": 640} | dict.fromkeys(PYTHON, 4096)

OPTIONS = ["-print_final_stats=1", "-timeout=60", "-rss_limit_mb=4096", "-verbosity=1"]


@dataclass
class Had:
    """The number of executions and the seconds that a target has run with the present code."""

    executions: int = 0
    seconds: int = 0

    @classmethod
    def of(cls, name: str, code: str) -> Had:
        """Returns a target's totals with this code, from the rows of docs/reliability.md."""
        had = cls()
        for row in record.rows("fuzz"):
            if row[:2] == [name, code]:
                had.executions += _number(row[3])
                had.seconds += _number(row[4])
        return had


def _number(text: str) -> int:
    return int(text.replace(",", ""))


def seeds(name: str) -> list[Path]:
    """Returns the folders with the first inputs of a target, which are in the repository."""
    folders = [FUZZ / "corpus" / name]
    if name == "scene":
        golden = WORK / "golden"
        golden.mkdir(parents=True, exist_ok=True)
        for path in (record.ROOT / "golden").glob("*.json"):
            (golden / path.name).write_text(json.dumps(json.loads(path.read_text())["scene"]))
        folders += [golden, record.ROOT / "docs" / "scenes"]
    if name.startswith("sweep"):
        folders += [FUZZ / "corpus" / "sweep_file", record.ROOT / "docs" / "sweeps"]
    return [folder for folder in folders if folder.is_dir()]


def command(name: str, seconds: int, executions: int) -> list[str]:
    """Returns a target's program with libFuzzer's options, limited in seconds and executions."""
    corpus = WORK / "corpus" / name
    found = WORK / "found" / name
    for folder in (corpus, found):
        folder.mkdir(parents=True, exist_ok=True)
    if name in RUST:
        program = [str(FUZZ / "target" / TARGET / "release" / name)]
    else:
        program = [str(FUZZ / ".venv" / "bin" / "python"), str(FUZZ / "python" / f"{name}.py")]
    dictionary = FUZZ / f"{name.removesuffix('_file')}.dict"
    limits = [f"-max_len={LENGTHS[name]}", f"-max_total_time={seconds}", f"-runs={executions}"]
    options = [*OPTIONS, *limits, f"-artifact_prefix={found}/"]
    if dictionary.exists():
        options.append(f"-dict={dictionary}")
    return [*program, *options, str(corpus), *map(str, seeds(name))]


def environment(name: str) -> dict[str, str]:
    """Returns a target's environment. For Python, it preloads libFuzzer, which coverage counters need."""
    if name in RUST:
        return dict(os.environ)
    (library,) = (FUZZ / ".venv").glob("lib/python*/site-packages/ubsan_with_fuzzer.so")
    return {**os.environ, "LD_PRELOAD": str(library)}


def slice_of(name: str, code: str, seconds: int, executions: int) -> bool:
    """Runs one turn and records it. Returns whether it found no error."""
    begun = time.monotonic()
    log = WORK / f"{name}.log"
    with log.open("wb") as file:
        reported = command(name, seconds, executions)
        process = subprocess.Popen(reported, stdout=file, stderr=file, cwd=WORK, env=environment(name))
        try:
            process.wait()
        except KeyboardInterrupt:
            process.wait(60)
            note(name, code, log, time.monotonic() - begun, 0)
            raise
    note(name, code, log, time.monotonic() - begun, process.returncode)
    return process.returncode == 0


def note(name: str, code: str, log: Path, seconds: float, status: int) -> None:
    """Records the turn that has ended: adds its numbers to the target's row for this day and this code."""
    text = log.read_text(errors="replace")
    executed = re.findall(r"number_of_executed_units: (\d+)|^#(\d+)", text, re.M)
    executions = max((int(number) for pair in executed for number in pair if number), default=0)
    edges = re.findall(r"\bcov: (\d+)", text) or ["0"]
    finding = what(text) if status else ""
    row = [name, code, record.today(), str(executions), str(round(seconds)), edges[-1], finding]
    for other in record.rows("fuzz"):
        if other[:3] == row[:3]:
            row[3] = str(_number(other[3]) + int(row[3]))
            row[4] = str(_number(other[4]) + int(row[4]))
            row[5] = str(max(_number(other[5]), int(row[5])))
            parts = (other[6].removeprefix("none"), finding)
            row[6] = "; ".join(dict.fromkeys(part for part in parts if part))
    row[3:6] = [f"{int(number):,}" for number in row[3:6]]
    row[6] = row[6] or "none"
    record.add("fuzz", row, 3)
    print(f"  {name}: {executions} executions, {edges[-1]} edges, {finding or 'nothing found'}", flush=True)
    if finding:
        print(f"  see {log}", flush=True)


def what(text: str) -> str:
    """Returns in a few words why libFuzzer ended, with the name of the input."""
    ends = (r"panicked at .*\n(.*)", r"Uncaught Python exception: ===\n(.*)", r"ERROR: (.*)")
    words = next((found[1] for end in ends if (found := re.search(end, text))), "ended without a word")
    kept = re.findall(r"Test unit written to \S*/(\w+-\w{8})", text)
    words = re.sub(r"[|`\s]+", " ", words)[:100]
    return f"`{' '.join(kept[-1:])}` {words}".strip()


def build(sanitizer: str, folder: Path) -> None:
    """Builds the Rust targets with debug assertions and overflow checks, without tracing comparisons."""
    path = f"{FUZZ / '.tools' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    command = ["cargo", "+nightly", "fuzz", "build", f"--sanitizer={sanitizer}", f"--target-dir={folder}"]
    command += ["--no-trace-compares"]
    subprocess.run(command, cwd=record.ROOT, check=True, env={**os.environ, "PATH": path})


def install() -> None:
    """Installs the package for Atheris; its extension counts code coverage and checks for overflow."""
    passes = ["level=3", "inline-8bit-counters", "pc-table", "trace-compares"]
    flags = ["-Cpasses=sancov-module", *(f"-Cllvm-args=-sanitizer-coverage-{option}" for option in passes)]
    wheels = WORK / "wheels"
    options = ["--profile=dev", f"--target={TARGET}", f"--target-dir={FUZZ / 'target' / 'python'}", "--quiet"]
    made = ["--interpreter", sys.executable, "--compatibility=linux", f"--out={wheels}"]
    tools = Path(sys.executable).parent
    # With an explicit target, these flags do not apply to macros and build scripts.
    environment = {**os.environ, "RUSTFLAGS": " ".join(flags)}
    maturin = [tools / "maturin", "build", *options, *made]
    subprocess.run(maturin, cwd=record.ROOT, check=True, env=environment)
    uv = [tools / "uv", "pip", "install", "--quiet", "--no-deps", "--reinstall", "--python"]
    subprocess.run([*uv, FUZZ / ".venv" / "bin" / "python", *wheels.glob("*.whl")], check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--time", type=int, default=60, help="seconds a target, over all runs on this code")
    parser.add_argument("--runs", type=int, default=10**8, help="executions that are enough")
    parser.add_argument("targets", nargs="*", help="all unless named", metavar="TARGET")
    requested = parser.parse_args()
    names = requested.targets or [*RUST, *PYTHON]
    WORK.mkdir(exist_ok=True)
    # Records the state of the code before the build, because the code may change during the run.
    codes = {name: record.code("core/src", *([] if name in RUST else ["python"])) for name in names}
    if any(name in RUST for name in names):
        build("none", FUZZ / "target")
    if any(name in PYTHON for name in names):
        install()
    sound = True
    while names:
        for name in list(names):
            had = Had.of(name, codes[name])
            seconds, executions = requested.time - had.seconds, requested.runs - had.executions
            if seconds <= 0 or executions <= 0:
                print(f"{name}: {had.executions} executions in {had.seconds} s over this code")
                names.remove(name)
                continue
            print(f"{name}: {min(seconds, SLICE)} s", flush=True)
            if not slice_of(name, codes[name], min(seconds, SLICE), executions):
                sound = False
                names.remove(name)
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
