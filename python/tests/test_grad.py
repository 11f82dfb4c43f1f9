"""`midair.grad`: shapes, conventions, arguments, error messages.
The core's tests compare the gradients with finite differences.
"""

import re
from typing import Any

import numpy as np
import pytest

import midair

ARRAY = midair.Array.grid(4, 3, 10e-3, directivity={"piston": 4.5e-3})
POINTS = np.array([[0.01, 0, 0.1], [-0.02, 0.01, 0.12]])
DRIVE = np.exp(1j * np.arange(12))


def scene(**keys: Any) -> midair.Scene:
    return midair.Scene(ARRAY, POINTS, **keys)


def test_values_are_those_of_the_field() -> None:
    field = midair.field(scene(), DRIVE, POINTS)
    assert midair.grad.pressure(scene(), DRIVE).value == pytest.approx(field.pressure, rel=1e-4)
    assert midair.grad.amplitude(scene(), DRIVE).value == pytest.approx(abs(field.pressure), rel=1e-4)
    assert midair.grad.radiation(scene(), DRIVE).value == pytest.approx(field.radiation, rel=1e-4)


def test_shapes_and_names_are_those_of_the_page() -> None:
    by = midair.grad.pressure(ARRAY, DRIVE, POINTS, [1, 2j])
    shapes = {"value": (2,), "drive": (12,), "points": (2, 3), "positions": (12, 3), "normals": (12, 3)}
    assert {name: part.shape for name, part in by._asdict().items() if name != "sound_speed"} == shapes
    assert isinstance(by.sound_speed, float)
    assert by.drive.dtype == by.value.dtype == np.complex128


def test_a_complex_gradient_is_the_direction_in_which_the_scalar_rises() -> None:
    by = midair.grad.amplitude(ARRAY, DRIVE, POINTS, [1, 0])
    step = 1e-6 * by.drive / abs(by.drive).max()
    moved = midair.grad.amplitude(ARRAY, DRIVE + step, POINTS).value[0]
    rise = float((by.drive.conj() * step).real.sum())
    assert moved - by.value[0] == pytest.approx(rise, rel=1e-4)
    # For L = Re(conj(w) p), the gradient by the drive is G^H w.
    matrix = scene().propagation().astype(complex)
    assert midair.grad.pressure(scene(), DRIVE, None, [1j, 2]).drive == pytest.approx(
        matrix.conj().T @ [1j, 2], rel=1e-3, abs=1e-3 * abs(matrix).max()
    )


def test_a_solution_stands_for_its_scene_and_drive() -> None:
    solution = midair.solve(scene())
    by = midair.grad.amplitude(solution)
    assert by.value == pytest.approx(abs(solution.pressures), rel=1e-4)
    again = midair.grad.amplitude(scene(), solution, POINTS, 1.0)
    assert all(np.array_equal(one, other) for one, other in zip(by, again, strict=True))


def test_a_wall_doubles_the_field_on_it() -> None:
    wall = midair.Wall([0.05, 0, 0], [1, 0, 0])
    on = [[0.05, 0, 0.1]]
    alone = midair.grad.amplitude(scene(), DRIVE, on)
    by = midair.grad.amplitude(scene(obstacles=[wall]), DRIVE, on)
    assert by.value == pytest.approx(2 * alone.value, rel=1e-9)
    assert by.drive == pytest.approx(2 * alone.drive, rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "refusal"),
    [
        ({"drive": DRIVE[:3]}, "drive is 3 values: give one for each of the 12 transducers"),
        ({"drive": None}, "drive is None: give one (N,)"),
        ({"points": None}, "points is None: give them beside an Array: (M, 3) in m"),
        ({"points": [[0, 0, np.nan]]}, "points[0]"),
        ({"points": ARRAY.positions[:1]}, "points[0] is 0.000e0 m from transducer 0"),
        ({"cotangent": [1, 2, 3]}, "cotangent is of shape (3,): give one"),
        ({"cotangent": [1j, 1]}, "cotangent is "),
        ({"cotangent": None}, "cotangent is None: give dL by the value at each point"),
        ({"cotangent": [np.inf, 1]}, "cotangent[0] is inf: give finite numbers"),
    ],
)
def test_bad_arguments_are_refused_by_name(arguments: dict[str, Any], refusal: str) -> None:
    given = {"drive": DRIVE, "points": POINTS, **arguments}
    with pytest.raises(midair.SceneError, match=f"^{re.escape(refusal)}"):
        midair.grad.amplitude(ARRAY, **given)


def test_a_body_is_refused_and_a_slip_is_hinted_at() -> None:
    ball = midair.Sphere([0, 0, 0.2], 0.01)
    with pytest.raises(midair.SceneError, match=r"^obstacles\[0\] is a sphere: gradients are known beside"):
        midair.grad.amplitude(scene(obstacles=[ball]), DRIVE)
    with pytest.raises(TypeError, match="did you mean cotangent"):
        midair.grad.amplitude(scene(), DRIVE, cotangents=1)  # type: ignore[call-arg]


def test_a_particle_feels_what_gorkov_computes() -> None:
    bead = midair.Bead(radius=0.8e-3, density=50)
    felt = midair.gorkov(scene(), DRIVE, bead=bead)

    def near(found: Any, expected: Any) -> bool:
        # `gorkov` rounds the drive to single precision.
        return bool(abs(found - expected).max() < 1e-5 * abs(expected).max())

    assert near(midair.grad.gorkov(scene(), DRIVE, bead=bead).value, felt.potential)
    assert near(midair.grad.force(scene(), DRIVE, bead=bead).value, felt.force)
    assert near(midair.grad.stiffness(scene(), DRIVE, bead=bead).value, felt.stiffness)
    # By default the bead is the scene's.
    assert near(midair.grad.force(scene().replace(bead=bead), DRIVE).value, felt.force)
    # dF_x/dx is minus the stiffness.
    along = midair.grad.force(scene(), DRIVE, None, [[1, 0, 0], [1, 0, 0]], bead=bead)
    assert near(along.points[:, 0], -felt.stiffness[:, 0])
    with pytest.raises(midair.SceneError, match=r"^bead.radius is 0"):
        midair.grad.force(scene(), DRIVE, bead={"radius": 0})
    with pytest.raises(midair.SceneError, match=r"^cotangent is of shape \(3,\): give one real"):
        midair.grad.force(scene(), DRIVE, None, [1, 0, 0])
