"""Probably wrong units cause one warning everywhere: scenes, files, Solvers, batches, planes, commands."""

import pickle
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import midair
from midair import _cli as cli

ARRAY = midair.Array.preset("paper20")
POINTS = np.array([[-0.02, 0, 0.15], [0.02, 0, 0.15]])


def received(call: Callable[[], object]) -> list[str]:
    """Returns the texts of the SceneWarnings of a call."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call()
    assert all(warning.category is midair.SceneWarning for warning in caught)
    return [str(warning.message) for warning in caught]


def scene(points: np.ndarray = POINTS, *pressures: list[float], **air: float) -> midair.Scene:
    return midair.Scene(ARRAY, points, *pressures, **air)


def batch(points: np.ndarray, **keywords: float) -> midair.Batch:
    return midair.solve_batch(ARRAY, points, solver="fast", **keywords)


#: Calls with a probably wrong unit, and the beginning of the warning.
SLIPS: dict[str, tuple[Callable[[], object], str]] = {
    "pitch": (lambda: midair.Scene(midair.Array.grid(9, 9, 1.05), POINTS), "array.grid.pitch is 1.05 m"),
    "points": (lambda: scene(POINTS * 1e3), "points[0].position is [-20, 0, 150] m (and 1 more)"),
    "frequency": (lambda: scene(frequency=40), "medium.frequency is 40 Hz"),
    "temperature": (lambda: scene(temperature=298), "medium.sound_speed is 479.1 m/s"),
    "sound speed": (lambda: scene(sound_speed=34e3), "medium.sound_speed is 34000 m/s"),
    "one place": (
        lambda: scene(POINTS[[0, 0]], [0.5, 0]),
        "points[0].pressure is 0.5 Pa, 0 m from points[1]",
    ),
    "plane": (lambda: midair.Plane(z=150, size=100), "plane.z is 150 m"),
    "plane's size": (lambda: midair.Plane(z=0.15, size=100), "plane.size is 100 m"),
    "plane's center": (lambda: midair.Plane(z=0.15, size=0.1, center=(0, 20)), "plane.center is 20 m"),
    "solver": (lambda: midair.Solver(ARRAY, "fast", frequency=40), "medium.frequency is 40 Hz"),
    "of a scene": (lambda: midair.Solver(scene(), frequency=40), "medium.frequency is 40 Hz"),
    "batch": (lambda: batch(POINTS[None], temperature=298), "medium.sound_speed is 479.1 m/s"),
    "its points": (
        lambda: batch(np.stack([POINTS, POINTS * 1e3])),
        "problems[1].points[0].position is [-20,",
    ),
}


LINE = [[-0.02, 0, 0.15], [0.02, 0, 0.15]]
SMALL = midair.Array.grid(8, 8, 0.01)
STILL = midair.path.still([0, 0, 0.1], duration=0.01)

SLIPS |= {
    "light bead": (
        lambda: scene(bead={"density": 0.029}),
        "bead.density is 0.029 kg/m^3: lighter than the air",
    ),
    "bead": (lambda: scene(bead={"radius": 1.0}), "bead.radius is 1 m: larger than the wavelength of 0.0085"),
    "time constant": (lambda: midair.sequence(SMALL, STILL, rate=1e3, tau=0.2), "tau is 0.2 s"),
    "of a skin": (
        lambda: midair.skin(midair.sequence(SMALL, STILL, rate=1e3), tau=0.2),
        "tau is 0.2 s, longer than of any transducer: give 0.0002 if ms are meant",
    ),
    "reach of a skin": (
        lambda: midair.skin(midair.sequence(SMALL, STILL, rate=1e3), reach=2),
        "reach is 2 m",
    ),
    "beside a shape": (lambda: midair.haptic(LINE, SMALL, rate=100, beside=14), "beside is 14 m"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_reported_once(slip: str) -> None:
    make, start = SLIPS[slip]
    (text,) = received(make)
    assert text.startswith(start)
    assert "give " in text
    assert "\n" not in text


def test_a_slip_of_an_array_is_reported_each_of_its_scenes() -> None:
    wide = midair.Array.grid(9, 9, 1.05)
    for _ in range(2):
        (text,) = received(lambda: midair.Scene(wide, POINTS))
        assert text.startswith("array.grid.pitch is 1.05 m")
    assert len(received(lambda: midair.Solver(wide, "fast"))) == 1
    assert received(lambda: midair.Scene(wide, POINTS, frequency=40)) != [text]


def test_a_slip_is_reported_each_object_once(tmp_path: Path) -> None:
    scenes: list[midair.Scene] = []
    received(lambda: scenes.append(midair.Scene(ARRAY, POINTS, frequency=40)))
    (odd,) = scenes
    path = tmp_path / "odd.toml"
    odd.save(path)
    # Making another scene warns again; using a scene does not.
    assert len(received(lambda: midair.Scene.load(path))) == 1
    assert len(received(lambda: midair.Scene.parse(path.read_text("utf-8")))) == 1
    midair.solve(odd, "naive")
    midair.Solver(odd, "naive")
    odd.replace(points=POINTS[:1])
    assert pickle.loads(pickle.dumps(odd)) == odd
    (text,) = received(lambda: odd.replace(density=1180))
    assert text.startswith("medium.density is 1180 kg/m^3")


def test_a_solver_tells_of_far_points_and_contrary_ones_once() -> None:
    solver = midair.Solver(ARRAY, "naive")
    assert received(lambda: solver(POINTS)) == []
    assert len(received(lambda: solver(POINTS * 1e3))) == 1
    assert received(lambda: solver(POINTS * 1e3)) == []
    (text,) = received(lambda: midair.Solver(ARRAY, "naive")(POINTS[[0, 0]], [2, 0]))
    assert text.startswith("points[0].pressure is 2 Pa")


def test_the_command_line_tells_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "odd.toml"
    path.write_text(
        "[array]\ngrid = { nx = 9, ny = 9, pitch = 10.5 }\n\n[[points]]\nposition = [0.0, 0.0, 0.15]\n"
        "\n[plane]\nz = 150\nsize = 0.1\n",
        encoding="utf-8",
    )
    with pytest.raises(SystemExit) as left:
        cli.main(["solve", str(path), "--solver", "naive"])
    assert left.value.code == 3
    reported = [line for line in capsys.readouterr().err.splitlines() if line.startswith("warning: ")]
    assert len(reported) == 2
    assert reported[0].startswith("warning: array.grid.pitch is 10.5 m: no neighbours within five wavelengths")
    assert reported[1].startswith("warning: plane.z is 150 m: give m (150 mm are 0.15 m)")


@pytest.mark.parametrize("shift", [0.0, 1e3])
def test_an_array_far_from_the_origin_is_as_precise(shift: float) -> None:
    positions, points = (places + np.array([shift, 0, 0]) for places in (ARRAY.positions, POINTS))
    exact = np.linalg.norm(points[:, None] - positions, axis=2)
    exact = np.exp(2j * np.pi * exact / 0.0085) * 1e-3 / exact
    got = midair.Scene(midair.Array(positions, source_pressure=1e-3), points).propagation()
    np.testing.assert_allclose(got, exact, atol=2e-4 * np.abs(exact).max())


def test_a_kilometre_away_is_refused() -> None:
    with pytest.raises(midair.SceneError, match=r"points\[0\].position is \[0.0, 0.0, 1000.0\]: bring it within"):
        midair.Scene(ARRAY, [[0, 0, 1e3]])
    apart = np.concatenate([ARRAY.positions, ARRAY.positions + np.array([0, 1e3, 0])])
    with pytest.raises(midair.SceneError, match=r"array.positions\[0\] is .*: bring it within"):
        midair.Scene(midair.Array(apart), POINTS)


def test_places_of_results_in_millimetres_have_a_warning() -> None:
    still = midair.Scene(ARRAY, [[0, 0, 0.1]])
    solution = midair.solve(still)
    moved = midair.sequence(ARRAY, midair.path.circle([0, 0, 0.1], 0.01, speed=0.5), rate=4e3)
    calls: dict[str, Callable[[], object]] = {
        "field points[1]": lambda: solution.field([[0, 0, 0.1], [0, 0, 100]]),
        "place": lambda: moved.felt([0, 0, 100]),
        'places["ear"]': lambda: midair.exposure(solution, {"ear": [0, 0, 100]}),
    }
    for item, call in calls.items():
        with pytest.warns(midair.SceneWarning, match="give m .100 mm are 0.1 m.") as found:
            call()
        assert [str(warning.message).startswith(f"{item} is [0, 0, 100] m") for warning in found] == [True]
        assert found[0].filename == __file__
