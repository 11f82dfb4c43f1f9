"""Guided fuzzing of every target, one after the other; each run is a row of fuzz.csv, which
docs/reliability.md sums up.

A target is finished when it has run for the requested number of seconds or executions with the present code.
Earlier runs with this code count, too, so an interrupted run can be continued later.
"""

import argparse
import csv
import datetime
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FUZZ = ROOT / "fuzz"
#: Inputs that fuzzing has found, kept between runs; not in the repository.
WORK = FUZZ / ".work"
TARGET = "x86_64-unknown-linux-gnu"

RUST = ("scene", "positions", "sweep", "solve", "field", "session", "instruction_sets", "frames")
PYTHON = ("arguments", "functions", "chunks", "sweep_file", "picture", "drawing", "resume", "sequence_file")

#: The largest length of an input in bytes: short inputs are faster and find as much.
LENGTHS = dict.fromkeys(RUST, 1024) | {"positions": 256, "frames": 640} | dict.fromkeys(PYTHON, 4096)

OPTIONS = ["-print_final_stats=1", "-timeout=300", "-rss_limit_mb=4096", "-verbosity=1"]


def today() -> str:
    """Returns the date in the form of the tables."""
    return datetime.date.today().isoformat()


def code(*folders: str) -> str:
    """Returns the state of some folders: git's short hash of each folder, with a plus if it has uncommitted
    changes.
    """
    return " ".join(
        _git("rev-parse", "--short=8", f"HEAD:{folder}") + ("+" if _git("status", "--porcelain", "--", folder) else "")
        for folder in folders
    )


def _git(*arguments: str) -> str:
    command = ["git", *arguments]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, encoding="utf-8").stdout.strip()


def append(name: str, row: list[str]) -> None:
    """Appends a row to a record."""
    with (FUZZ / f"{name}.csv").open("a", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerow(row)


def first(ends: Sequence[str], text: str, otherwise: str) -> str:
    """Returns the words by which a program's log says why it ended: of the first pattern that it contains."""
    found = next((found for end in ends if (found := re.search(end, text))), None)
    words = otherwise if found is None else found[found.lastindex or 0]
    return re.sub(r"[|`\s]+", " ", words)[:120]


def had(name: str, code: str) -> list[int]:
    """Returns the executions and the seconds that a target has run with this code, by fuzz.csv."""
    with (FUZZ / "fuzz.csv").open(newline="", encoding="utf-8") as file:
        runs = [row for row in csv.reader(file) if row[:2] == [name, code]]
    return [sum(int(row[column].replace(",", "")) for row in runs) for column in (3, 4)]


def seeds(name: str) -> list[Path]:
    """Returns the folders with the first inputs of a target, which are in the repository."""
    folders = [FUZZ / "corpus" / name]
    if name == "scene":
        golden = WORK / "golden"
        golden.mkdir(parents=True, exist_ok=True)
        for path in (ROOT / "golden").glob("*.json"):
            scene = json.loads(path.read_text("utf-8"))["scene"]
            (golden / path.name).write_text(json.dumps(scene), encoding="utf-8")
        folders += [golden, ROOT / "docs" / "scenes"]
    if name.startswith("sweep"):
        folders += [FUZZ / "corpus" / "sweep_file", ROOT / "docs" / "sweeps"]
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


def run(name: str, code: str, seconds: int, executions: int) -> bool:
    """Runs a target and records the run, also one that Ctrl-C ends. Returns whether it found no error."""
    begun = time.monotonic()
    log = WORK / f"{name}.log"
    stopped = False
    with log.open("wb") as file:
        reported = command(name, seconds, executions)
        process = subprocess.Popen(reported, stdout=file, stderr=file, cwd=WORK, env=environment(name))
        try:
            process.wait()
        except KeyboardInterrupt:
            stopped = True
            process.wait(60)
    text = log.read_text(errors="replace", encoding="utf-8")
    executed = re.findall(r"number_of_executed_units: (\d+)|^#(\d+)", text, re.M)
    done = max((int(number) for pair in executed for number in pair if number), default=0)
    edges = int((re.findall(r"\bcov: (\d+)", text) or ["0"])[-1])
    sound = stopped or process.returncode == 0
    finding = "none" if sound else what(text)
    numbers = [f"{number:,}" for number in (done, round(time.monotonic() - begun), edges)]
    append("fuzz", [name, code, today(), *numbers, finding])
    print(
        f"  {name}: {done} executions, {edges} edges, {finding}" + ("" if sound else f": see {log}"),
        flush=True,
    )
    if stopped:
        raise KeyboardInterrupt
    return sound


def what(text: str) -> str:
    """Returns in a few words why libFuzzer ended, with the name of the input."""
    ends = (r"panicked at .*\n(.*)", r"Uncaught Python exception: ===\n(.*)", r"ERROR: (.*)")
    kept = re.findall(r"Test unit written to \S*/(\w+-\w{8})", text)
    return f"`{' '.join(kept[-1:])}` {first(ends, text, 'ended without a word')}".strip()


def build(sanitizer: str, folder: Path) -> None:
    """Builds the Rust targets with debug assertions and overflow checks, without tracing comparisons."""
    path = f"{FUZZ / '.tools' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    command = ["cargo", "+nightly", "fuzz", "build", f"--sanitizer={sanitizer}", f"--target-dir={folder}"]
    command += ["--no-trace-compares", "--features=guided"]
    # Not as a release is: many small units are built faster, and reports name lines.
    profile = {"LTO": "off", "CODEGEN_UNITS": "16", "DEBUG": "1"}
    settings = {f"CARGO_PROFILE_RELEASE_{key}": value for key, value in profile.items()}
    subprocess.run(command, cwd=ROOT, check=True, env={**os.environ, **settings, "PATH": path})


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
    subprocess.run(maturin, cwd=ROOT, check=True, env=environment)
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
    codes = {name: code("core/src", *([] if name in RUST else ["python"])) for name in names}
    if any(name in RUST for name in names):
        build("none", FUZZ / "target")
    if any(name in PYTHON for name in names):
        install()
    sound = True
    for name in names:
        executions, seconds = had(name, codes[name])
        if seconds >= requested.time or executions >= requested.runs:
            print(f"{name}: {executions} executions in {seconds} s over this code")
            continue
        print(f"{name}: {requested.time - seconds} s", flush=True)
        sound &= run(name, codes[name], requested.time - seconds, requested.runs - executions)
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
