"""Compares midair with other programs in one run: `make bench-peers`. bench/README.md explains the method."""

import argparse
import datetime
import math
import os
import random
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np
import record
from rivals import BENCH, RIVALS, TASKS, Task, Worker, oracle

import midair

sys.path.append(str(Path(__file__).resolve().parents[1] / "book"))
from marked import put

#: The metrics of a record.
QUALITY = ("accuracy", "sigma", "uniformity")
PLACE = 1e-6  # m, the largest allowed difference of positions
CLAIM = 1e-3  # the largest allowed difference of judged metrics from reported ones


class Effort(NamedTuple):
    """The amount of work: rounds, scenes judged, least CPU time of one measurement, largest M."""

    rounds: int = 9
    scenes: int = 10
    least: float = 50e6  # ns
    most: int = 256


QUICK = Effort(rounds=3, scenes=3, least=10e6, most=64)


@dataclass
class Entry:
    """One program's method on one task, with its measurements and judged results."""

    worker: Worker
    task: Task
    method: str
    form: str
    times: list[float] = field(default_factory=list)
    answers: list[dict[str, float]] = field(default_factory=list)
    repeat: int = 1

    def __str__(self) -> str:
        size = f"N = {len(self.task.array)}, M = {self.task.count}"
        return f"{self.worker.name} {self.method} ({self.form}), {size}, grid: {self.task.grid}"

    def ask(self, scene: int, repeat: int) -> dict[str, Any]:
        request = {"method": self.method, "form": self.form, "repeat": repeat}
        return self.worker.ask(self.task.request(scene) | request)

    def judge(self, scene: int) -> None:
        """Judges the result for a scene by our forward model.

        A wrong position or a wrong reported metric ends the run.
        """
        answer, points = self.ask(scene, 0), self.task.points(scene)
        apart = np.abs(np.array(answer["positions"]) - self.task.array.positions).max()
        if not apart <= PLACE:
            raise SystemExit(f"{self}: transducers are {apart:.1e} m from where they should be")
        re, im = np.array(answer["drive"])
        found = oracle.metrics(np.abs(self.task.propagation(points) @ (re + 1j * im)), self.task.targets)
        for name, reported in answer.get("metrics", {}).items():
            if not abs(reported - found[name]) <= CLAIM:
                both = f"reports {name} {reported:.6f}, judged {found[name]:.6f}"
                raise SystemExit(f"{self}, scene {scene}: {both}")
        self.answers.append(found)

    def measure(self) -> None:
        """Measures once, with enough calls that the clock's resolution does not matter."""
        self.times.append(self.ask(0, self.repeat)["ns"])

    def calibrate(self, least: float) -> None:
        self.repeat = max(1, math.ceil(least / self.ask(0, 1)["ns"]))

    def row(self, date: str, rounds: int, cpu: str) -> record.Row:
        quality = {name: f"{np.mean([a[name] for a in self.answers]):.6f}" for name in QUALITY}
        return {
            "date": date,
            "cpu": cpu,
            "rival": self.worker.name,
            "version": self.worker.version,
            "method": self.method,
            "form": self.form,
            "N": str(len(self.task.array)),
            "M": str(self.task.count),
            "grid": self.task.grid,
            "rounds": str(rounds),
            "ns_median": f"{median(self.times):.0f}",
            "ns_min": f"{min(self.times):.0f}",
            "scenes": str(len(self.answers)),
            **quality,
        }


#: The setting of the GS-PAT paper (Plasencia et al., ACM Trans. Graphics 39(4), 138, 2020): 32 points, solved
#: again and again, on all cores. It reports 17,000 solutions per second on a GTX 1660. We do not know the
#: size of their array, and use the pair of OpenMPD boards, 512 transducers.
OWN = ("fast", "uniform")
POINTS = 32
PROBLEMS = 3000
HALF = 0.05  # m, half the side of the cube of points


def timed(array: midair.Array, method: str) -> Callable[[], float]:
    """Returns a function that measures the wall time per solution in ns."""
    middle = np.mean(array.positions, axis=0)
    points = middle + np.random.default_rng(POINTS).uniform(-HALF, HALF, (PROBLEMS, POINTS, 3))

    def measure() -> float:
        begin = time.perf_counter_ns()
        midair.solve_batch(array, points, solver=method)
        return (time.perf_counter_ns() - begin) / PROBLEMS

    return measure


def batches(common: dict[str, str], rounds: int) -> list[dict[str, str]]:
    """Returns a row per method, measured in turns; `common` has the columns that all rows share."""
    array = midair.Array.preset("openmpd_pair")
    measures = {method: timed(array, method) for method in OWN}
    times = [[measure() for measure in measures.values()] for _ in range(rounds + 1)][1:]
    cores = len(os.sched_getaffinity(0))
    return [
        common
        | {
            "rival": "midair",
            "version": midair.__version__,
            "method": method,
            "form": f"batch, {cores} cores",
        }
        | {"grid": "board", "N": str(len(array)), "M": str(POINTS), "rounds": str(rounds)}
        | {"ns_median": f"{median(own):.0f}", "ns_min": f"{min(own):.0f}"}
        for method, own in zip(OWN, zip(*times, strict=True), strict=True)
    ]


def entries(workers: list[Worker], most: int) -> Iterator[Entry]:
    for task in TASKS:
        for worker in workers:
            if task.count > most or worker.name not in task.rivals:
                continue
            for method in (method for method in task.methods if method in worker.methods):
                for form in worker.forms:
                    yield Entry(worker, task, method, form)


def run(workers: list[Worker], effort: Effort) -> list[record.Row]:
    """Judges every result, then measures in rounds, each in another order."""
    work = list(entries(workers, effort.most))
    for entry in work:
        for scene in range(effort.scenes):
            entry.judge(scene)
    print(f"{len(work)} entries judged on {effort.scenes} scenes each", flush=True)
    for entry in work:
        entry.calibrate(effort.least)
    shuffle = random.Random(0).shuffle
    for number in range(effort.rounds):
        order = list(work)
        shuffle(order)
        for entry in order:
            entry.measure()
        print(f"round {number + 1} of {effort.rounds}", flush=True)
    date, cpu = datetime.date.today().isoformat(), record.cpu()
    own = batches({"date": date, "cpu": cpu}, effort.rounds)
    return [entry.row(date, effort.rounds, cpu) for entry in work] + own


def start(stack: ExitStack) -> list[Worker]:
    workers = []
    for rival in RIVALS:
        if rival.needs.exists():
            workers.append(stack.enter_context(Worker(rival)))
        else:
            print(f"{rival.name} is left out: {rival.cure}", flush=True)
    return workers


def keep(rows: list[record.Row]) -> None:
    """Writes the record; also the pages' tables, if the run includes the program to which they refer."""
    path = BENCH / "records" / f"{rows[0]['date']}.csv"
    record.write(path, rows)
    print(f"wrote {path.relative_to(BENCH.parent)}")
    if record.REFERENCE in {row["rival"] for row in rows}:
        for page, table in record.tables(rows).items():
            put(BENCH.parent / page, "bench", table)
            print(f"wrote the table of {page}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=Effort.rounds, help="measurements of each entry")
    parser.add_argument("--quick", action="store_true", help="a look: no record, no tables")
    options = parser.parse_args()
    effort = QUICK if options.quick else Effort(rounds=options.rounds)
    with ExitStack() as stack:
        rows = run(start(stack), effort)
    print(record.table(rows))
    if not options.quick:
        keep(rows)


if __name__ == "__main__":
    main()
