"""Files of drives and of control points:
read by decoders written here from the formats' documents, and by midair.
"""

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._files import ControlPoints

PI = np.pi


def random_drives(frames: int, transducers: int, seed: int = 1) -> np.ndarray[Any, Any]:
    make = np.random.default_rng(seed)
    shape = (frames, transducers)
    found = np.sqrt(make.random(shape)) * np.exp(2j * PI * make.random(shape))
    found[0, :3] = -1, 0, 1
    return found.astype(np.complex64)


def solution() -> midair.Solution:
    return midair.solve(midair.Scene(midair.Array.preset("autd3"), [[0.01, 0, 0.15]]), "naive")


def moving() -> midair.Sequence:
    points = np.tile([0, 0, 0.1], (4, 2, 1))
    points[:, 1, 0] = [0.01, 0.012, 0.014, 0.016]
    targets = [[100, 200], [100, 150], [100, 100], [0, 400]]
    drives = random_drives(4, 25)
    return midair.Sequence(midair.Array.grid(5, 5, pitch=0.01), points, targets, drives, rate=500.0)


def acoustools_places() -> list[tuple[float, float, bool]]:
    """Returns the transducers in AcousTools' order: x and y in mm,
    and whether the transducer is on the top board, which faces down.
    """
    side = [-78.75 + 10.5 * k for k in range(16)]
    return [(x, y, top) for top in (True, False) for x in side for y in side]


def by_place(values: Any, places: list[tuple[float, float, bool]]) -> np.ndarray[Any, Any]:
    """Returns values by position, in the order of the preset's transducers."""
    known = {(round(x, 2), round(y, 2), top): value for (x, y, top), value in zip(places, values, strict=True)}
    array = midair.Array.preset("openmpd_pair")
    rows = zip((array.positions * 1e3).round(2).tolist(), array.normals.tolist(), strict=True)
    return np.array([known[x, y, normal[2] < 0] for (x, y, _), normal in rows])


def oracle_holo(path: Path) -> list[tuple[list[int], list[int]]]:
    data, numbers = zlib.decompress(path.read_bytes()), []
    for first in range(0, len(data), 5):
        high, low = struct.unpack(">BI", data[first : first + 5])
        assert high == 0
        numbers.append(low)
    lists: list[list[int]] = [[]]
    for one in numbers:
        lists.append([]) if one == 63 else lists[-1].append(one)
    assert lists.pop() == []
    return list(zip(lists[::2], lists[1::2], strict=True))


@pytest.mark.filterwarnings("ignore:AcousTools has boards of 256 transducers")
@pytest.mark.parametrize("transducers", [512, 7])
def test_holo_holds_32_steps_of_phase_and_amplitude(transducers: int, tmp_path: Path) -> None:
    drives, path = random_drives(3, transducers), tmp_path / "a.holo"
    midair.write(path, drives)
    kept = oracle_holo(path)
    assert len(kept) == 3
    for (phases, amplitudes), drive in zip(kept, drives, strict=True):
        assert set(phases) <= set(range(33))
        assert set(amplitudes) <= set(range(33))
        decoded = [a / 32 * np.exp(1j * (p - 16) * 2 * 3.1415 / 32) for p, a in zip(phases, amplitudes, strict=True)]
        found = by_place(decoded, acoustools_places()) if transducers == 512 else np.array(decoded)
        assert np.abs(np.abs(found) - np.abs(drive)).max() <= 1 / 64 + 1e-6
        turned = np.angle(found * drive.conj())[(np.abs(found) > 0) & (np.abs(drive) > 0)]
        # The decoder has 3.1415 for pi, as AcousTools does: phases have relative errors of up to 3e-5.
        assert np.abs(turned).max() <= PI / 32 + 2e-4
    back = midair.read(path)
    assert isinstance(back, np.ndarray)
    assert back.dtype == np.complex64
    (phases, amplitudes), first = kept[0], back[0]
    same = [a / 32 * np.exp(1j * (p - 16) * 2 * 3.1415 / 32) for p, a in zip(phases, amplitudes, strict=True)]
    same = list(by_place(same, acoustools_places())) if transducers == 512 else same
    np.testing.assert_allclose(first, same, atol=1e-6)
    midair.write(path, back)
    np.testing.assert_array_equal(midair.read(path), back)


