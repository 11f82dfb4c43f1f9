"""`midair.exposure`: levels against plain NumPy, the loudest place of a box against other places,
and the published limits by their names.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import midair
from midair import _cli as cli
from midair._judging.exposure import LIMITS

ARRAY = midair.Array.grid(12, 10, 10e-3)
SCENE = midair.Scene(ARRAY, [[-0.02, 0.01, 0.15], [0.03, 0, 0.16]])


def moduli(drive: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Returns |p| (P,) in Pa by eq. (5) in float64."""
    distance = np.linalg.norm(points[:, None] - ARRAY.positions, axis=2)
    return np.abs((4.386 / distance * np.exp(2j * np.pi * 40e3 / 340 * distance)) @ drive)


def spl(pressure: np.ndarray) -> np.ndarray:
    return 20 * np.log10(pressure / np.sqrt(2) / 20e-6)


def test_levels_at_places_are_those_of_numpy() -> None:
    solution = midair.solve(SCENE)
    places = {"left ear": [-0.08, 0.1, 0.4], "right ear": [0.08, 0.1, 0.4]}
    found = midair.exposure(SCENE, solution, places)
    expected = spl(moduli(solution.drive, np.array(list(places.values()))))
    np.testing.assert_allclose([place.spl for place in found.places], expected, atol=1e-3)
    assert found["left ear"].position == (-0.08, 0.1, 0.4)
    assert found.worst == max(found.places, key=lambda place: place.spl)
    assert found.above == tuple(place.name for place in found.places if place.spl > 110)
    over = found.to_dict()["over"]
    np.testing.assert_allclose(over, expected - 110, atol=1e-3)
    assert "howard" in repr(found)
    assert "Hansen" in found._repr_html_()
    (axes,) = found.plot().axes
    dots = [line.get_xdata()[0] for line in axes.lines]
    np.testing.assert_allclose(dots, [place.spl for place in found.places] + [110])
    assert [line.get_color() == "tab:orange" for line in axes.lines[:-1]] == [p.spl > 110 for p in found.places]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["left ear", "right ear"]


@pytest.mark.slow
def test_the_worst_of_a_box_is_within_2_db_of_400_places_kept_out() -> None:
    random = np.random.default_rng(3)
    focused = midair.solve(SCENE).drive
    for trial in range(40):
        low = random.uniform([-0.1, -0.1, 0.03], [0.1, 0.1, 0.5])
        high = low + random.uniform(0.003, 0.04, 3)
        drive = focused if trial % 2 else np.exp(2j * np.pi * random.random(120))
        found = midair.exposure(SCENE, drive, {"box": [high, low]}).worst
        others = spl(moduli(drive, random.uniform(low, high, (400, 3)))).max()
        # No place is louder than the reported level, and the reported place has that level.
        assert others < found.spl + 0.05
        assert others > found.spl - 6
        place = np.array([found.position])
        assert ((place >= low - 1e-12) & (place <= high + 1e-12)).all()
        assert spl(moduli(drive, place))[0] == pytest.approx(found.spl, abs=2e-3)


@pytest.mark.parametrize("flat", [[], [2], [0, 2]], ids=["box", "plane", "line"])
def test_a_focus_in_a_box_is_found_where_it_is(flat: list[int]) -> None:
    point = np.array([0.013, -0.021, 0.2])
    scene = midair.Scene(ARRAY, [point])
    drive = midair.solve(scene, "naive").drive
    box = np.array([[-0.03, -0.02, 0], [0.017, 0.05, 0.04]]) + point
    box[:, flat] = point[flat]
    found = midair.exposure(scene, drive, {"box": box}).worst
    assert found.spl >= spl(moduli(drive, point[None]))[0] - 0.01
    np.testing.assert_allclose(found.position[:2], point[:2], atol=2e-3)


def test_an_ear_is_the_box_about_its_points() -> None:
    drive = midair.solve(SCENE).drive
    ear = midair.ear([0, 0.08, 0.3], size=0.03)
    corners = [[-0.015, 0.065, 0.285], [0.015, 0.095, 0.315]]
    one, other = (midair.exposure(SCENE, drive, {"ear": place}).worst for place in (ear, corners))
    assert one.spl == pytest.approx(other.spl, abs=1e-3)
    assert one.spl >= ear.spl(SCENE, drive) - 1e-3


@pytest.mark.slow
def test_a_sequence_has_its_loudest_frame() -> None:
    ring = midair.path.circle([0, 0, 0.15], 0.02, speed=0.5, points=1)
    sequence = midair.sequence(ARRAY, ring.frames(2e3)[0][:40], rate=2e3)
    places = {"eye": [0.05, 0.05, 0.3], "box": [[0.05, 0, 0.2], [0.06, 0.02, 0.21]]}
    found = midair.exposure(sequence.scene(0), sequence, places)
    levels = np.array([spl(moduli(drive, np.array([[0.05, 0.05, 0.3]])))[0] for drive in sequence.drives])
    assert found["eye"].spl == pytest.approx(levels.max(), abs=1e-3)
    assert found["eye"].frame == levels.argmax()
    others = np.random.default_rng(0).uniform(*places["box"], (400, 3))
    loudest = max(spl(moduli(drive, others)).max() for drive in sequence.drives)
    assert loudest < found["box"].spl + 0.05
    with pytest.raises(midair.SceneError, match="another array"):
        midair.exposure(midair.Scene(midair.Array.grid(2, 2, 0.01), [[0, 0, 0.1]]), sequence, places)


