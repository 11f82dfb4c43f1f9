"""The recorded output of the makers' own gateware for midair's bytes: the pins' fields, and rates.

SonicSurface's VHDL was simulated by GHDL, and Ultraino's published binary by simavr. `firmware.py` models
their timing.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import midair
from rigs import TURN, of_kind

#: Recorded before the encoder corrected for delays. PAIR: the pressure at a focus between two boards,
#: relative to the corrected one. QUIET: the highest pressure at three quiet points, relative to the focus.
#: PERIOD: the period of a MEGA64 in cycles of 16 MHz.
PAIR, QUIET, PERIOD = 0.078, 0.018, 396


def emitted(board: midair.Board, drive, kind: str) -> np.ndarray:
    """Returns the output of the pins for a drive's frame, in the order of the array."""
    _, rig = of_kind(kind)
    return rig.play(board.encode(drive), board.channels)[: len(board.array)] / TURN[kind]


def bare(array: midair.Array) -> midair.Array:
    """Returns the transducers without the board's response: they emit what the pins do."""
    return midair.Array(
        array.positions, array.normals, source_pressure=array.source_pressure, directivity=array.directivity
    )


def pressures(board: midair.Board, scene: midair.Scene, pins) -> np.ndarray:
    seen = midair.Scene(bare(board.array), scene.points, **scene.medium)
    return np.abs(midair.field(seen, pins.astype(np.complex64), scene.points).pressure)


@pytest.mark.parametrize("place", [(0, 0, 0), (0.01, 0.005, 0.02)])
def test_two_sonicsurfaces_make_the_focus_that_is_reported(place) -> None:
    board = midair.Board("sonicsurface_pair")
    scene = midair.Scene(board.array, [place])
    solution = midair.solve(scene)
    pins = emitted(board, solution.drive, "sonicsurface")
    (got,) = pressures(board, scene, pins)
    assert got == pytest.approx(abs(solution.pressures[0]), rel=1e-3)
    # Add the delays that the encoder has corrected for.
    late = np.where(np.arange(512) < 256, 1, np.exp(1j * np.deg2rad(187.65)))
    (silent,) = pressures(board, scene, pins * late)
    assert silent / got == pytest.approx(PAIR, abs=0.01)


def test_quiet_points_of_a_sonicsurface_are_as_quiet_as_reported() -> None:
    board = midair.Board("sonicsurface")
    scene = midair.Scene(
        board.array, [[0, 0, 0.12], [0.03, 0, 0.12], [0.03, 0.01, 0.12], [0.03, -0.01, 0.12]], [1, 0, 0, 0]
    )
    solution = midair.solve(scene, aim="max")
    pins = emitted(board, solution.drive, "sonicsurface")
    got, stated = pressures(board, scene, pins), np.abs(solution.pressures)
    np.testing.assert_allclose(got, stated, atol=1e-4 * stated[0])
    # Undo the correction of the multiplexer's eighth channel, which is a tick late: the quiet points get
    # loud.
    late = np.where(board.channels % 8 == 3, np.exp(2j * np.pi / 32), 1)
    before = pressures(board, scene, pins * late)
    assert before[1:].max() / before[0] > 3 * stated[1:].max() / stated[0]
    assert before[1:].max() / before[0] == pytest.approx(QUIET, abs=0.015)


def test_a_mega64_emits_its_own_frequency_and_late_ports() -> None:
    board = midair.Board("mega64")
    assert board.array.medium["frequency"] == pytest.approx(16e6 / PERIOD)
    assert midair.Scene(board.array, [[0, 0, 0.1]]).frequency == pytest.approx(40404.04)
    scene = midair.Scene(board.array, [[0, 0, 0.1]])
    solution = midair.solve(scene)
    (got,) = pressures(board, scene, emitted(board, solution.drive, "mega64"))
    played = board.decode(board.encode(solution.drive)).astype(np.complex64)
    assert got == pytest.approx(np.abs(midair.field(scene, played, scene.points).pressure[0]), rel=1e-3)
    assert got == pytest.approx(abs(solution.pressures[0]), rel=1e-4)
    # The ports A and J switch 30 cycles, 27 degrees, apart.
    assert np.ptp(np.unwrap(np.angle(board.array.response))) == pytest.approx(30 / PERIOD * 2 * np.pi)
    assert board.limits["steady_frames_per_second"] == 10
    # Bytes for the boards behind it stop a board's pins, too.
    three = midair.Board("mega64", midair.Array.grid(16, 12, 10e-3))
    assert three.limits["steady_frames_per_second"] == pytest.approx(10 / 3)


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_what_a_mega64_solves_is_what_its_pins_do() -> None:
    board = midair.Board("mega64")
    points = np.array([[0, 0, 0.06], [0.03, 0, 0.06], [0.03, 0.01, 0.06], [0.03, -0.01, 0.06]])
    scene = midair.Scene(board.array, points, [500, 0, 0, 0])
    for solver in ("uniform", "fast", "greedy", "glide", "naive", "descent"):
        solution = midair.solve(scene, solver)
        np.testing.assert_allclose(board.decode(board.encode(solution)), solution.drive, atol=1e-6)
        stated = np.abs(solution.pressures)
        seen = np.abs(midair.field(scene, solution.drive, scene.points).pressure) * solution.scale
        np.testing.assert_allclose(seen, stated, atol=1e-5 * stated[0])


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_an_openmpd_gets_the_nearest_pulses_of_all() -> None:
    board = midair.Board("openmpd")
    own = board.array.quantization or {}
    np.testing.assert_array_equal(own["pulses"], np.ones(128))
    assert (own["phases"], len(own["amplitudes"])) == (128, 33)
    grid = {name: own[name] for name in ("phases", "amplitudes")}
    quiet: dict[str, list[float]] = {"lm": [], "uniform": []}
    for seed in range(10):
        points = np.random.default_rng(seed).uniform([-0.04, -0.04, 0.08], [0.04, 0.04, 0.14], (9, 3))
        for solver, leaks in quiet.items():
            pair = []
            for array in (board.array, midair.Array.preset("openmpd_board", quantization=grid)):
                scene = midair.Scene(array, points, [*[800.0] * 8, 0.0])
                solution = midair.solve(scene, solver)
                played = board.decode(board.encode(solution))
                np.testing.assert_allclose(played, solution.drive, atol=1e-6)
                stated = np.abs(solution.pressures)
                seen = np.abs(midair.field(scene, played, points).pressure) * solution.scale
                np.testing.assert_allclose(seen, stated, atol=1e-5 * stated.max())
                pair.append(seen[-1] / seen.max())
            leaks.append(pair[0] / pair[1])
    # `lm` rounds its drive: the board's own array has all pulses, the other array only a grid of phases and
    # amplitudes. `uniform` searches on the grid for both arrays.
    assert np.median(quiet["lm"]) < 0.75
    assert quiet["uniform"] == [1.0] * 10


