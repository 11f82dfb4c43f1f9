"""Measures how many training scenes a CPU core makes in a second: adds a line to bench/records/dataset.csv.

The request is docs/sweeps/dataset.toml with a tenth of its trials, made by `midair.dataset`. The time is
CPU time of the process with all its threads, so other work on the machine does not count.
"""

import platform
import resource
import tempfile
import tomllib
from datetime import date
from pathlib import Path

import numpy as np

import midair

ROOT = Path(__file__).parents[1]
RECORD = ROOT / "bench" / "records" / "dataset.csv"


def seconds() -> float:
    """Returns the CPU time of this process in s."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Makes the scenes and writes the line."""
    request = tomllib.loads((ROOT / "docs" / "sweeps" / "dataset.toml").read_text())
    request["seeds"] //= 10
    began = seconds()
    with tempfile.TemporaryDirectory() as folder:
        made = midair.dataset(request, Path(folder, "scenes"))
        spent = seconds() - began
        rows = made.manifest["scenes"]
        accuracy = np.mean(np.concatenate([part["accuracy"] for part in made.read()]))
    if not RECORD.exists():
        RECORD.write_text("date,cpu,version,solver,scenes,cpu_s,scenes_per_second_per_core,accuracy\n")
    line = [date.today(), platform.machine(), midair.__version__, request["solver"]["name"], rows]
    with RECORD.open("a") as file:
        file.write(",".join(map(str, line)) + f",{spent:.2f},{rows / spent:.0f},{accuracy:.4f}\n")
    print(f"{rows} scenes, {rows / spent:.0f} per second and core, mean accuracy {accuracy:.4f}")


if __name__ == "__main__":
    main()
