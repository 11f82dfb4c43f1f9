"""Plane waves, Bessel beams, and paths from G-code, against plain formulas in double precision."""

from pathlib import Path

import numpy as np
import pytest
from scipy.special import j0

import midair

ARRAY = midair.Array.grid(40, 40, 4e-3)
NUMBER = 2 * np.pi * 40e3 / 340


def pressure(drive: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Returns the pressures of point sources, a plain sum over the transducers."""
    r = np.linalg.norm(points[:, None] - ARRAY.positions, axis=2)
    return (np.exp(1j * NUMBER * r) / r) @ drive.astype(complex)


@pytest.mark.parametrize("direction", [[0, 0, 2.0], [0.3, -0.1, 1.0]])
def test_a_plane_wave_has_its_phase_along_the_direction(direction: list[float]) -> None:
    drive = midair.beam(ARRAY, direction)
    unit = np.array(direction) / np.linalg.norm(direction)
    assert drive == pytest.approx(np.exp(1j * NUMBER * ARRAY.positions @ unit), abs=1e-5)
    # Over 4 wavelengths around a place that the wave from the middle reaches, the edges are a small part.
    places = 0.04 * unit + np.linspace(-0.017, 0.017, 200)[:, None] * unit
    phase = np.unwrap(np.angle(pressure(drive, places)))
    slope = np.polyfit(places @ unit, phase, 1)[0]
    assert slope == pytest.approx(NUMBER, rel=0.02)


@pytest.mark.parametrize("angle", [0.2, 0.35])
def test_a_bessel_beam_is_a_bessel_function_along_its_axis(angle: float) -> None:
    drive = midair.beam(midair.Scene(ARRAY, [[0, 0, 0.1]]), [0, 0, 1], angle=angle)
    for height in (0.3, 0.5):
        rho = np.linspace(0, 2.0 / (NUMBER * np.sin(angle)), 20)
        z = height * 0.08 / np.tan(angle)
        found = np.abs(pressure(drive, np.column_stack([rho, 0 * rho, 0 * rho + z])))
        assert found / found[0] == pytest.approx(j0(NUMBER * np.sin(angle) * rho), abs=0.12)


def test_a_beam_leaves_out_what_is_off_and_keeps_channels() -> None:
    response = np.array([1, 0, 1j, -0.5])
    places = [[0.01 * i, 0, 0] for i in range(4)]
    drive = midair.beam(midair.Array(places, response=response, mask=[True, True, True, False]), [1, 0, 0])
    assert drive[[1, 3]].tolist() == [0, 0]
    assert drive[[0, 2]] == pytest.approx(np.exp(1j * NUMBER * np.array([0, 0.02])) * [1, -1j], abs=1e-5)
    wired = midair.beam(midair.Array(places, channels=[0, 0, 1, 1]), [1, 0, 0])
    expected = [np.exp(1j * NUMBER * x) for x in (0.005, 0.005, 0.025, 0.025)]
    assert wired * np.sign(np.cos(NUMBER * 0.005)) == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("keywords", "reported"),
    [
        ({"direction": [0, 0, 0]}, "direction is"),
        ({"direction": [0, 0, 1], "angle": 1.6}, "angle is 1.6: give an angle in rad below pi/2"),
        ({"direction": [0, 0, 1], "angle": -0.1}, "angle is -0.1"),
        ({"direction": [0, 0, 1], "apex": [0, 0]}, "apex is"),
    ],
)
def test_beams_that_are_none_are_refused(keywords: dict, reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.beam(ARRAY, **keywords)


def test_arcs_of_g_code_are_circles() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        centre, radius = rng.uniform(-20, 20, 2), rng.uniform(5, 30)
        begin, turn = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 6)
        sign = rng.choice([-1, 1])
        ends = [centre + radius * np.array([np.cos(a), np.sin(a)]) for a in (begin, begin + sign * turn)]
        arm = centre - ends[0]
        size = f"I{arm[0]:.6f} J{arm[1]:.6f}"
        if rng.random() < 0.5:
            size = f"R{np.sign(np.pi - turn) * radius:.6f}"
        program = f"G90 G21\nG0 X{ends[0][0]:.6f} Y{ends[0][1]:.6f} Z150 (start)\n"
        program += f"G{2 if sign < 0 else 3} X{ends[1][0]:.6f} Y{ends[1][1]:.6f} {size} F600 ; arc\n"
        path = midair.path.gcode(program, speed=0.1)
        assert path.duration == pytest.approx(radius * turn * 1e-3 / 0.1, rel=1e-3)
        part = np.linspace(0, 1, 50)
        angles = begin + sign * turn * part
        places = 1e-3 * np.column_stack(
            [centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles), np.full(50, 150)]
        )
        assert path.at(part * path.duration)[:, 0] == pytest.approx(places, abs=2e-5)


def test_lines_of_g_code(tmp_path: Path) -> None:
    program = "%\nN10 G20 G90\nG1 X1 Y0 Z0\nG91 Y.5\nx-1 z+.25\nM30\n%"
    (tmp_path / "a.gcode").write_text(program, "utf-8")
    inch = 25.4e-3
    path = midair.path.gcode(tmp_path / "a.gcode", speed=0.5 * inch, origin=[0, 0, 0.1])
    at = path.at([0.0, 1.0])[:, 0]
    assert at == pytest.approx(np.array([[inch, 0, 0.1], [inch, inch / 2, 0.1]]))
    ends = path.at([path.duration])[0, 0]
    assert ends == pytest.approx([0, inch / 2, 0.1 + inch / 4])


@pytest.mark.parametrize(
    ("program", "reported"),
    [
        ("G1 X1 Y1\nG28 X0\n", 'line 2 of the program is "G28 X0": G28 is unknown'),
        ("G1 X1 Y1\nG2 X5 Y5\n", "an arc needs its centre I and J, or its radius R"),
        ("G1 X0 Y0\nG2 X10 Y0 I4 J0\n", "its radius is 4 mm at first and 6 mm at last"),
        ("G1 X0 Y0\nG2 X10 Y0 R4\n", "no arc of this radius joins the places"),
        ("G1 X0 Y0\nG1 Xa\n", "give words of a letter and a number"),
        ("G21\nG90\n", "has fewer than two places"),
        ("G1 X0 Y0\nG2 X1e308 R1e308\n", "give numbers of at most 1e\\+09"),
        ("G1 X0 Y1E999\nG2 I10 Y20\n", "give numbers of at most 1e\\+09"),
        ("G1 X0 Y0\nG2 X0 Y0 I1e-300\n", "its radius is 1e-300 mm at first"),
        ("G1 X0 Y0\nG2 X5e-324 R1\n", "no arc of this radius joins the places"),
    ],
)
def test_g_code_that_is_no_path_is_refused(program: str, reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.path.gcode(program, speed=0.1)


#: Programs, and the places in mm that they name.
PROGRAMS = {
    "an exponent": ("G1 X1.2e-15 Y20\nG1 X10 Y20", [[0, 20, 0], [10, 20, 0]]),
    "relative": ("G91\nX10\nY10\nX-10\nY-10", [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]]),
    "its end": ("X0\nX10\nM30\nX99", [[0, 0, 0], [10, 0, 0]]),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_of_g_code_goes_where_a_machine_goes(name: str) -> None:
    program, places = PROGRAMS[name]
    path = midair.path.gcode(program, speed=0.01, origin=[0, 0, 0.1])
    closed = name == "relative"
    assert path.closed == closed
    corners = np.array(places) * 1e-3 + [0, 0, 0.1]
    ways = np.linalg.norm(np.diff(corners, axis=0, append=corners[:1] if closed else corners[-1:]), axis=1)
    assert path.duration == pytest.approx(ways.sum() / 0.01)
    at = path.frames(1e3)[0][:, 0]
    assert all(np.linalg.norm(at - corner, axis=1).min() < 2e-5 for corner in corners)


def test_a_first_arc_begins_at_zero() -> None:
    path = midair.path.gcode("G2 X20 Y0 I10\nG1 X20 Y5", speed=0.01)
    assert path.duration == pytest.approx((np.pi * 10 + 5) * 1e-3 / 0.01, rel=1e-3)


@pytest.mark.parametrize("program", [None, b"G1 X1", "G2 X0 Y0 I5 P3\nX1", "M98 P100\nX1 Y1\nX2"])
def test_what_is_no_program_gets_one_line(program: object) -> None:
    with pytest.raises(midair.SceneError) as caught:
        midair.path.gcode(program, speed=0.1)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_a_program_of_l_code_moves_points_frame_by_frame(tmp_path: Path) -> None:
    program = tmp_path / "two.lcode"
    program.write_text(
        "C5:WGS;\nC6:I200;\nC7;\nC11:200;\nL1:0.0,0.02,0.0:0,0,0.01;\nL1:0.01,0.01,0.0:0,0,0.02;# turn\n"
        "C3:10;\nL1:0.02,0.0,0.0:0,0,0.03;\nL4;\n",
        encoding="utf-8",
    )
    moved = midair.path.lcode(program, origin=[0, 0, 0.1])
    first = np.array([[0, 0.02, 0.1], [0, 0, 0.11]])
    step = np.array([[0.01, -0.01, 0], [0, 0, 0.01]])
    # C3 holds the second frame for 10 ms, two frames more.
    expected = [first, *[first + step] * 3, first + 2 * step]
    assert moved.frames(200)[0] == pytest.approx(np.array(expected[: len(moved.frames(200)[0])]), abs=1e-12)
    assert (moved.duration, moved.closed, moved.points) == (0.02, False, 2)
    assert midair.path.lcode(program, rate=100, closed=True).duration == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("program", "reported"),
    [
        ("C11:10;\nL0:0,0;\nL0:0,0,1;", 'line 2: "L0:0,0" is no point: give x,y,z in m'),
        ("C11:10;\nL0:0,0,1,x;\nL0:0,0,1;", 'line 2: column 4 is "x": give a finite number'),
        ("C11:10;\nL0:0,0,0;\nL2:0,0,1;", "has frames of L0 and L2"),
        ("L0:0,0,0;\nL0:0,0,1;", "rate is missing"),
        ("C11:5;\nfunction F0\nL0:0,0,0;\nend", 'line 2: "function F0" is not read'),
        ("C11:5;\nL0:0,0,0;\nL4;\nL0:0,0,0;", 'line 4: "L0:0,0,0" is not read'),
        ("C11:5;\nL0:0,0,0;\nC3:1e12;\nL0:0,0,0;", "the program has 5e\\+09 frames"),
        ("C11:5;\nL0:0,0,0;\nL0:0,0,0:1,1,1;", "M changes from 1 to 2 at frame 1"),
    ],
)
def test_l_code_that_is_no_path_is_refused(program: str, reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.path.lcode(program)
