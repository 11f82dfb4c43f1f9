"""Arrays that are moved and joined: places by plain matrix algebra, parts that stay, foci of two boards."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import midair

BOARD = midair.Array.preset("autd3")
#: A quarter turn about y: z becomes x.
QUARTER = [0.0, np.pi / 2, 0.0]
#: The second of two boards at right angles: to the left of the first, facing +x.
BESIDE = [-0.12, 0.0, 0.13]
FOCUS = np.array([0.02, 0.01, 0.14])


def turned(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Rodrigues' formula: R = I + sin a K + (1 - cos a) K^2."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def grid(array: midair.Array) -> dict[str, object]:
    return {name: np.asarray(value).tolist() for name, value in (array.quantization or {}).items()}


@pytest.mark.parametrize("seed", range(5))
def test_a_moved_array_lies_where_matrix_algebra_puts_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    axis, angle, by = rng.normal(size=3), rng.uniform(-4, 4), rng.normal(size=3)
    matrix = turned(axis, angle)
    unit = axis / np.linalg.norm(axis)
    response = rng.normal(size=249) + 1j * rng.normal(size=249)
    mask = rng.random(249) < 0.8
    array = midair.Array.preset("autd3", response=response, mask=mask, pins=rng.permutation(249))
    for rotation in (unit * angle, [2 * np.cos(angle / 2), *(2 * np.sin(angle / 2) * unit)], matrix):
        moved = array.moved(rotation=rotation, translation=by)
        np.testing.assert_allclose(moved.positions, array.positions @ matrix.T + by, atol=1e-14)
        np.testing.assert_allclose(moved.normals, array.normals @ matrix.T, atol=1e-14)
        for name in ("response", "mask", "pins"):
            np.testing.assert_array_equal(getattr(moved, name), getattr(array, name))
        assert (moved.medium, grid(moved)) == (array.medium, grid(array))
        assert (moved.directivity, moved.source_pressure) == (array.directivity, array.source_pressure)
        assert pickle.loads(pickle.dumps(moved)) == moved
        assert pickle.loads(pickle.dumps(moved)).medium == moved.medium
    back = array.moved(rotation=matrix, translation=by).moved(translation=-by).moved(rotation=matrix.T)
    np.testing.assert_allclose(back.positions, array.positions, atol=1e-14)
    assert array.moved() == array


def test_a_joined_array_has_the_parts_one_after_the_other() -> None:
    mask = np.arange(249) % 3 > 0
    parts = [
        BOARD,
        midair.Array.preset("autd3", mask=mask),
        midair.Array.preset("autd3", response=np.full(249, 0.5j)),
    ]
    moved = [part.moved(translation=[0.2 * k, 0, 0]) for k, part in enumerate(parts)]
    rig = midair.Array.join(moved)
    np.testing.assert_array_equal(rig.positions, np.concatenate([part.positions for part in moved]))
    np.testing.assert_array_equal(rig.mask, np.concatenate([np.ones(249, bool), mask, np.ones(249, bool)]))
    np.testing.assert_array_equal(rig.response, np.repeat([1, 1, 0.5j], 249))
    assert rig.medium == BOARD.medium
    assert grid(rig) == grid(BOARD)
    levitator = midair.Array.preset("tinylev")
    two = midair.Array.join([levitator, levitator.moved(translation=[0.2, 0, 0])])
    np.testing.assert_array_equal(two.channels, np.arange(144) // 36)
    assert midair.Array.join([BOARD]) == BOARD


@pytest.mark.parametrize(
    ("parts", "reported"),
    [
        ([], "arrays is empty: give at least one array"),
        (
            [BOARD, midair.Array.preset("paper20")],
            r"arrays\[1\] is of another frequency or air than arrays\[0\]",
        ),
        (
            [BOARD, midair.Array.preset("sonicsurface")],
            r"arrays\[1\] is of another transducer than arrays\[0\]",
        ),
        ([BOARD, midair.Array.preset("autd3", quantization={})], r"arrays\[1\] is of another quantization"),
        ([BOARD, midair.Array.preset("ultraino_flat8x8")], r"arrays\[1\] is of another frequency or air"),
        ([BOARD, midair.Array.preset("autd3", pins=range(249))], r"arrays\[1\] is of another wiring"),
        (
            [midair.Array.preset("autd3", pins=range(249))] * 2,
            r"array\.pins\[249\] is 0: array\.pins\[0\] is the same",
        ),
        (3, "arrays is 3: give a list of arrays"),
    ],
)
def test_parts_that_cannot_be_joined_are_one_line(parts: list[midair.Array], reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported) as caught:
        midair.Array.join(parts)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("rotation", "reported"),
    [
        ([[1, 0, 0], [0, 1, 0], [0, 0, -1]], "give orthonormal rows of determinant 1"),
        ([[2, 0, 0], [0, 2, 0], [0, 0, 2]], "give orthonormal rows of determinant 1"),
        ([0, 0, 0, 0], "give a quaternion of length 1"),
        ([0, np.nan, 0], "rotation is NaN: give finite numbers"),
        ([[0, 1], [1, 0]], r"rotation is of shape \(2, 2\): give \(3,\), axis times angle in rad"),
    ],
)
def test_what_is_no_rotation_is_one_line(rotation: list[float], reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        BOARD.moved(rotation=rotation)


def loudest(array: midair.Array, drive: NDArray[np.complex64], speed: float) -> NDArray[np.float64]:
    """Returns the place near the focus where the waves add up best, from a plain sum of phasors.

    The phases alone decide: with 1/r, the loudest place lies .15 mm nearer to the two boards.
    """
    step = np.arange(-30, 31) * 0.05e-3
    x, z = np.meshgrid(step, step)
    places = FOCUS + np.stack([x.ravel(), 0 * x.ravel(), z.ravel()], axis=1)
    apart = places[:, None] - array.positions
    far = np.linalg.norm(apart, axis=2)
    waves = np.exp(2j * np.pi * 40e3 / speed * far)
    return places[np.abs(waves @ np.exp(1j * np.angle(drive))).argmax()]


def rigs(folder: Path) -> dict[str, midair.Scene]:
    joined = midair.Array.join([BOARD, BOARD.moved(rotation=QUARTER, translation=BESIDE)])
    second = {"preset": "autd3", "rotation": QUARTER, "translation": BESIDE}
    document = {"array": {"part": [{"preset": "autd3"}, second]}, "points": [{"position": FOCUS.tolist()}]}
    toml = (
        f'[[array.part]]\npreset = "autd3"\n[[array.part]]\npreset = "autd3"\nrotation = {QUARTER}\n'
        f"translation = {BESIDE}\n[[points]]\nposition = {FOCUS.tolist()}\n"
    )
    scene = midair.Scene(joined, [FOCUS])
    scene.save(folder / "rig.toml")
    return {
        "python": scene,
        "json": midair.Scene.parse(json.dumps(document)),
        "toml": midair.Scene.parse(toml),
        "saved": midair.Scene.load(folder / "rig.toml"),
    }


def test_two_boards_at_right_angles_focus_where_they_should(tmp_path: Path) -> None:
    for name, scene in rigs(tmp_path).items():
        assert scene.sound_speed == pytest.approx(346.13, abs=0.01), name
        assert midair.Board("autd3", scene.array).boards == 2
        assert grid(scene.array) == grid(BOARD)
        drive = midair.solve(scene, "naive").drive
        assert np.abs(loudest(scene.array, drive, 346.13) - FOCUS).max() < 0.1e-3, name
        beside = [FOCUS, FOCUS + np.array([0.5e-3, 0, 0]), FOCUS - np.array([0, 0, 0.5e-3])]
        field = midair.field(scene, drive, beside).pressure
        assert np.abs(field)[0] > np.abs(field)[1:].max()
        # Sequences and boards take it as it is.
        with midair.connect("autd3:loop", array=scene.array) as boards:
            boards.send(midair.solve(scene, "naive"))


@pytest.mark.parametrize(
    ("array", "reported"),
    [
        ("part = []\n[[points]]\nposition=[0,0,0.1]", r"array\.part is empty: give at least one array"),
        (
            'preset = "autd3"\npart = [{preset = "autd3"}]',
            "array is described 2 times: give exactly one of grid",
        ),
        ('part = [{preset = "autd3"}, {preset = "autd4"}]', 'unknown preset "autd4"'),
        ('part = [{preset = "autd3"}, {}]', r"array\.part\[1\] is described 0 times"),
        (
            'part = [{preset = "autd3"}, {preset = "paper20"}]',
            r"array\.part\[1\] is of another frequency or air",
        ),
        (
            'part = [{preset = "autd3", rotation = [1, 2]}]',
            r"array\.part\[0\]\.rotation is 2 numbers: give 3",
        ),
        ('part = [{preset = "autd3", shift = [1, 2]}]', "shift"),
        ('part = [{preset = "autd3", mask = [true]}]', r"array\.part\[0\]\.mask is 1 values"),
    ],
)
def test_parts_of_a_scene_file_are_reported_where_they_stand(array: str, reported: str) -> None:
    points = "" if "points" in array else "\n[[points]]\nposition = [0, 0, 0.1]"
    with pytest.raises(midair.SceneError, match=reported) as caught:
        midair.Scene.parse(f"[array]\n{array}{points}")
    assert "line 2" in str(caught.value) or "line 1" in str(caught.value)
