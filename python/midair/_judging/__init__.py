"""Judging: solvers compared, exposure, streaming, and what faults of array and air leave of a solution."""
