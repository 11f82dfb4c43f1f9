"""Judging: comparison of solvers, exposure of people, streaming of air, faults."""
