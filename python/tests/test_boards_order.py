"""Order of transducers on boards: no array in another order than its board reaches it without a word, and
wiring that a file states is used. The right values were computed without midair.
"""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import midair

DATA = Path(__file__).parent / "data"
#: A grid of 16 x 16 on which x varies slowly, and a focus.
SLOW = midair.Array.preset("sonicsurface").positions.reshape(16, 16, 3).swapaxes(0, 1).reshape(256, 3)
FOCUS = [[0.03, 0.02, 0.12]]


def pressure(array: midair.Array, drive: object, point: list[list[float]]) -> float:
    return float(np.abs(midair.field(midair.Scene(array, point), drive, point).pressure[0]))


@pytest.mark.parametrize("kind", ["sonicsurface", "openmpd", "mega64", "nano16", "nano", "homies", "autd3"])
def test_a_random_order_is_refused_by_every_way_to_a_board(kind: str, tmp_path: Path) -> None:
    board = midair.Board(kind)
    rng = np.random.default_rng(len(kind))
    mixed = rng.permutation(len(board.array))
    array = midair.Array(board.array.positions[mixed], board.array.normals[mixed])
    solution = midair.solve(midair.Scene(array, [[0.01, 0.02, 0.1]]), "naive")
    reported = f"array is in another order than {kind}: give its transducers in the order "
    for way in (
        lambda: midair.Board(kind, array),
        lambda: midair.connect(f"{kind}:loop", array=array),
        lambda: solution.play(f"{kind}:loop", seconds=0.1),
    ):
        with pytest.raises(midair.SceneError) as caught:
            way()
        assert str(caught.value).startswith(reported)
        assert "\n" not in str(caught.value)
    with pytest.raises(midair.SceneError, match="the drive was solved for an array whose transducer"):
        board.encode(solution)
    elsewhere = pytest.raises(midair.SceneError, match="the drive was solved for an array whose transducer")
    with midair.connect(f"{kind}:null") as connection, elsewhere:
        connection.send(solution)
    with pytest.raises(midair.SceneError, match="the drive was solved for an array whose transducer"):
        midair.write(tmp_path / "a.bin", solution, board=kind)
    # The channels by place play the same field.
    channels = array.channels_by_place(kind)
    assert np.array_equal(channels, board.channels[mixed])
    own = midair.Board(kind, array, channels=channels)
    drive = np.empty_like(solution.drive)
    drive[mixed] = own.decode(own.encode(solution))
    np.testing.assert_allclose(board.decode(board.encode(drive)), drive, atol=1e-6)


def test_a_board_is_known_by_its_order_wherever_it_stands() -> None:
    array = midair.Array.preset("sonicsurface")
    moved = array.moved(rotation=[0.3, -1.0, 2.0], translation=[1.0, -2.0, 0.5])
    scene = midair.Scene(moved, [moved.positions.mean(0) + 0.1 * moved.normals[0]])
    with midair.connect("sonicsurface:loop", array=moved) as surface:
        surface.send(midair.solve(scene))
    with midair.connect("sonicsurface:loop") as surface:
        surface.send(midair.solve(scene))


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_a_drive_for_another_frequency_is_refused_by_every_way_to_a_board(tmp_path: Path) -> None:
    array = midair.Array.preset("sonicsurface")
    solution = midair.solve(midair.Scene(array, FOCUS, frequency=25e3))
    sequence = midair.sequence(array, [FOCUS, FOCUS], rate=50, frequency=25e3)
    reported = "the drive was solved for 25000 Hz: the board emits 40000 Hz, solve for that"
    with midair.connect("sonicsurface:loop", array=array) as surface:
        for way in (
            lambda: surface.board.encode(solution),
            lambda: surface.send(solution),
            lambda: surface.stream(sequence),
            lambda: midair.write(tmp_path / "a.bin", solution, board="sonicsurface"),
            lambda: midair.write(tmp_path / "a.bin", sequence, board="sonicsurface"),
        ):
            with pytest.raises(midair.SceneError) as caught:
                way()
            assert str(caught.value) == reported
        # A MEGA64 emits 40.4 kHz, 1 % above the frequency of arrays of one's own.
        surface.send(midair.solve(midair.Scene(array, FOCUS, frequency=40.4e3)))
    assert not (tmp_path / "a.bin").exists()


def test_x_slow_on_a_sonicsurface_is_refused_or_put_in_order() -> None:
    array = midair.Array(SLOW, source_pressure=2.4, directivity={"sinc": 9e-3})
    with pytest.raises(midair.SceneError, match=r"give its transducers in the order \[0, 16, 32, .*pins=\[0, "):
        midair.Board("sonicsurface", array)
    surface = midair.Board("sonicsurface")
    board = midair.Board("sonicsurface", array, channels=array.channels_by_place("sonicsurface"))
    # The air of the board: an array of positions has that of the paper.
    solution = midair.solve(midair.Scene(board.array, FOCUS, **surface.array.medium))
    played = surface.decode(board.encode(solution))
    assert pressure(surface.array, played, FOCUS) == pytest.approx(2678, rel=0.02)