def test_limits_are_named_with_their_source() -> None:
    drive = midair.solve(SCENE).drive
    place = {"here": [0, 0, 0.5]}
    levels = {name: midair.exposure(SCENE, drive, place, limit=name).limit.spl for name in LIMITS}
    assert levels == {"howard": 110, "acgih": 115, "acgih air": 145, "irpa": 100}
    assert all(limit.source for limit in LIMITS.values())
    assert midair.exposure(SCENE, drive, place, limit="ACGIH-air").limit.spl == 145
    assert midair.exposure(SCENE, drive, place, limit=120).limit.spl == 120
    with pytest.raises(midair.SceneError, match='"howard" is for 25 to 50 kHz, not 60 kHz'):
        midair.exposure(SCENE.replace(frequency=60e3), drive, place)


def test_silence_is_no_number_above_any_limit() -> None:
    found = midair.exposure(SCENE, np.zeros(120), {"here": [0, 0, 0.5], "box": [[0, 0, 0.5], [0.01, 0, 0.5]]})
    assert [place.spl for place in found.places] == [-np.inf] * 2
    assert found.above == ()


@pytest.mark.parametrize(
    ("places", "reported"),
    [
        ({}, "places is {}: give a dict"),
        ([[0, 0, 1]], "places is "),
        ({"ear": [0, 0]}, r'places\["ear"\]'),
        ({"ear": [0, 0, float("nan")]}, r'places\["ear"\]'),
        ({"ear": [[0, 0, 0.1], [0, 0, float("inf")]]}, r'places\["ear"\]'),
        ({3: [0, 0, 1]}, "give names as text"),
        ({"room": [[-1, -1, 0.1], [1, 1, 2]]}, r'places\["room"\] is .* points'),
        (
            {"hand": [[-0.01, -0.01, 0.001], [0.01, 0.01, 0.1]]},
            r"is a box 1 mm from transducer \d+: give",
        ),
        ({"chip": ARRAY.positions[7]}, r'places\["chip"\] is 0 mm from transducer 7: give .* 0\.085 mm'),
        ({"chip": ARRAY.positions[7] + [8e-5, 0, 0]}, "is 0.08 mm from transducer 7"),
    ],
)
def test_bad_places_are_refused(places: object, reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.exposure(SCENE, np.ones(120), places)


def test_a_position_a_hundredth_of_a_wavelength_away_is_answered() -> None:
    near = ARRAY.positions[7] + [0, 0, 8.6e-5]
    assert np.isfinite(midair.exposure(SCENE, np.ones(120), {"chip": near}).worst.spl)
    still = midair.sequence(ARRAY, np.array([[[0, 0, 0.1]]] * 3), rate=1000)
    with pytest.raises(midair.SceneError, match=r'places\["chip"\] is 0 mm from transducer 7'):
        midair.exposure(still.scene(0), still, {"chip": ARRAY.positions[7]})


def test_bad_limits_are_refused() -> None:
    for limit in ("none", float("nan"), True):
        with pytest.raises(midair.SceneError, match="limit is"):
            midair.exposure(SCENE, np.ones(120), {"here": [0, 0, 0.5]}, limit=limit)


def test_a_place_behind_every_transducer_is_a_warning() -> None:
    solution = midair.solve(midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]]))
    with pytest.warns(midair.SceneWarning, match=r'places\["wall"\] is behind every transducer'):
        midair.exposure(solution, {"ear": [0, 0, 0.3], "wall": [[-0.02, 0, -0.3], [0.02, 0.01, -0.29]]})


def test_places_without_a_drive_are_an_error_that_shows_the_call() -> None:
    scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15]])
    with pytest.raises(midair.SceneError, match=r"give exposure\(scene, solution, places\)"):
        midair.exposure(scene, {"ear": [0, 0, 0.3]})


def test_silence_and_open_bands_are_null_in_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.toml"
    array = midair.Array.grid(2, 2, 0.01, directivity="piston")
    midair.Scene(array, [[0, 0, 0.1]]).save(path)
    command = ["exposure", str(path), "--at=0,0,-0.3", "--limit", "100", "--json"]
    with pytest.raises(SystemExit) as left:
        cli.main(command)
    found = json.loads(capsys.readouterr().out)
    assert left.value.code == 0
    assert found["limit"]["band"] == [0, None]
    assert found["places"]["spl"] == [None]
