"""Measures how many training scenes a CPU core makes in a second: adds a line to bench/records/dataset.csv.

The request is docs/sweeps/dataset.toml with a tenth of its trials, made by `midair.dataset`. The time is
CPU time of the process with all its threads, so other work on the machine does not count.
"""

import tempfile
import time
import tomllib
from pathlib import Path

import numpy as np

import midair
import record

ROOT = Path(__file__).parents[1]


def main() -> None:
    """Makes the scenes and writes the line."""
    request = tomllib.loads((ROOT / "docs" / "sweeps" / "dataset.toml").read_text("utf-8"))
    request["seeds"] //= 10
    began = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        made = midair.dataset(request, Path(folder, "scenes"))
        spent = time.process_time() - began
        rows = made.manifest["scenes"]
        accuracy = np.mean(np.concatenate([part["accuracy"] for part in made.read()]))
    row = {"solver": request["solver"]["name"], "scenes": rows, "cpu_s": f"{spent:.2f}"}
    speed = {"scenes_per_second_per_core": f"{rows / spent:.0f}", "accuracy": f"{accuracy:.4f}"}
    record.add("dataset.csv", [row | speed])
    print(f"{rows} scenes, {rows / spent:.0f} per second and core, mean accuracy {accuracy:.4f}")


if __name__ == "__main__":
    main()
