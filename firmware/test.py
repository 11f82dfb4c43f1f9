"""Compares every method on the emulated board with this machine: bits of drives, sent bytes, allocations.

python3 firmware/test.py
"""

import sys

import emulated

#: Arrays, as N of a square grid or as a preset, and the board that plays each.
ARRAYS = (
    ("64", "mega64"),
    ("100", "sonicsurface"),
    ("144", "sonicsurface"),
    ("256", "sonicsurface"),
    ("ultraino_flat8x8", "mega64"),
    ("sonicsurface", "sonicsurface"),
)
POINTS = (1, 4, 8)
#: Solvers that allocate nothing after the first frame. `uniform` may: its number of steps depends on the
#: points.
STEADY = ("fast", "greedy", "naive")


def faults(target: emulated.Path, method: str, array: str, board: str, points: int) -> list[str]:
    """Returns the differences, one line each."""
    own = emulated.emulated(target, method, array, board, points)
    other = emulated.here(target, method, array, board, points)
    found = []
    if not own.drives or own.drives != other.drives:
        unlike = sum(a != b for a, b in zip(own.drives, other.drives, strict=False))
        found.append(f"{unlike} of {len(other.drives)} drives differ")
    if not own.line or own.line != other.line:
        found.append(f"the line's {len(own.line)} bytes are not the {len(other.line)} expected")
    if method in STEADY and own.numbers["allocations"] > 0:
        found.append(f"{own.numbers['allocations']} allocations after the first frame")
    return found


def main() -> None:
    target = emulated.build()
    cases = [(m, *array, points) for m in emulated.METHODS for array in ARRAYS for points in POINTS]
    # Greedy's 16 phases are not among the 10 of a MEGA64, so there it only solves grids without quantization.
    cases = [case for case in cases if case[:2] != ("greedy", "ultraino_flat8x8")]
    failed = 0
    for method, array, board, points in cases:
        for fault in faults(target, method, array, board, points):
            failed += 1
            print(f"{method}, {array} to {board}, {points} points: {fault}", file=sys.stderr)
    if failed:
        sys.exit(f"firmware: {failed} faults in {len(cases)} cases")
    print(f"firmware: {len(cases)} cases, drives and bytes those of this machine")


if __name__ == "__main__":
    main()
