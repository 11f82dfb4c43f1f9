"""The compared programs: each runs in a process and an environment of its own, limited to one thread."""

import json
import os
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

BENCH = Path(__file__).parent
ENVIRONMENTS, WORKERS = BENCH / ".envs", BENCH / "workers"
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("RAYON", "OMP", "OPENBLAS", "MKL")}


@dataclass(frozen=True)
class Rival:
    """A program's command, a file that it needs, and how to get that file."""

    name: str
    command: tuple[str, ...]
    needs: Path
    cure: str


def _library(name: str, cure: str, *arguments: str) -> Rival:
    folder = ENVIRONMENTS / name
    command = (str(folder / "bin" / "python"), str(WORKERS / f"{name}_worker.py"), *arguments)
    return Rival(name, command, folder / "ready", cure)


def _textbook(name: str, library: str) -> Rival:
    path = ENVIRONMENTS / f"{library}.so"
    command = (sys.executable, str(WORKERS / "textbook_worker.py"), str(path))
    return Rival(name, command, path, f"`make bench/.envs/{library}.so` compiles it")


def _crate(name: str) -> Rival:
    path = ENVIRONMENTS / name
    return Rival(name, (str(path),), path, f"`make bench/.envs/{name}` builds it")


RIVALS = (
    Rival("midair", (sys.executable, str(WORKERS / "midair_worker.py")), BENCH, ""),
    _library("autd3", "`make bench/.envs/autd3/ready` installs it"),
    _crate("autd3-rs"),
    _library("acoustools", "`make bench-peers ACOUSTOOLS=1` installs it (torch: some GB)", "-cpu"),
    _textbook("textbook f64", "textbook"),
    _textbook("textbook f32", "planar"),
)


class Worker:
    """The running process of a program; ends with the `with` block."""

    def __init__(self, rival: Rival) -> None:
        self.name = rival.name
        self._process = subprocess.Popen(
            rival.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
            env=os.environ | ONE_THREAD,
        )
        assert self._process.stdin
        assert self._process.stdout
        self._in, self._out = self._process.stdin, self._process.stdout
        hello = self._hear("it said what it offers")
        self.version: str = hello["version"]
        self.methods: list[str] = hello["methods"]
        self.forms: list[str] = hello["forms"]

    def __enter__(self) -> "Worker":
        return self

    def __exit__(self, *_: object) -> None:
        with self._process:
            self._process.kill()

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Sends a request and returns the reply (workers/serve.py)."""
        with suppress(BrokenPipeError):  # without the reply, `_hear` reports the failure
            self._in.write(json.dumps(request) + "\n")
            self._in.flush()
        return self._hear(f"it answered {request['method']}, M = {len(request['points'])}")

    def _hear(self, event: str) -> dict[str, Any]:
        line = self._out.readline()
        if not line:
            raise SystemExit(f"{self.name} ended before {event}; its own words are above")
        message: dict[str, Any] = json.loads(line)
        return message
