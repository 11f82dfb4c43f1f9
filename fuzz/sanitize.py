"""Runs the core's tests and fuzzing's inputs with sanitizers and Miri; recorded in sanitize.csv."""

import argparse
import os
import re
import subprocess
import sys
import time
from typing import NamedTuple

from run import FUZZ, ROOT, RUST, TARGET, WORK, append, build, code, first, seeds, today

#: The largest duration of a check in seconds: a longer check is stopped and counts as an error.
MOST = 3600

#: The words by which a log says why a check ended.
ENDS = (r"\w+Sanitizer: .*", r"Undefined Behavior: .*", r"test result: FAILED.*", r"error.*")

FEATURES = ["-p", "midair", "--features", "scene-file"]


class Check(NamedTuple):
    """A command whose exit status is 0 if there is no error."""

    name: str
    command: list[str]
    environment: dict[str, str]


def tests(sanitizer: str, *chosen: str) -> list[str]:
    """Returns the command that compiles the standard library and the core's tests with a sanitizer,
    and runs the tests.
    """
    watched = [f"--target={TARGET}", "-Zbuild-std", f"--target-dir={FUZZ / 'target' / sanitizer}"]
    return ["cargo", "+nightly", "test", *FEATURES, *watched, *chosen]


def replay(target: str) -> Check:
    """Returns the check that runs all inputs of a target once."""
    program = FUZZ / "target" / "replay" / TARGET / "release" / target
    folders = [WORK / "corpus" / target, WORK / "found" / target, *seeds(target)]
    there = [str(folder) for folder in folders if folder.is_dir()]
    options = ["-runs=0", "-print_final_stats=1", "-rss_limit_mb=8192"]
    return Check(f"address, inputs of `{target}`", [str(program), *options, *there], {})


#: The tests of the kernels that take only minutes in an interpreter; others take hours.
SHORT = ("phasor::", "tests::cholesky", "tests::double::a_matrix", "tests::simd")


def miri(name: str, flags: str) -> Check:
    """Returns the check that runs some of the kernels' tests in Miri."""
    chosen = ["--lib", "--", *(f"kernels::{module}" for module in SHORT)]
    folder = f"--target-dir={FUZZ / 'target' / 'miri'}"
    # Miri does not support the assembly that libm uses for square roots.
    portable = ["--features", "libm/force-soft-floats"]
    command = ["cargo", "+nightly", "miri", "test", "-p", "midair", *portable, folder, *chosen]
    # By default Miri changes the last bits of powers and sines at random; the tests need the exact ones.
    return Check(name, command, {"RUSTFLAGS": flags, "MIRIFLAGS": "-Zmiri-deterministic-floats"})


def checks() -> dict[str, list[Check]]:
    """Returns the checks, by the word that selects them on the command line."""
    address = {"RUSTFLAGS": "-Zsanitizer=address", "ASAN_OPTIONS": "detect_leaks=1"}
    thread = {"RUSTFLAGS": "-Zsanitizer=thread"}
    core, suite = tests("address", "--lib"), tests("address", "--test", "suite")
    parallel = tests("thread", "--test", "suite", "--", "session", "field", "bit_for_bit")
    return {
        "address": [
            Check("address and leak, the core's own tests", core, address),
            Check("address and leak, the core's suite", suite, address),
        ],
        "replay": [replay(target) for target in RUST],
        "thread": [Check("thread, sessions, batches and fields", parallel, thread)],
        "miri": [miri("Miri, scalar", ""), miri("Miri, AVX2", "-Ctarget-feature=+avx2,+fma")],
    }


def run(check: Check) -> bool:
    """Runs one check and records it. Returns whether it found no error."""
    print(f"{check.name}: {' '.join(check.command)}", flush=True)
    begun = time.monotonic()
    log = WORK / f"{re.sub('[^a-z0-9]+', '-', check.name.lower()).strip('-')}.log"
    with log.open("wb") as file:
        environment = {**os.environ, **check.environment}
        # `timeout` ends with the status 124 if it stops a command.
        limited = ["timeout", str(MOST), *check.command]
        status = subprocess.run(limited, stdout=file, stderr=file, cwd=ROOT, env=environment).returncode
    seconds = time.monotonic() - begun
    text = log.read_text(errors="replace", encoding="utf-8")
    count = sum(map(int, re.findall(r"test result: \w+\. (\d+) passed", text)))
    inputs = re.search(r"number_of_executed_units: (\d+)", text)
    ran = f"{inputs[1]} inputs" if inputs else f"{count} tests"
    ended = {0: "none", 124: f"broken off after {MOST} s"}
    finding = ended.get(status) or first(ENDS, text, f"ended with {status}")
    row = [check.name, code("core"), today(), str(round(seconds)), ran, finding]
    append("sanitize", row)
    print(f"  {ran}, {finding}" + ("" if status == 0 else f": see {log}"), flush=True)
    return status == 0


def main() -> int:
    chosen = checks()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("checks", nargs="*", help="all unless named", metavar="CHECK", choices=[[], *chosen])
    names = parser.parse_args().checks or list(chosen)
    WORK.mkdir(exist_ok=True)
    if "replay" in names:
        build("address", FUZZ / "target" / "replay")
    sound = [run(check) for name in names for check in chosen[name]]
    return 0 if all(sound) else 1


if __name__ == "__main__":
    sys.exit(main())