def test_pulses_are_a_quantization_that_files_keep(tmp_path: Path) -> None:
    ticks = [38, 42, 34, 35, 35, 36, 43, 43, 34, 56]
    array = midair.Board("mega64").array
    np.testing.assert_array_equal((array.quantization or {})["pulses"], ticks)
    alone = midair.Array(array.positions, quantization={"pulses": ticks})
    np.testing.assert_equal(alone.quantization, array.quantization)
    scene = midair.Scene(alone, [[0, 0, 0.1]])
    scene.save(tmp_path / "scene.toml")
    kept = midair.Scene.load(tmp_path / "scene.toml")
    np.testing.assert_equal(kept.array.quantization, array.quantization)
    np.testing.assert_array_equal(midair.solve(kept).drive, midair.solve(scene).drive)


@pytest.mark.parametrize(
    ("given", "stated"),
    [
        ({"pulses": [1, 1, 1]}, "pulses is 3 ticks: give an even number of 4 to"),
        ({"pulses": [1, 1, 1, 0]}, r"pulses\[3\] is 0"),
        ({"pulses": [1, 1, 1, 1], "phases": 5}, "phases is 5: leave them out"),
        ({"pulses": [1, 1, 1, 1], "amplitudes": [0, 0.5, 1]}, "amplitudes is 3 of them: leave them out"),
    ],
)
def test_pulses_that_are_none(given: dict[str, list[float]], stated: str) -> None:
    with pytest.raises(midair.SceneError, match=stated):
        midair.Array([[0, 0, 0]], quantization=given)


def test_arrays_of_ones_own_get_what_their_board_cannot_make_up_for() -> None:
    pair = midair.Array.preset("sonicsurface_pair")
    array = midair.Array(pair.positions, pair.normals)
    board = midair.Board("sonicsurface", array)
    np.testing.assert_allclose(board.array.response, midair.Array.preset("sonicsurface_pair").response)
    own = np.exp(1j * np.arange(512))
    kept = midair.Board("sonicsurface_pair", midair.Array.preset("sonicsurface_pair", response=own))
    np.testing.assert_allclose(kept.array.response, own)


RECORDS = Path(__file__).parents[2] / "golden" / "gateware"
#: Phase in rad by which the second of two OpenMPD boards leads the model; see docs/boards.md.
AHEAD = {"openmpd_pair": -1.498}


@pytest.mark.parametrize("name", [file.stem for file in sorted(RECORDS.glob("*.json"))])
def test_pins_of_the_makers_gateware_do_what_a_frame_is_reported_to_do(name: str) -> None:
    """Compares frames that `make gateware` recorded: random drives, a focus, and quiet points beside it."""
    board = midair.Board(name)
    record = json.loads((RECORDS / f"{name}.json").read_text("utf-8"))
    for frame in record["frames"]:
        pins = np.array(frame["pins"]) @ [1, 1j]
        pins[256:] *= np.exp(-1j * AHEAD.get(name, 0))
        response = board.array.response
        reported = board.decode(bytes.fromhex(frame["bytes"])) * (1 if response is None else response)
        on = reported != 0
        assert np.all(pins[~on] == 0)
        pins *= np.exp(-1j * np.angle(np.vdot(reported, pins)))
        assert np.abs(np.angle(pins[on] / reported[on])).max() < 0.02
        np.testing.assert_allclose(np.abs(pins), np.abs(reported), atol=0.01 if name == "mega64" else 1e-4)
