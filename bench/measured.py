"""Compares the model and `midair.calibrate` with published measurements: `make measured DATA=folder`.

The folder is a clone of github.com/DigitalNatureGroup/insitu_optimization (research only: midair has no copy
of it), the data of Fushimi et al. 2024, Communications Engineering, 10.1038/s44172-024-00160-0. A board of
256 transducers with 32 phases plays 180 drives. A microphone 40 mm above its middle gives amplitude and
phase. The authors recorded each drive one step of their search later than it was played.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import midair

PLACE = [[0.0, 0.0, 0.04]]
#: Number of phases of the board, and their distance in rad.
PHASES = 32
#: Readings that are predicted, of all; how often they are drawn.
NEW, TRIALS = 40, 10
#: The authors' searches: for phases, for amplitudes, for both.
SETTINGS = ("i", "ii", "iii")
Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def complex_of(data: Path, name: str, modulus: str, phase: str) -> Complex:
    """Returns the complex readings of two files."""
    amplitudes, phases = (np.loadtxt(data / name.format(part)) for part in (modulus, phase))
    return np.asarray(amplitudes * np.exp(1j * phases))


def scatter(folder: Path) -> tuple[float, float]:
    """Returns the standard deviations of |p| and of p over three readings of 60 drives, relative to p."""
    name = "step3_compare_A{}_numerical2experiment_{{}}_{}_try.csv"
    read = np.array(
        [[complex_of(folder / "experiment_data", name.format(a, k), "amp", "pha") for a in SETTINGS] for k in range(3)]
    )
    size = np.sqrt(np.mean(np.abs(read) ** 2))
    moduli, values = (np.sqrt(np.var(each, axis=0, ddof=1).mean()) for each in (np.abs(read), read))
    return float(moduli / size), float(values / size)


def measured(folder: Path) -> tuple[midair.Scene, Complex, Complex]:
    """Returns the scene of the authors' parameters, the drives (180, 256) and the readings (180,) in Pa."""
    at = np.transpose([np.loadtxt(folder / f"trans_{axis}.csv").ravel() for axis in "xyz"])
    array = midair.Array(at, directivity={"piston": 5e-3}, source_pressure=0.31001 * 5)
    phases, readings, data = [], [], folder / "experiment_data"
    for setting in SETTINGS:
        for k in range(3):
            final = f"step4_target_A{setting}_optimized_final_{{}}_{k}_try.csv"
            readings.append(complex_of(data, final, "amplitude", "phase"))
            for n in range(20):
                record = f"step4_optimize_match_target_A{setting}_N_{n}_pat_phase_record_{k}_try.csv"
                phases.append(np.loadtxt(data / record, delimiter=",").ravel())
    codes = np.round(np.array(phases) * PHASES / (2 * np.pi))
    scene = midair.Scene(array, PLACE, sound_speed=346.0)
    return scene, np.exp(2j * np.pi * codes / PHASES), np.concatenate(readings)


def error(predicted: Complex, read: Complex, known: NDArray[np.intp], new: NDArray[np.intp]) -> Real:
    """Returns the errors of new |p| and of new p, relative to their root mean square.

    One factor, of |p| or of p, is fitted to the known readings: the microphone's sensitivity and its clock.
    """

    def off(p: Complex, truth: Complex) -> float:
        factor = np.vdot(p[known], truth[known]) / np.vdot(p[known], p[known])
        return float(np.linalg.norm(factor * p[new] - truth[new]) / np.linalg.norm(truth[new]))

    return np.array([off(np.abs(predicted), np.abs(read)), off(predicted, read)])


def main(folder: Path) -> None:
    """Prints the errors of the model and of the calibrated array."""
    warnings.simplefilter("ignore", midair.SceneWarning)
    scene, drives, read = measured(folder)
    model = drives @ scene.propagation()[0]
    print(f"{len(drives)} drives: correlation of |p| {np.corrcoef(abs(model), abs(read))[0, 1]:.3f}")
    moduli, values = scatter(folder)
    print(f"three readings of a drive: standard deviation of |p| {moduli:.1%}, of p {values:.1%}")
    for count in (140, 70, 35):
        errors = []
        for trial in range(TRIALS):
            order = np.random.default_rng(trial).permutation(len(drives))
            new, known = order[:NEW], order[NEW : NEW + count]
            row = [error(model, read, known, new)]
            for values in (read, np.abs(read)):
                found = midair.calibrate(scene, drives[known], values[known, None])
                fitted = found.scene.replace(points=found.microphones).propagation()[0]
                row.append(error(drives @ fitted, read, known, new))
            errors.append(np.ravel(row))
        low, mean, high = 100 * np.array([np.min(errors, 0), np.mean(errors, 0), np.max(errors, 0)])
        for k, name in enumerate(("model", "complex readings", "|p| alone")):
            j = 2 * k
            p = f"|p| {mean[j]:.1f} % ({low[j]:.1f} to {high[j]:.1f} %), p {mean[j + 1]:.1f} %"
            print(f"{count} readings, {name}: errors of {NEW} new drives: {p}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