def test_acoustools_csv_is_in_openmpds_order(tmp_path: Path) -> None:
    drives, path = random_drives(3, 512), tmp_path / "a.csv"
    drives /= np.where(drives == 0, 1, np.abs(drives))
    with pytest.warns(midair.SceneWarning, match="amplitudes down to 0 are not written"):
        midair.write(path, drives, layout="acoustools")
    head, *rows = path.read_text("utf-8").splitlines()
    assert head == "3,512"
    own = acoustools_places()
    # The order in the file: the top board reversed, and each run of 16 of the bottom board reversed.
    places = own[:256][::-1]
    for first in range(256, 512, 16):
        places += own[first : first + 16][::-1]
    back = midair.read(path)
    assert isinstance(back, np.ndarray)
    for row, drive, read in zip(rows, drives, back, strict=True):
        phases = [float(cell) for cell in row.split(",")]
        assert max(phases) <= PI + 1e-6
        assert min(phases) > -PI + 1e-6
        found = np.exp(1j * by_place(phases, places))
        np.testing.assert_allclose(found[drive != 0], drive[drive != 0], atol=1e-6)
        np.testing.assert_allclose(read, found, atol=1e-6)


def test_a_pair_that_stands_in_another_order_is_written_by_place(tmp_path: Path) -> None:
    pair = midair.Array.preset("openmpd_pair")
    mixed = np.random.default_rng(3).permutation(512)
    array = midair.Array(pair.positions[mixed], pair.normals[mixed])
    drive = np.exp(2j * PI * np.random.default_rng(4).random(512)).astype(np.complex64)
    points = np.zeros((2, 1, 3))
    one = midair.Sequence(pair, points, 1.0, np.stack([drive] * 2), rate=100.0)
    other = midair.Sequence(array, points, 1.0, np.stack([drive[mixed]] * 2), rate=100.0)
    for name, layout in (("csv", "acoustools"), ("holo", None)):
        midair.write(tmp_path / f"one.{name}", one, layout=layout)
        midair.write(tmp_path / f"other.{name}", other, layout=layout)
        assert (tmp_path / f"one.{name}").read_bytes() == (tmp_path / f"other.{name}").read_bytes()
    surfaces = midair.Board("sonicsurface_pair")
    still = midair.Sequence(surfaces.array, points, 1.0, np.stack([drive] * 2), rate=100.0)
    midair.write(tmp_path / "full.csv", still, layout="acoustools")
    back = midair.read(tmp_path / "full.csv", board=surfaces)
    np.testing.assert_allclose(back, [drive] * 2, atol=1e-6)
    assert np.abs(midair.read(tmp_path / "full.csv") - drive).max() > 0.1
    midair.write(tmp_path / "full.holo", still)
    back = midair.read(tmp_path / "full.holo", board="sonicsurface_pair")
    assert np.abs(back - drive).max() < PI / 32 + 1e-3
    with pytest.raises(midair.SceneError, match="drives of 512 transducers, an array of 249"):
        midair.read(tmp_path / "full.holo", board="autd3")
    far = midair.Array(pair.positions * 1.5, pair.normals)
    strange = midair.Sequence(far, points, 1.0, np.stack([drive] * 2), rate=100.0)
    with pytest.raises(midair.SceneError, match="not those of OpenMPD boards"):
        midair.write(tmp_path / "far.holo", strange)


@pytest.mark.parametrize("frames", [1, 4])
def test_ultrainos_pair(frames: int, tmp_path: Path) -> None:
    drives = random_drives(frames, 64)
    given = drives[0] if frames == 1 else drives
    path = tmp_path / "ring0_Phase.csv"
    midair.write(path, given)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["ring0_Amp.csv", "ring0_Phase.csv"]
    tables = [
        [[float(cell) for cell in row.split(",")] for row in file.read_text("utf-8").splitlines()]
        for file in (tmp_path / "ring0_Amp.csv", path)
    ]
    np.testing.assert_allclose(np.array(tables[0]) * np.exp(1j * np.array(tables[1])), drives, atol=1e-6)
    for name in ("ring0_Phase.csv", "ring0_Amp.csv"):
        np.testing.assert_allclose(midair.read(tmp_path / name), given, atol=1e-6)


def test_one_drive_as_a_table(tmp_path: Path) -> None:
    solved, path = solution(), tmp_path / "a.csv"
    midair.write(path, solved)
    solved.save(tmp_path / "b.csv")
    assert path.read_bytes() == (tmp_path / "b.csv").read_bytes()
    np.testing.assert_allclose(midair.read(path), solved.drive, atol=1e-6)
    drive = random_drives(1, 249)[0]
    midair.write(path, drive)
    head, *rows = path.read_text("utf-8").splitlines()
    assert head == "index,amplitude,phase"
    numbers = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    np.testing.assert_array_equal(numbers[:, 0], np.arange(249))
    assert numbers[:, 2].min() >= 0
    assert numbers[:, 2].max() < 2 * PI
    np.testing.assert_allclose(numbers[:, 1] * np.exp(1j * numbers[:, 2]), drive, atol=1e-6)
    np.testing.assert_allclose(midair.read(path), drive, atol=1e-6)
    midair.write(path, drive, board="autd3")
    np.testing.assert_allclose(
        [[float(cell) for cell in row.split(",")[1:4]] for row in path.read_text("utf-8").splitlines()[1:]],
        midair.Board("autd3").array.positions,
    )
    np.testing.assert_allclose(midair.read(path), drive, atol=1e-6)


