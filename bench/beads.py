"""Beads beside a camera: resonances and ring-downs of a bead as midair predicts them, beside published ones.

    python bench/beads.py

The lines are those of the table in docs/beads.md.
"""

import numpy as np

import midair

BOARDS = midair.Array.preset("openmpd_pair")
SCENE = midair.Scene(BOARDS, [[0, 0, 0]], signature="trap", temperature=25)
#: Voltage, measured resonances along x, y and z in Hz.
MEASURED = [(18, (83.5, 82.0, 289.0)), (15, (72.6, 70.8, 251.0))]
#: Voltage of the preset's pressure.
FULL = 20.0


def ring_down(axis: int, start: float, share: float) -> float:
    """Returns the time in s in which a bead swings a factor of e less, at a part of the pressure."""
    boards = midair.Array.preset("openmpd_pair", source_pressure=share * BOARDS.source_pressure)
    still = midair.path.from_array(np.zeros((10, 1, 3)), rate=1000, closed=True)
    sequence = midair.sequence(boards, still, rate=1000, signature="trap", temperature=25)
    rest = midair.fly(sequence, duration=0.01).places[0, 0]
    begin = rest + start * np.eye(3)[axis]
    flight = midair.fly(sequence, beads=[begin], speeds=[[0, 0, 0]], duration=0.3)
    swing = flight.places[:, 0, axis] - rest[axis]
    # The energy of the swing, by its mean square in two windows.
    first, last = (np.sqrt(np.mean(swing[part] ** 2)) for part in np.array_split(np.arange(len(swing)), 6)[1:5:3])
    between = 3 * flight.times[-1] / 6
    return float(between / np.log(first / last))


def row(quantity: str, measured: float, found: float, unit: str) -> str:
    return f"| {quantity} | {measured:g} {unit} | {found:.3g} {unit} | {100 * (found / measured - 1):+.0f} % |"


if __name__ == "__main__":
    frequencies = midair.solve(SCENE).rest().frequencies[0]
    for voltage, measured in MEASURED:
        for axis, name in enumerate("xyz"):
            found = frequencies[axis] * voltage / FULL
            print(row(f"resonance along {name}, {voltage} V", measured[axis], found, "Hz"))
    ratio = (frequencies[2] / frequencies[:2].mean()) ** 2
    print(row("axial over lateral stiffness (11 to 13.8)", 12.4, ratio, ""))
    for axis, measured in ((0, 40.0), (2, 87.0)):
        share = MEASURED[0][1][axis] / frequencies[axis]
        found = 1e3 * ring_down(axis, 2e-5, share)
        print(row(f"ring-down along {'xyz'[axis]}, at the measured resonance", measured, found, "ms"))
