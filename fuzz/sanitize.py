"""Sanitizers and Miri over the core's tests, and over what fuzzing has found, recorded in docs/reliability.md."""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import record
from run import FUZZ, RUST, TARGET, WORK, fuzz_build, seeds

#: Beyond this many seconds a check is broken off: that is a finding.
MOST = 3600

TEST = ["cargo", "+nightly", "test", "--quiet", "-p", "midair", "--features", "scene-file,parallel"]
#: The standard library is built along, so that it is watched as well.
WATCHED = [f"--target={TARGET}", "-Zbuild-std"]
MIRI = ["cargo", "+nightly", "miri", "test", "--quiet", "-p", "midair", "--features", "scene-file", "--lib"]
#: What ends in minutes where every operation is interpreted.
KERNELS = ["kernels::", "linalg::", "device::", "--skip", "large_grid", "--skip", "every_"]


@dataclass(frozen=True)
class Check:
    """A command that exits with 0 where all is well."""

    name: str
    command: list[str]
    environment: dict[str, str] = field(default_factory=dict)


def tests(name: str, *filters: str, **environment: str) -> Check:
    """The core's tests under a sanitizer."""
    folder = f"--target-dir={FUZZ / 'target' / name}"
    environment = {"RUSTFLAGS": f"-Zsanitizer={name}", **environment}
    return Check(f"{name} sanitizer", [*TEST, *WATCHED, folder, "--lib", "--test", "suite", *filters], environment)


def replay(name: str) -> Check:
    """Every input of a target's corpus, once, under the address sanitizer."""
    program = FUZZ / "target" / "replay" / TARGET / "release" / name
    folders = [WORK / "corpus" / name, *seeds(name)]
    return Check(f"address sanitizer, `{name}`", [str(program), "-runs=0", *map(str, folders)])
