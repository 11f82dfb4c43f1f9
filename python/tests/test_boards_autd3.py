"""AUTD3 boards: how they are found in an array, which arguments they accept,
and what is rejected before sending.
"""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import midair
from autd3_boards import SITES, boards, some_boards, some_poses
from autd3_makers import geometry
from midair._boards import autd3_commands as commands
from midair._boards.autd3 import Autd3Transport
from midair._boards.errors import BoardError


def random_poses(rng: np.random.Generator, count: int) -> list[tuple[list[float], np.ndarray]]:
    """Returns poses of boards anywhere in a cube of 4 m edge, with random rotations."""
    turns = rng.normal(size=(count, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return [(origin.tolist(), turn) for origin, turn in zip(rng.uniform(-2000, 2000, (count, 3)), turns, strict=True)]


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_boards_are_known_anywhere_and_turned_anyhow(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(25):
        assert midair.Board("autd3", boards(*random_poses(rng, count))).boards == count
    assert midair.Board("autd3", midair.Array.preset("autd3", tiles=(count, 2))).boards == 2 * count


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_autd3_places_transducers_where_the_array_has_them(count: int) -> None:
    rng = np.random.default_rng(10 + count)
    tiled = [((192.0 * k, 0.0, 0.0), np.array([1.0, 0, 0, 0])) for k in range(count)]
    for given in [tiled, *(random_poses(rng, count) for _ in range(10))]:
        array = boards(*given)
        devices = geometry(given)
        places = np.concatenate([device.positions() for device in devices])
        normals = np.concatenate([device.directions() for device in devices])
        assert 1e3 * array.positions == pytest.approx(places, abs=0.01)
        assert array.normals == pytest.approx(normals, abs=1e-5)
    preset = midair.Array.preset("autd3", (count, 1)).positions
    assert preset - preset[0] == pytest.approx(boards(*tiled).positions, abs=1e-8)


@pytest.mark.parametrize("count", [1, 4])
def test_what_autd3_writes_of_the_boards_is_the_array(count: int, tmp_path: Path) -> None:
    array = some_boards(count)
    path = tmp_path / "boards.json"
    path.write_text(geometry(some_poses(count)).to_json(), encoding="utf-8")
    again = midair.Array.from_file(path)
    assert again.positions == pytest.approx(array.positions, abs=1e-6)
    assert again.normals == pytest.approx(array.normals, abs=1e-6)


def moved(index: int, by: list[float]) -> midair.Array:
    array = some_boards(2)
    places = array.positions.copy()
    places[index] += by
    return midair.Array(places, array.normals)


FLIPPED = np.tile([0.0, 0, -1], (249, 1))
REFUSED = {
    "other array": (
        lambda: midair.Array.grid(20, 20, 0.01),
        "array has 400 transducers: each autd3 has 249",
    ),
    "grid of 249": (
        lambda: midair.Array.grid(83, 3, 0.01),
        "mm from its place: give the places and order of autd3, to 3 mm",
    ),
    "one moved": (
        lambda: moved(300, [3.1e-3, 0, 0]),
        "array.positions[300] is 3.078 mm from its place",
    ),
    "mirrored": (
        lambda: midair.Array(SITES * [-1e-3, 1e-3, 1e-3]),
        "is where it belongs, but faces another way",
    ),
    "backwards": (
        lambda: midair.Array(SITES * 1e-3, FLIPPED),
        "is where it belongs, but faces another way",
    ),
    "other order": (lambda: midair.Array(SITES[::-1] * 1e-3 * [1, -1, 1]), "mm from its place"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_autd3_board_is_reported(name: str) -> None:
    make, reported = REFUSED[name]
    with pytest.raises(midair.SceneError) as caught:
        midair.Board("autd3", make())
    assert reported in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_transducer_may_lie_3_mm_off() -> None:
    assert midair.Board("autd3", moved(300, [2e-3, 0, -2e-3])).boards == 2


@pytest.mark.parametrize("hz", [0.0625, 1, 37, 137.5, 150, 200, 440.1, 999, 1000])
def test_sines_have_whole_periods(hz: float) -> None:
    buffer = np.frombuffer(commands._sine(hz), np.uint8)
    assert 4 <= len(buffer) <= 65536
    periods = hz * len(buffer) / 4000
    assert periods == pytest.approx(round(periods), abs=1e-6)
    wanted = 127.5 * (1 + np.sin(2 * np.pi * hz * np.arange(len(buffer)) / 4000))
    assert np.abs(buffer - wanted).max() <= 0.5 + 1e-6


def test_the_nearest_sine_that_is_reported_can_be_had() -> None:
    with pytest.raises(BoardError) as caught:
        commands.modulation(100.00001)
    reported = str(caught.value)
    assert "modulation at 100.00001 Hz: no whole number of periods fits the 65536 samples" in reported
    commands.modulation(float(reported.split()[-2]))


LIMITS = {
    "slow sine": (
        lambda: commands.modulation(0.01),
        "modulation at 0.01 Hz: an AUTD3 board modulates at 0.0610352 to 1000 Hz",
    ),
    "fast sine": (lambda: commands.modulation(1000.5), "modulation at 1000.5 Hz"),
    "no sine": (lambda: commands.modulation(math.nan), "modulation at nan Hz"),
    "rate between": (
        lambda: commands.divider(999),
        "rate 999 frames/s: an AUTD3 board plays 40 kHz divided by a whole number",
    ),
    "nearest rate": (lambda: commands.divider(3e4), "the nearest is 40000"),
    "no rate": (lambda: commands.divider(0.0), "rate 0 frames/s"),
    "endless rate": (lambda: commands.divider(math.inf), "rate inf frames/s"),
    "slow rate": (lambda: commands.divider(0.5), "the nearest is 0.610360875868"),
    "short frame": (
        lambda: commands.pattern(bytes(497), 1, NEWER),
        "1 frame for 1 AUTD3 board: 497 bytes, not 498; give 498 a board and frame",
    ),
    "frame of more boards": (
        lambda: commands.pattern(bytes(996), 1, NEWER),
        "1 frame for 1 AUTD3 board: 996 bytes, not 498",
    ),
    "one frame": (lambda: sequence(1), "sequence of 1 frame: an AUTD3 board holds 2 to 1024"),
    "too many frames": (lambda: sequence(1025), "sequence of 1025 frames: an AUTD3 board holds 2 to 1024"),
    "frames cut off": (
        lambda: sequence(5, bytes(498 * 4)),
        "5 frames for 1 AUTD3 board: 1992 bytes, not 2490",
    ),
    "IPv4": (
        lambda: Autd3Transport("autd3:192.168.0.2", 1),
        "autd3:192.168.0.2: '192.168.0.2' is no network interface: give lo",
    ),
    "no place": (lambda: Autd3Transport("autd3:", 1), "or an IPv6 address and port, as autd3:[fe80::1%eth0]"),
    "port left out": (lambda: Autd3Transport("autd3:[::1]", 1), "'[::1]' is no network interface"),
    "port above 65535": (lambda: Autd3Transport("autd3:[::1]:70000", 1), "is no network interface"),
    "no network": (lambda: Autd3Transport("autd3:nope7", 1), "autd3:nope7: 'nope7' is no network interface"),
    "no boards": (lambda: Autd3Transport("autd3", 0), "autd3: 0 boards, give 1 to 128"),
    "many boards": (lambda: Autd3Transport("autd3", 129), "129 boards"),
}
NEWER = commands.PROTOCOLS[5]


def sequence(count: int, frames: bytes | None = None) -> object:
    given = bytes(498 * count) if frames is None else frames
    return commands.sequence(given, count, 1, 40, 0, NEWER)


@pytest.mark.parametrize("name", LIMITS)
def test_limits_are_reported_in_one_line(name: str) -> None:
    ask, reported = LIMITS[name]
    with pytest.raises(BoardError) as caught:
        ask()
    assert reported in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("rate", [40000, 20000, 40000 / 3, 1000, 40000 / 65535])
def test_rates_are_whole_periods(rate: float) -> None:
    assert commands.divider(rate) == round(40000 / rate)


def python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, encoding="utf-8").stdout


@pytest.mark.slow
def test_boards_need_no_package_of_the_makers() -> None:
    listed = "[name for name in sys.modules if name.startswith('autd3')]"
    assert python(f"import sys, midair, midair._boards.autd3; print({listed})").strip() == "[]"


@pytest.mark.slow
def test_the_missing_extra_is_named() -> None:
    code = "try: module.Autd3Transport('autd3:emulator', 1)\nexcept Exception as error: print(repr(error))"
    assert (
        python(f"import sys, midair._boards.autd3 as module; sys.modules['autd3'] = None\n{code}").strip()
        == """BoardError('autd3:emulator needs autd3: pip install "midair[autd3]"')"""
    )