def test_archives_hold_what_was_given(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    for given in (solution(), moving()):
        midair.write(path, given)
        assert midair.read(path) == given
    midair.write(tmp_path / "a.json", solution())
    assert midair.read(tmp_path / "a.json") == solution()
    for drives in (random_drives(3, 20), random_drives(1, 20), random_drives(1, 20)[0]):
        midair.write(path, drives)
        back = midair.read(path)
        assert isinstance(back, np.ndarray)
        assert (back.shape, back.dtype) == (drives.shape, np.complex64)
        np.testing.assert_array_equal(back, drives)
    matrix = midair.Propagation(np.ones((1, 6)) * np.exp(1j * np.arange(6)))
    solved = midair.solve(matrix, "naive")
    midair.write(path, solved)
    np.testing.assert_array_equal(midair.read(path), solved.drive)


def test_frames_of_a_board(tmp_path: Path) -> None:
    """Checks the bytes of two SonicSurface frames: 254, codes floor(32 phi / 2 pi + 1/2) mod 32 or 32, 253.

    The channels 3, 11, 19, ... emit one step late, so their codes are one less.
    """
    path, board = tmp_path / "a.bin", midair.Board("sonicsurface")
    drives = np.exp(2j * PI * np.random.default_rng(5).random((2, 256))).astype(np.complex64)
    drives[0, 10] = 0
    midair.write(path, drives, board=board)
    data = path.read_bytes()
    assert len(data) == 2 * 258
    codes = np.floor(np.angle(drives.astype(np.complex128)) / (2 * PI) * 32 + 0.5).astype(int) % 32
    codes[0, 10] = 32
    for frame, expected in enumerate(codes):
        part = data[258 * frame : 258 * frame + 258]
        assert (part[0], part[-1]) == (254, 253)
        sent = np.frombuffer(part[1:-1], np.uint8).astype(int)
        late = (np.arange(256) % 8 == 3) & (sent < 32)
        sent[late] = (sent[late] + 1) % 32
        assert sorted(sent) == sorted(expected)
    back = midair.read(path, board="sonicsurface")
    assert isinstance(back, np.ndarray)
    np.testing.assert_allclose(back, np.where(codes == 32, 0, np.exp(2j * PI * codes / 32)), atol=1e-6)
    midair.write(path, back[1], board=board)
    np.testing.assert_allclose(midair.read(path, board=board), back[1], atol=1e-6)


def rows_of(path: Path) -> tuple[list[str], np.ndarray[Any, Any]]:
    head, *rows = path.read_text("utf-8").splitlines()
    return head.split(","), np.array([[float(cell) for cell in row.split(",")] for row in rows])


def test_control_points_of_a_path_and_of_a_sequence(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    circle = midair.path.circle((0, 0, 0.2), 0.03, pressures=500.0, frequency=5.0)
    midair.write(path, circle, rate=100.0, modulate=200.0)
    names, rows = rows_of(path)
    assert names == ["t", "x", "y", "z", "intensity", "frequency"]
    np.testing.assert_allclose(rows[:, 0], np.arange(20) / 100)
    np.testing.assert_allclose(rows[:, 1:4], circle.at(rows[:, 0])[:, 0], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(rows[:, 1:3], axis=1), 0.03)
    assert (rows[:, 4] == 1).all()
    assert (rows[:, 5] == 200).all()
    back = midair.read(path)
    assert isinstance(back, ControlPoints)
    assert back.frequencies is not None
    assert back.points.shape == (20, 1, 3)
    sequence = moving()
    midair.write(path, sequence, layout="points")
    names, rows = rows_of(path)
    assert names == ["t", "x", "y", "z", "intensity"]
    np.testing.assert_allclose(rows[:, 0], np.repeat(np.arange(4) / 500, 2))
    np.testing.assert_allclose(rows[:, 1:4], sequence.points.reshape(-1, 3))
    np.testing.assert_allclose(rows[:, 4], sequence.targets.ravel() / 400)
    back = midair.read(path)
    assert isinstance(back, ControlPoints)
    assert back.frequencies is None
    np.testing.assert_array_equal(back.points, sequence.points)
    other = tmp_path / "other.csv"
    midair.write(other, back)
    assert other.read_bytes() == path.read_bytes()


def test_control_points_of_numbers(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    midair.write(path, [[0, 0, 0.2], [0.01, 0, 0.2]], layout="Points")
    names, rows = rows_of(path)
    np.testing.assert_array_equal(rows, [[0, 0, 0, 0.2, 1], [0, 0.01, 0, 0.2, 1]])
    with pytest.raises(midair.SceneError, match="rate is left out"):
        midair.write(path, np.zeros((2, 1, 3)), layout="points")
    assert rows_of(path)[0] == names
