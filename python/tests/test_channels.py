"""Channels (transducers wired together): in arrays, files and boards, and with a bead that is moved."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair


def levitating(board: midair.Board, height: float) -> midair.Solution:
    return midair.solve(midair.Scene(board.array, [[0, 0, height]], signature="trap"))


@pytest.mark.parametrize("kind", ["nano", "nano16", "mega64"])
def test_a_tinylev_holds_and_moves_a_bead_by_the_phase_between_its_caps(kind: str) -> None:
    board = midair.Board(kind, midair.Array.preset("tinylev"))
    phases = board.limits["phases"]
    # A step of 1/phases of a turn in one cap's phase moves the node by 1/phases of half a wavelength.
    scene = midair.Scene(board.array, [[0, 0, 0]])
    step = scene.wavelength / 2 / phases
    for height in (0.0, 1.1e-3, -0.8e-3):
        drive = board.decode(board.encode(levitating(board, height)))
        assert (drive[:36] == drive[0]).all()
        assert (drive[36:] == drive[36]).all()
        axis = np.linspace(height - 1.5e-3, height + 1.5e-3, 301)
        levels = np.abs(midair.field(scene, drive, np.stack([0 * axis, 0 * axis, axis], axis=1)).pressure)
        node = axis[levels.argmin()]
        assert abs(node - height) < 0.75 * step + 5e-5
        felt = midair.gorkov(scene.replace(points=[[0, 0, node]]), drive)
        assert (np.linalg.eigvalsh(felt.hessian) > 0).all()
        # The upper cap is nearer to the node by `height`, and the lower cap is farther by `height`.
        between = np.angle(-drive[36] / drive[0])
        assert abs(between - 4 * np.pi * height / scene.wavelength) < 2 * np.pi / phases + 0.1


@pytest.mark.parametrize("solver", ["uniform", "best", "fast", "greedy", "descent", "bounded", "gspat", "wgs"])
def test_rows_of_a_board_are_solved_as_sums_of_columns(solver: str) -> None:
    channels = np.arange(256) // 16
    array = midair.Array.grid(16, 16, 10.5e-3, channels=channels)
    scene = midair.Scene(array, [[0, 0.01, 0.12], [0, -0.03, 0.1]])
    rows = scene.propagation().astype(np.complex128)
    assert rows.shape == (2, 256)
    sums = rows.reshape(2, 16, 16).sum(axis=2)
    solution = midair.solve(scene, solver)
    own = solution.drive.reshape(16, 16)
    assert (own == own[:, :1]).all()
    reach = np.abs(sums).sum(axis=1)
    assert np.allclose(scene.reach().alone, reach, rtol=1e-5)
    assert (np.abs(solution.pressures - sums @ own[:, 0]) < 1e-4 * reach).all()
    plain = midair.solve(midair.Propagation(sums), solver)
    assert abs(solution.metrics.accuracy / plain.metrics.accuracy - 1) < 0.03
    assert (np.abs(solution.pressures) / solution.targets).min() <= midair.bound(scene) * (1 + 1e-4)
    felt = midair.field(solution, scene.points).pressure
    assert np.allclose(felt, solution.pressures, atol=1e-4 * reach.max())


def test_channels_survive_files_pickles_and_changes(tmp_path: Path) -> None:
    levitator = midair.Array.preset("tinylev")
    assert levitator.channels is not None
    assert levitator.channels.tolist() == [0] * 36 + [1] * 36
    alone = midair.Array.preset("tinylev", channels=range(72))
    assert alone.channels is None
    rows = midair.Array.grid(4, 2, 10e-3, channels=[1, 1, 1, 1, 0, 0, 0, 0])
    for array in (levitator, alone, rows, midair.Array(rows.positions, channels=rows.channels)):
        assert pickle.loads(pickle.dumps(array)) == array
        scene = midair.Scene(array, [[0, 0, 0.01]])
        for name in ("scene.toml", "scene.json"):
            scene.save(tmp_path / name)
            assert midair.Scene.load(tmp_path / name) == scene
        solution = midair.solve(scene)
        again = pickle.loads(pickle.dumps(solution))
        assert np.array_equal(again.drive, solution.drive)
        assert again.judge() == solution.judge()
        board = midair.Board("nano" if array.channels is not None else "mega64", array)
        assert board.encode(solution) == pickle.loads(pickle.dumps(board)).encode(solution)


def test_a_channel_plays_as_long_as_one_of_its_transducers_is_on() -> None:
    array = midair.Array.grid(4, 2, 10e-3, channels=[0] * 4 + [1] * 4, mask=[True] + [False] * 7)
    board = midair.Board("nano", array)
    played = board.decode(board.encode(np.ones(8)))
    assert abs(played[0]) == pytest.approx(1)
    assert not played[4:].any()


def test_an_own_method_gets_a_column_a_channel() -> None:
    scene = midair.Scene(midair.Array.grid(4, 2, 10e-3, channels=[0, 0, 0, 0, 1, 1, 1, 1]), [[0, 0.02, 0.1]])

    def focus(matrix: Any, targets: Any, weights: Any) -> Any:
        assert matrix.shape == (1, 2)
        return np.exp(-1j * np.angle(matrix[0]))

    solution = midair.solve(scene, focus)
    assert solution.drive.shape == (8,)
    assert solution.metrics.accuracy == pytest.approx(1)


def test_what_cannot_be_wired_or_played_is_refused_in_one_line() -> None:
    levitator = midair.Array.preset("tinylev")
    board = midair.Board("nano", levitator, channels=[5, 2])
    assert board.channels.tolist() == [5, 2]
    drive = np.ones(72, np.complex64)
    drive[3] = 1j
    cases = [
        (
            lambda: midair.Array.preset("tinylev", channels=[0] * 71),
            "give one for each of the 72 transducers",
        ),
        (lambda: midair.Array.preset("tinylev", channels=[0] * 71 + [2]), "no transducer is on channel 1"),
        (
            lambda: midair.Array.preset("tinylev", channels=[0] * 71 + [-1]),
            "channels is -1: give whole numbers",
        ),
        (
            lambda: midair.Array.preset("tinylev", channels=np.arange(72) / 2),
            "give whole numbers of 0 or above",
        ),
        (
            lambda: midair.Board("nano", midair.Array.preset("tinylev", channels=np.arange(72) // 8)),
            "array.channels is 9 of them: nano has 8",
        ),
        (lambda: midair.Board("nano", levitator, channels=[1]), "the 2 channels of the array"),
        (lambda: midair.Board("nano", levitator, channels=[1, 1]), "give each once"),
        (lambda: board.encode(drive), "drive[0] on the same channel 0"),
        (lambda: midair.judge(midair.Scene(levitator, [[0, 0, 0]]), drive), "drive[0] on the same channel 0"),
    ]
    for make, reported in cases:
        with pytest.raises(midair.SceneError) as refusal:
            make()
        assert reported in str(refusal.value)
        assert "\n" not in str(refusal.value)
