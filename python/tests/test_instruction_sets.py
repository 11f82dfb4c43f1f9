"""Instruction sets: MIDAIR_SIMD applies to fields and matrices,
and scalar results have the same bits everywhere.
"""

import hashlib
import os
import subprocess
import sys

import pytest

#: The program writes field, matrix G and balanced level of a small scene of pistons in absorbing air. The
#: numbers of the drive are exact in f32.
PROGRAM = """
import sys, midair, numpy as np
array = midair.Array.grid(6, 5, 0.01, directivity={"piston": 4.5e-3})
points = [[-0.021, 0.004, 0.15], [0.019, 0.013, 0.12], [0.003, -0.022, 0.1]]
scene = midair.Scene(array, points, absorption=0.15)
drive = np.tile([1, 0.5j, -0.75, -0.25j, 0.5 + 0.5j], 6)
field = midair.field(scene, drive, midair.Plane(0.12, 0.08, pixels=9))
for part in (field.pressure, scene.propagation(), scene.reach().level):
    sys.stdout.buffer.write(part.tobytes())
"""

#: Lengths in bytes of field and matrix (complex64) and balanced level (float64). SCALAR is the SHA-256 of all
#: three with the scalar instruction set.
FIELD, MATRIX, LEVEL = 8 * 9 * 9, 8 * 3 * 30, 8 * 3
SCALAR = "ffdee22d794383aafcce622de651e53c27612f6d114784c60c1fe54d0caea883"


def run(**environment: str) -> subprocess.CompletedProcess[bytes]:
    outside = {name: value for name, value in os.environ.items() if name != "MIDAIR_SIMD"}
    command = [sys.executable, "-c", PROGRAM]
    return subprocess.run(command, env=outside | environment, capture_output=True, check=False)


def refusal() -> str:
    done = run(MIDAIR_SIMD="avx9")
    assert done.returncode == 1
    return done.stderr.decode().splitlines()[-1]


@pytest.mark.slow
def test_an_unknown_instruction_set_is_refused_in_one_line() -> None:
    assert "MIDAIR_SIMD is avx9: this machine has scalar" in refusal()


@pytest.mark.slow
def test_the_scalar_set_gives_the_bits_that_it_gives_everywhere() -> None:
    done = run(MIDAIR_SIMD="scalar")
    assert (done.returncode, len(done.stdout)) == (0, FIELD + MATRIX + LEVEL)
    assert hashlib.sha256(done.stdout).hexdigest() == SCALAR


@pytest.mark.slow
def test_another_instruction_set_gives_other_bits_of_both() -> None:
    *_, known = refusal().partition(" has ")
    best = known.split(", ")[-1]
    if best == "scalar":
        pytest.skip("this machine has only the scalar set")
    scalar, left_out, named = run(MIDAIR_SIMD="scalar"), run(), run(MIDAIR_SIMD=best)
    assert left_out.stdout[:FIELD] != scalar.stdout[:FIELD]
    assert left_out.stdout[FIELD:-LEVEL] != scalar.stdout[FIELD:-LEVEL]
    assert named.stdout == left_out.stdout
