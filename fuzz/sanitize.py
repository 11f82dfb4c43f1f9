"""Sanitizers and Miri over the core's tests, and over what fuzzing keeps, each recorded in docs/reliability.md."""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import record
from run import FUZZ, RUST, TARGET, WORK, build, seeds

#: Seconds after which a check is broken off, which is a finding.
MOST = 3600

FEATURES = ["-p", "midair", "--features", "scene-file,parallel"]


@dataclass(frozen=True)
class Check:
    """A command that exits with 0 where all is well."""

    name: str
    command: list[str]
    environment: dict[str, str]


def tests(sanitizer: str, *chosen: str) -> list[str]:
    """The core's tests under a sanitizer, the standard library built along, so that it is watched as well."""
    watched = [f"--target={TARGET}", "-Zbuild-std", f"--target-dir={FUZZ / 'target' / sanitizer}"]
    return ["cargo", "+nightly", "test", *FEATURES, *watched, *chosen]


def replay(target: str) -> Check:
    """Every input that a target's fuzzing keeps, once."""
    program = FUZZ / "target" / "replay" / TARGET / "release" / target
    folders = [WORK / "corpus" / target, WORK / "found" / target, *seeds(target)]
    there = [str(folder) for folder in folders if folder.is_dir()]
    return Check(f"address, inputs of `{target}`", [str(program), "-runs=0", "-rss_limit_mb=8192", *there], {})


def miri(name: str, flags: str) -> Check:
    """The kernels' and the linear algebra's own tests, each operation interpreted: at few lengths, it takes its time."""
    chosen = ["--lib", "kernels::", "linalg::", "device::"]
    folder = f"--target-dir={FUZZ / 'target' / 'miri'}"
    command = ["cargo", "+nightly", "miri", "test", "-p", "midair", folder, *chosen]
    return Check(name, command, {"RUSTFLAGS": flags})


def checks() -> dict[str, list[Check]]:
    """By the word that chooses them."""
    address = {"RUSTFLAGS": "-Zsanitizer=address", "ASAN_OPTIONS": "detect_leaks=1:detect_stack_use_after_return=1"}
    thread = {"RUSTFLAGS": "-Zsanitizer=thread", "RAYON_NUM_THREADS": "4"}
    parallel = ["--test", "suite", "--", "session", "field", "bit_for_bit"]
    return {
        "address": [Check("address and leak, the core's tests", tests("address", "--lib", "--test", "suite"), address)],
        "replay": [replay(target) for target in RUST],
        "thread": [Check("thread, sessions, batches and fields", tests("thread", *parallel), thread)],
        "miri": [miri("Miri, scalar", ""), miri("Miri, AVX2", "-Ctarget-feature=+avx2,+fma")],
    }


def run(check: Check) -> bool:
    """One check and its row in the record; whether all is well."""
    print(f"{check.name}: {' '.join(check.command)}", flush=True)
    begun = time.monotonic()
    log = WORK / f"{re.sub('[^a-z0-9]+', '-', check.name.lower()).strip('-')}.log"
    with log.open("wb") as file:
        environment = {**os.environ, **check.environment}
        try:
            status = subprocess.run(
                check.command, stdout=file, stderr=file, cwd=record.ROOT, env=environment, timeout=MOST
            ).returncode
        except subprocess.TimeoutExpired:
            status = -1
    seconds = time.monotonic() - begun
    text = log.read_text(errors="replace")
    count = sum(map(int, re.findall(r"test result: \w+\. (\d+) passed", text)))
    inputs = re.findall(r"number_of_executed_units: (\d+)|Loaded \d+/(\d+) files|^#(\d+)\s+DONE", text, re.M)
    ran = f"{count} tests" if count else f"{max([0, *(int(n) for match in inputs for n in match if n)])} inputs"
    finding = "none" if status == 0 else what(text, status)
    row = [check.name, record.code("core"), record.today(), str(round(seconds)), ran, finding]
    record.put("sanitize", row, 3)
    print(f"  {ran}, {finding}" + ("" if status == 0 else f": see {log}"), flush=True)
    return status == 0


def what(text: str, status: int) -> str:
    """What ended a check, in a few words."""
    if status == -1:
        return f"broken off after {MOST} s"
    said = re.findall(r"((?:ERROR|WARNING): \w+Sanitizer[^\n]*|error: Undefined Behavior[^\n]*|test result: FAILED[^\n]*|error[:\[][^\n]*)", text)
    return re.sub(r"[|`\s]+", " ", said[0] if said else f"ended with {status}")[:120]


def main() -> int:
    chosen = checks()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("checks", nargs="*", help="all unless named", metavar="CHECK", choices=[[], *chosen])
    names = parser.parse_args().checks or list(chosen)
    WORK.mkdir(exist_ok=True)
    if "replay" in names:
        build("address", FUZZ / "target" / "replay")
    return 0 if all([run(check) for name in names for check in chosen[name]]) else 1


if __name__ == "__main__":
    sys.exit(main())
