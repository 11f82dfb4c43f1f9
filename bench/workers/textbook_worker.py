"""Times the greedy search in C++ through ctypes; the argument is the path of the compiled library."""

import ctypes
import sys
from typing import Any

import numpy as np
from serve import Prepared, serve

LIBRARY = ctypes.CDLL(sys.argv[1])
PHASES = 16
REAL = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
INT, DOUBLE = ctypes.c_int, ctypes.c_double
LIBRARY.greedy.argtypes = [INT, INT, REAL, REAL, REAL, DOUBLE, DOUBLE, INT, ctypes.c_uint, REAL]
LIBRARY.greedy.restype = None
LIBRARY.version.restype = ctypes.c_char_p


def prepare(task: dict[str, Any]) -> Prepared:
    positions, points, pressures = task["positions"], task["points"], task["pressures"]
    model = (task["source_pressure"], task["wavenumber"])
    drive = np.zeros((len(positions), 2))

    def run() -> np.ndarray:
        LIBRARY.greedy(len(positions), len(points), positions, points, pressures, *model, PHASES, task["seed"], drive)
        return drive

    return run, lambda drive: {"drive": drive @ [1, 1j], "positions": positions}


serve(f"C++ compiler {LIBRARY.version().decode()}", (f"greedy {PHASES} phases",), ("call",), prepare)
