"""Arrays that are moved and joined: places by plain matrix algebra, parts that stay, foci of two boards."""

from __future__ import annotations

import json
import pickle
import tempfile
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
            r"arrays\[1\] is of another frequency or air than the first",
        ),
        (
            [BOARD, midair.Array.preset("sonicsurface")],
            r"arrays\[1\] is of another transducer than the first",
        ),
        ([BOARD, midair.Array.preset("autd3", quantization={})], r"arrays\[1\] is of another quantization"),
        ([BOARD, midair.Array.preset("ultraino_flat8x8")], r"arrays\[1\] is of another frequency or air"),
        ([BOARD, midair.Array.preset("autd3", pins=range(249))], r"arrays\[1\] is of another wiring"),
        (
            [midair.Array.preset("autd3", pins=range(249))] * 2,
            r"arrays\[1\] is on pin 0, as another transducer",
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


@pytest.mark.parametrize("kind", ["autd3", "sonicsurface", "openmpd_board"])
def test_boards_put_together_by_their_places_are_reported(kind: str) -> None:
    board = midair.Array.preset(kind)
    other = board.moved(rotation=QUARTER, translation=[-0.2, 0, 0.2])
    places, normals = (
        np.concatenate([getattr(one, name) for one in (board, other)]) for name in ("positions", "normals")
    )
    with pytest.warns(
        midair.SceneWarning, match="array.positions are those of boards, in a medium of 340 m/s: join arrays"
    ):
        midair.Scene(midair.Array(places, normals), [[0, 0, 0.1]])
    # With air of their own, joined, or alone they are no mistake.
    midair.Scene(midair.Array(places, normals), [[0, 0, 0.1]], temperature=25)
    midair.Scene(midair.Array.join([board, other]), [[0, 0, 0.1]])
    midair.Scene(midair.Array(board.positions), [[0, 0, 0.1]])


def test_an_angle_in_degrees_is_no_rotation() -> None:
    assert BOARD.moved(rotation=[0, 2 * np.pi, 0]).positions == pytest.approx(BOARD.positions, abs=1e-12)
    with pytest.raises(midair.SceneError, match=r"give at most 2 pi rad \(90\.0 degrees are 1\.5708 rad\)"):
        BOARD.moved(rotation=[0, 90, 0])


@pytest.mark.parametrize(
    ("second", "reported"),
    [
        ('preset = "sonicsurface"', r"array\.part\[1\] is of another transducer than the first"),
        ('preset = "autd3"', r"array\.part\[1\] is on pin 0, as another transducer"),
    ],
)
def test_a_part_of_a_scene_file_that_cannot_be_joined_is_named(second: str, reported: str) -> None:
    pins = f"pins = {list(range(249))}" if "autd3" in second else ""
    parts = f'[[array.part]]\npreset = "autd3"\n{pins}\n[[array.part]]\n{second}\n{pins}\n'
    with pytest.raises(midair.SceneError, match=reported):
        midair.Scene.parse(parts + "[[points]]\nposition = [0, 0, 0.1]\n")


def test_a_board_whose_response_a_solution_lacks_corrects_it() -> None:
    preset = midair.Array.preset("ultraino_flat8x8")
    bare = midair.Array(preset.positions, source_pressure=2.4)
    scene = midair.Scene(bare, [[0.01, 0.005, 0.08]], temperature=25)
    solution = midair.solve(scene, "naive")
    board = midair.Board("mega64", bare)
    for frame in (board.encode(solution), written(board, solution)):
        emitted = board.decode(frame) * preset.response
        off = np.angle(emitted / solution.drive)
        assert abs(off).max() <= np.pi / 10 + 1e-6


def written(board: midair.Board, solution: midair.Solution) -> bytes:
    """Returns the frame that midair.write stores."""
    with tempfile.TemporaryDirectory() as folder:
        midair.write(Path(folder, "a.bin"), solution, board=board)
        return Path(folder, "a.bin").read_bytes()


def test_channels_decide_how_many_boards_there_are() -> None:
    part = midair.Array(midair.Array.preset("sonicsurface").positions[:10])
    board = midair.Board("sonicsurface", part, channels=range(500, 510))
    assert (board.boards, board.channels.tolist()) == (2, list(range(500, 510)))
    rows = BOARD.positions[0] + np.outer(np.arange(600), [1, 0, 0])
    with pytest.raises(midair.SceneError, match="transducers is 600: sonicsurface has 1 to 512 channels"):
        midair.Array(rows).channels_by_place("sonicsurface")


def test_a_sonicsurface_is_an_openmpd_board_turned_by_a_quarter() -> None:
    surface, openmpd = (midair.Array.preset(name) for name in ("sonicsurface", "openmpd_board"))
    turned = surface.moved(rotation=[0, 0, -np.pi / 2])
    assert turned.positions == pytest.approx(openmpd.positions, abs=1e-12)
    assert midair.Board("openmpd", surface).channels.tolist() == midair.Board("openmpd").channels.tolist()
