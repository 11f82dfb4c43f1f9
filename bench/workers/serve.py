"""The protocol of a compared program: a line of JSON in, a line of JSON out; it reports its own CPU time.

First the program prints what it offers: {"version", "methods", "forms"}. Each request is a task {"method",
"form", "preset", "tiles", "grid", "positions", "source_pressure", "wavenumber", "sound_speed", "points",
"pressures", "seed", "repeat"} in SI units. The reply {"ns"} is the time of one of `repeat` calls, after
one that does not count. With "repeat" 0 it is {"drive": [re, im], "positions"}, and "metrics" if there are
any.
"""

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

#: The timed function, and an untimed one that converts its result into the entries of the reply.
Prepared = tuple[Callable[[], Any], Callable[[Any], dict[str, Any]]]


def serve(
    version: str, methods: Sequence[str], forms: Sequence[str], prepare: Callable[[dict[str, Any]], Prepared]
) -> None:
    """Replies until the input ends. Other output of the program goes to standard error."""
    with os.fdopen(os.dup(1), "w") as out:
        os.dup2(2, 1)
        _say(out, {"version": version, "methods": list(methods), "forms": list(forms)})
        for line in sys.stdin:
            task = json.loads(line)
            for name in ("positions", "points", "pressures"):
                task[name] = np.array(task[name])
            run, answer = prepare(task)
            result = run()
            _say(out, {"ns": _time(run, task["repeat"])} if task["repeat"] else _plain(answer(result)))


def _time(run: Callable[[], Any], repeat: int) -> float:
    start = time.process_time_ns()
    for _ in range(repeat):
        run()
    return (time.process_time_ns() - start) / repeat


def _plain(answer: dict[str, Any]) -> dict[str, Any]:
    drive = np.asarray(answer["drive"], complex)
    return answer | {
        "drive": [drive.real.tolist(), drive.imag.tolist()],
        "positions": np.asarray(answer["positions"], float).tolist(),
    }


def _say(out: Any, message: dict[str, Any]) -> None:
    out.write(json.dumps(message) + "\n")
    out.flush()
