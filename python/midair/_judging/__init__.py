"""Judging: solvers compared, exposure, streaming, and the effects of faults of array and air."""