def test_the_pins_of_an_ultraino_file_are_played(tmp_path: Path) -> None:
    array = midair.Array.from_file(DATA / "pins_reversed.xml")
    point = [[0.012, 0.007, 0.08]]
    assert array.pins.tolist() == list(range(63, -1, -1))
    scene = midair.Scene(array, point)
    scene.save(tmp_path / "pins.toml")
    for again in (
        pickle.loads(pickle.dumps(array)),
        array.moved(translation=[0, 0, 0.1]),
        midair.Scene.load(tmp_path / "pins.toml").array,
        midair.Scene.parse(scene.json()).array,
    ):
        assert np.array_equal(again.pins, array.pins)
    with midair.connect("mega64:loop", array=array) as mega:
        solution = midair.solve(midair.Scene(mega.board.array, point))
        mega.send(solution)
        np.testing.assert_allclose(mega.emitting, solution.drive, atol=1e-6)
        frame = mega.board.encode(mega.emitting)
    # The drive of each pin, put at the transducer with this pin; and in the order of the file.
    of_pins = midair.Board("mega64").decode(frame)
    board = mega.board.array
    assert pressure(board, of_pins[array.pins], point) == pytest.approx(abs(solution.pressures[0]), rel=1e-5)
    assert pressure(board, of_pins, point) < 0.05 * abs(solution.pressures[0])


def test_pins_of_a_file_that_are_no_channels_are_a_warning(tmp_path: Path) -> None:
    text = (DATA / "pins_reversed.xml").read_text("utf-8").replace("<int>62</int>", "<int>63</int>", 1)
    path = tmp_path / "twice.xml"
    path.write_text(text, "utf-8")
    with pytest.warns(midair.SceneWarning, match="driverPinNumber 63 of .* is no channel of one transducer"):
        assert midair.Array.from_file(path).pins is None


@pytest.mark.parametrize("ending", ["holo", "csv"])
def test_acoustools_files_of_one_board_are_put_in_order(ending: str, tmp_path: Path) -> None:
    point = [[0.02, 0.015, 0.1]]
    board = midair.Array.preset("openmpd_board")
    if ending == "holo":
        drive = midair.read(DATA / "one_board.holo")
        assert pressure(board, drive, point) == pytest.approx(4734, rel=0.03)
    drive = midair.solve(midair.Scene(board, point), "naive").drive
    drive = np.exp(1j * np.angle(drive)).astype(np.complex64)
    path = tmp_path / f"a.{ending}"
    midair.write(path, drive, layout="acoustools" if ending == "csv" else None)
    np.testing.assert_allclose(midair.read(path), drive, atol=0.11)
    if ending == "csv":
        # x varies slowly, then y upwards.
        own = np.array(path.read_text("utf-8").splitlines()[1].split(","), float)
        rows = np.lexsort((board.positions[:, 1], board.positions[:, 0].round(6)))
        np.testing.assert_allclose(np.exp(1j * own), drive[rows], atol=1e-6)
    far = midair.solve(midair.Scene(midair.Array(board.positions * 1.2), point), "naive")
    with pytest.raises(midair.SceneError, match="256 transducers, but not those of OpenMPD boards"):
        midair.write(path, far, layout="acoustools" if ending == "csv" else None)
    some = midair.solve(midair.Scene(midair.Array.grid(10, 10, 0.01), point), "naive")
    with pytest.warns(midair.SceneWarning, match="100 keep the order of the drives"):
        midair.write(tmp_path / "b.holo", some)


@pytest.mark.parametrize("kind", ["homies", "mega64", "nano16", "sonicsurface"])
def test_a_random_order_is_seen_also_near_the_limit_of_the_places(kind: str) -> None:
    rng = np.random.default_rng(3)
    places = midair.Board(kind).array.positions
    for _ in range(10):
        off = places + rng.uniform(-1.4e-3, 1.4e-3, places.shape)
        midair.Board(kind, midair.Array(off))
        with pytest.raises(midair.SceneError, match=f"array is in another order than {kind}"):
            midair.Board(kind, midair.Array(off[rng.permutation(len(places))]))


def test_channels_of_an_array_obey_the_order_too() -> None:
    autd3 = midair.Array.preset("autd3")
    with pytest.raises(midair.SceneError, match=r"array\.channels is given: autd3 drives each transducer alone"):
        midair.Board("autd3", midair.Array(autd3.positions, channels=np.arange(249) // 2))
    mixed = np.random.default_rng(1).permutation(249)
    with pytest.raises(midair.SceneError, match="in another order than autd3"):
        midair.Board("autd3", midair.Array(autd3.positions, channels=mixed))


def test_places_that_are_not_finite_fit_no_board() -> None:
    autd3 = midair.Array.preset("autd3")
    mixed = midair.Array(autd3.positions[np.random.default_rng(1).permutation(249)])
    with pytest.raises(midair.SceneError):
        midair.Board("autd3", mixed.moved(translation=[1e308] * 3))


def test_a_drive_is_for_places_to_half_a_millimetre() -> None:
    array = midair.Array.preset("sonicsurface")
    larger = midair.Board("sonicsurface", midair.Array(1.02 * array.positions))
    with pytest.raises(midair.SceneError, match="the drive was solved for an array whose transducer"):
        larger.encode(midair.solve(midair.Scene(array, FOCUS), "naive"))
