"""The bytes sent to boards, read back by the models of the boards' firmware in firmware.py."""

import numpy as np
import pytest

import firmware
import midair
from firmware import KINDS
from midair._boards.board import Board
from rigs import (
    CASES,
    LENGTHS,
    TICKS,
    TURN,
    TURNING,
    WIDTHS,
    Rig,
    assert_nearest,
    decoded,
    every,
    forbidden,
    full,
    made,
    of_kind,
    off_grid,
    playable,
    played,
    received,
    single,
)

#: Numbers of random frames: few enough that the models, which work byte by byte, take a second or two.
FRAMES = {
    ("autd3", 2): 500,
    ("autd3", 4): 250,
    ("sonicsurface", 2): 500,
    ("mega64", 2): 300,
    ("mega64", 3): 200,
    ("mega64", 14): 10,
    ("openmpd", 2): 300,
    ("homies", 1): 500,
    ("homies", 2): 500,
}


# Drives that the board can play exactly


@every
def test_drives_on_the_grid_come_back(case: tuple[str, int]) -> None:
    board, rig = made(case)
    rng = np.random.default_rng(16)
    phases = np.arange(board.limits["phases"]) / board.limits["phases"]
    amplitudes = board.limits["amplitudes"]
    own = playable(case[0])
    for frame in range(FRAMES.get(case, 1000)):
        size = len(board.array)
        on_grid = rng.choice(amplitudes, size) * np.exp(TURNING * rng.choice(phases, size))
        uneven = isinstance(LENGTHS.get(case[0]), tuple)
        wanted = rng.choice(own, size) if frame % 2 or uneven else on_grid
        got = played(board, rig, wanted)
        free = forbidden(case[0], wanted)
        assert np.abs(got - wanted)[~free].max() < 1e-6
        assert np.abs(got - wanted)[free].max(initial=0) < 1.001 * 2 * np.pi / 256


@single
def test_every_drive_that_the_firmware_can_play_comes_back(kind: str) -> None:
    board, rig = of_kind(kind)
    own = playable(kind)
    if kind in TICKS:
        widths = WIDTHS.get(kind, (0, 1))
        assert len(own) == TICKS[kind] * len(widths)
    size = len(board.array)
    for wanted in np.resize(own, (-(-len(own) // size), size)):
        free = forbidden(kind, wanted)
        assert np.abs(played(board, rig, wanted) - wanted)[~free].max() < 1e-6


@pytest.mark.parametrize("code", [0x55, 0xAA])
def test_homies_never_sends_the_phases_that_frame_its_words(code: int) -> None:
    board, rig = of_kind("homies")
    played(board, rig, np.exp(TURNING / 256 * np.full(256, code)))
    for line in rig.lines:
        assert isinstance(line, firmware.Homies)
        assert set(line.phases) in ({code - 1}, {code + 1})


@every
def test_any_number_of_transducers_may_be_on(case: tuple[str, int]) -> None:
    board, rig = made(case)
    size = len(board.array)
    for on in {0, 1, 2, 3, size // 2, size - 2, size - 1, size}:
        wanted = (np.arange(size) < on).astype(complex)
        np.testing.assert_allclose(played(board, rig, wanted), wanted * full(case[0]), atol=1e-6)


def test_autd3_intensities_are_pressures_within_half_a_tick_of_the_pulse_width() -> None:
    board, rig = of_kind("autd3")
    got = np.abs(played(board, rig, np.resize(np.arange(256) / 255, len(board.array))))
    (line,) = rig.lines
    assert isinstance(line, firmware.Autd3)
    assert np.abs(np.sin(np.pi / 512 * line.pulse_widths) - got).max() <= np.pi / 1024


# The channel of each transducer


def sonicsurface_channel(x: float, z: float) -> int:
    row, column = round((78.75 - 1e3 * z) / 10.5), round((1e3 * x + 78.75) / 10.5)
    return 64 * (column // 4) + 8 * (row // 2) + [[0, 7, 1, 2], [4, 3, 6, 5]][row % 2][column % 4]


def openmpd_pin(x: float, y: float) -> int:
    i, k = round((1e3 * x + 78.75) / 10.5), round((78.75 - 1e3 * y) / 10.5)
    return 64 * (3 - i // 4) + 8 * (7 - k // 2) + [[1, 0, 3, 2], [5, 4, 6, 7]][k % 2][i % 4]


def test_channels_of_a_sonicsurface_are_those_at_its_positions() -> None:
    board, _ = made(("sonicsurface", 1))
    # The board's own coordinates (x, 0, z), normal +y, are midair's (x, -z, 0), normal +z.
    assert list(board.channels) == [sonicsurface_channel(x, -y) for x, y, _ in board.array.positions]
    assert sorted(board.channels) == list(range(256))


def test_channels_of_two_sonicsurfaces_are_those_of_one_and_the_other() -> None:
    one, two = made(("sonicsurface", 1))[0], made(("sonicsurface", 2))[0]
    assert list(two.channels) == [*one.channels, *(256 + one.channels)]


def test_channels_of_openmpd_are_its_pins() -> None:
    board, _ = made(("openmpd", 2))
    positions = board.array.positions.copy()
    normals = board.array.normals
    upper = normals[:, 2] < 0
    assert list(np.flatnonzero(upper)) == list(range(256, 512))
    positions[upper, 0] *= -1  # the upper board is the lower one rotated by diag(-1, 1, -1)
    assert list(board.channels) == [
        256 * above + openmpd_pin(x, y) for (x, y, _), above in zip(positions, upper, strict=True)
    ]
    alone, _ = made(("openmpd", 1))
    assert list(alone.channels) == list(board.channels[:256])
    np.testing.assert_allclose(alone.array.positions[:, :2], positions[:256, :2], atol=1e-9)


@pytest.mark.parametrize("case", [case for case in CASES if case[0] not in ("sonicsurface", "openmpd")])
def test_channels_of_the_others_are_the_transducers_one_by_one(case: tuple[str, int]) -> None:
    board, _ = made(case)
    assert list(board.channels) == list(range(len(board.array)))


def test_boards_of_autd3_follow_one_another_along_x_then_y() -> None:
    one, four = made(("autd3", 1))[0].array.positions, made(("autd3", 4))[0].array.positions
    for k in range(4):
        shift = four[249 * k] - four[0]
        np.testing.assert_allclose(shift, [0.192 * (k % 2), 0.1514 * (k // 2), 0], atol=1e-9)
        np.testing.assert_allclose(four[249 * k : 249 * (k + 1)] - four[249 * k], one - one[0], atol=1e-9)


def test_a_channel_is_noticed_on_its_own_transducer_alone() -> None:
    for case in [("sonicsurface", 2), ("openmpd", 2), ("mega64", 3), ("nano16", 1), ("nano", 1)]:
        board, rig = made(case)
        for t in np.linspace(0, len(board.array) - 1, 8, dtype=int):
            wanted = np.zeros(len(board.array), complex)
            wanted[t] = 1
            np.testing.assert_allclose(played(board, rig, wanted), wanted * full(case[0]), atol=1e-6)


# Drives that the board must round


@every
def test_off_the_grid_nothing_is_further_than_half_a_step_and_no_pulse_is_nearer(
    case: tuple[str, int],
) -> None:
    board, rig = made(case)
    rng = np.random.default_rng(17)
    kind, phases, amplitudes = case[0], board.limits["phases"], board.limits["amplitudes"]
    for _ in range(5 if kind in WIDTHS else 100):
        wanted = off_grid(rng, len(board.array))
        got = played(board, rig, wanted)
        if kind in WIDTHS:
            assert_nearest(kind, got, wanted)
            wanted /= np.abs(wanted)
            assert_nearest(kind, played(board, rig, wanted), wanted)
            continue
        on = np.abs(got) > 1e-9
        turn = np.angle(got[on] / wanted[on])
        half = np.where(forbidden(kind, wanted[on]), 1.5, 0.5)
        assert (np.abs(turn) <= half * 2 * np.pi / phases + 1e-6).all()
        nearest = np.abs(np.abs(wanted)[:, None] - amplitudes).min(axis=1)
        assert (np.abs(np.abs(got) - np.abs(wanted)) <= nearest + 1e-6).all()


@single
def test_corrections_are_taken_off_before_rounding(kind: str) -> None:
    plain, rig = of_kind(kind)
    rng = np.random.default_rng(25)
    size = len(plain.array)
    corrections = rng.uniform(-10, 10, size)
    board = Board(kind, plain.array, corrections=corrections)
    for _ in range(20):
        wanted = off_grid(rng, size)
        sent = wanted * np.exp(-1j * corrections)
        got = played(board, rig, wanted)
        np.testing.assert_array_equal(got, played(plain, rig, sent))
        received = got * np.exp(1j * corrections)
        np.testing.assert_allclose(board.decode(board.encode(wanted)), received, atol=1e-6)


@single
def test_channels_of_ones_own_are_kept_and_the_others_are_off(kind: str) -> None:
    plain, rig = of_kind(kind)
    rng = np.random.default_rng(26)
    size = len(plain.array)
    played(plain, rig, np.ones(size))
    some = size // 2 + 1
    channels = rng.permutation(size)[:some]
    positions = plain.array.positions[:some]
    board = Board(kind, midair.Array(positions), channels=channels)
    wanted = np.exp(TURNING * rng.integers(0, 2, some) / 2)
    rig = Rig(kind, board.boards)
    got = played(board, rig, wanted)
    if kind in WIDTHS:
        assert_nearest(kind, got, wanted)
    else:
        np.testing.assert_allclose(got, wanted, atol=1e-6)
    assert np.count_nonzero(np.abs(rig.drive) > 1e-9) == some


@single
def test_ties_go_one_way_wherever_they_come(kind: str) -> None:
    board, rig = of_kind(kind)
    size, phases = len(board.array), board.limits["phases"]
    for tie in (np.arange(phases) + 0.5) / phases:
        got = played(board, rig, np.full(size, np.exp(TURNING * tie)))
        assert np.ptp(got.real) + np.ptp(got.imag) < 1e-9
        assert abs(np.angle(got[0] / np.exp(TURNING * tie))) <= (3 if kind == "homies" else 1) * np.pi / phases + 1e-6
    for amplitude in np.array([0.5]) if kind not in WIDTHS else np.sin(np.pi * 1.5 / TICKS[kind]) * np.ones(1):
        got = np.abs(played(board, rig, np.full(size, amplitude)))
        assert np.ptp(got) < 1e-9


@single
@pytest.mark.parametrize("turn", [-1e-17, 0.0, -0.0, 2 * np.pi, -2 * np.pi, 1e6, -1e6, 1e-300])
def test_phases_next_to_a_whole_turn_and_far_from_it(kind: str, turn: float) -> None:
    board, rig = of_kind(kind)
    phases = board.limits["phases"]
    wanted = np.exp(1j * turn)
    if kind in WIDTHS:
        assert_nearest(kind, played(board, rig, np.full(len(board.array), wanted)), wanted)
        fixed = Board(board.name, board.array, corrections=np.full(len(board.array), turn))
        assert_nearest(kind, played(fixed, rig, np.ones(len(board.array))), np.exp(-1j * turn))
        return
    nearest = np.exp(TURNING / phases * np.floor((turn % (2 * np.pi)) / 2 / np.pi * phases + 0.5))
    np.testing.assert_allclose(played(board, rig, np.full(len(board.array), wanted)), nearest, atol=1e-6)
    # A correction is a phase, not a complex factor: it is subtracted from the phase before rounding.
    fixed = Board(board.name, board.array, corrections=np.full(len(board.array), turn))
    back = np.floor(((-turn) % (2 * np.pi)) / 2 / np.pi * phases + 0.5)
    got = played(fixed, rig, np.ones(len(board.array)))
    np.testing.assert_allclose(got, np.exp(TURNING / phases * back), atol=1e-6)


@single
def test_minus_zero_and_tiny_imaginary_parts_leave_the_board_on(kind: str) -> None:
    board, rig = of_kind(kind)
    for drive in (
        complex(1, -0.0),
        complex(1, -1e-17),
        complex(1, -1e-45),
        complex(-1, -0.0),
        complex(-1, 1e-300),
    ):
        got = played(board, rig, np.full(len(board.array), drive))
        if kind in WIDTHS:
            assert_nearest(kind, got, drive)
        else:
            np.testing.assert_allclose(got, np.sign(drive.real), atol=1e-6)


@every
@pytest.mark.parametrize("value", [np.nan, complex(0, np.nan), np.inf, -np.inf, 1.01, 1 + 1j, 1e300])
def test_what_is_no_drive_is_refused(case: tuple[str, int], value: complex) -> None:
    board, _ = made(case)
    drive = np.ones(len(board.array), complex)
    drive[-1] = value
    with pytest.raises(ValueError, match=rf"drive\[{len(drive) - 1}\]") as refusal:
        board.encode(drive)
    assert "\n" not in str(refusal.value)


@every
def test_drives_of_another_length_are_refused(case: tuple[str, int]) -> None:
    board, _ = made(case)
    size = len(board.array)
    for drive in (np.ones(size - 1), np.ones(size + 1), np.ones(0), np.ones((1, size)), np.ones((size, 1))):
        with pytest.raises(ValueError, match="drive") as refusal:
            board.encode(drive)
        assert "\n" not in str(refusal.value)


# Decoding of frames


@every
def test_decode_says_what_the_firmware_plays(case: tuple[str, int]) -> None:
    board, rig = made(case)
    rng = np.random.default_rng(19)
    for _ in range(3 if case == ("mega64", 14) else 30):
        frame = board.encode(off_grid(rng, len(board.array)))
        got = received(board, rig, frame)
        np.testing.assert_allclose(board.decode(frame), got, atol=1e-6)
        assert board.encode(board.decode(frame)) == frame


@every
def test_broken_frames_are_refused_in_a_line_or_read_as_they_are_played(case: tuple[str, int]) -> None:
    board, _ = made(case)
    rng = np.random.default_rng(20)
    frame = board.encode(off_grid(rng, len(board.array)))
    step = max(1, len(frame) // 256)
    for at in range(int(rng.integers(step)), len(frame), step):
        broken = bytearray(frame)
        broken[at] = (broken[at] + rng.integers(1, 256)) % 256
        read = decoded(board, bytes(broken))
        odd = case[0] == "homies" and at % 8 == 1 and broken[at] % 2 == 1
        if read is not None and case[1] < 14 and not odd:
            rig = Rig(*case)
            rig.receive(board.off_frame)
            got = received(board, rig, bytes(broken))
            np.testing.assert_allclose(read, got, atol=1e-6, err_msg=f"byte {at}: {frame[at]} -> {broken[at]}")


def test_a_burst_of_homies_with_an_odd_count_is_refused_or_read_as_it_is_played() -> None:
    board, rig = made(("homies", 1))
    frame = bytearray(board.encode(np.exp(TURNING * np.arange(128) / 128)))
    assert frame[:8].hex() == "55000100000200aa"
    frame[1] = 1
    read = decoded(board, bytes(frame))
    if read is not None:
        got = rig.play(bytes(frame), board.channels) / TURN["homies"]
        np.testing.assert_allclose(read, got, atol=1e-6)


@every
def test_frames_are_as_long_as_the_line_is_reported(case: tuple[str, int]) -> None:
    kind, boards = case
    board, _ = made(case)
    length = KINDS[kind].length(boards)
    rng = np.random.default_rng(27)
    for frame in (board.off_frame, *(board.encode(off_grid(rng, len(board.array))) for _ in range(3))):
        assert len(frame) == length
    if board.baud:
        assert board.rate == pytest.approx(board.baud / 10 / length)


@every
def test_frames_that_are_cut_or_too_long_are_refused(case: tuple[str, int]) -> None:
    board, _ = made(case)
    frame = board.encode(np.ones(len(board.array)))
    cuts = np.unique(np.linspace(0, len(frame) - 1, 60, dtype=int))
    for broken in [*(frame[:cut] for cut in cuts), frame + b"\x00", frame + b"\x20", frame + frame]:
        assert decoded(board, broken) is None


# Pressure at a focus

#: Place of the focus in m for some kinds, near the board or off its axis: there the conjugate drive is weak.
FOCI = {"nano": (0.054, -0.021, 0.041), "nano16": (-0.024, -0.035, 0.097), "openmpd": (0.02, -0.01, 0.1)}


@every
def test_a_focus_keeps_its_pressure_and_its_sign(case: tuple[str, int]) -> None:
    board, rig = made(case)
    kind, phases = case[0], board.limits["phases"]
    point = np.array(FOCI.get(kind, (0.03, 0.02, 0.12)))
    k = 2 * np.pi * 40e3 / 340
    r = np.linalg.norm(board.array.positions - point, axis=1)
    paths = np.exp(1j * k * r) / r
    wanted = np.exp(-1j * k * r)
    got = np.abs(paths @ played(board, rig, wanted))
    ideal = np.sum(1 / r)
    codes = np.floor(-k * r / 2 / np.pi * phases + 0.5)
    nearest = np.abs(paths @ np.exp(TURNING / phases * codes))
    if kind in WIDTHS:
        own = playable(kind)
        nearest = np.abs(paths @ own[[np.abs(own - q).argmin() for q in wanted]])
    assert got == pytest.approx(nearest, rel=0.01 if kind == "homies" else 1e-5)
    # Rounding to L phases lowers the pressure to sinc(1/L) on average: 1.6 % less for L = 10, 0.2 % for 32.
    # Half of a MEGA64's pulses are a tick shorter, a factor cos(pi/10), and shifted by half a step.
    short = np.sinc(0.5 / phases) * (1 + np.cos(np.pi / phases)) / 2
    assert got > (0.99 if phases > 10 else 0.99 * short) * ideal
    assert np.abs(paths @ played(board, rig, wanted.conj())) < 0.3 * ideal


def test_a_drive_so_weak_that_the_board_stays_off_has_a_warning() -> None:
    board = Board("sonicsurface")
    drive = np.full(256, 0.3 + 0j)
    with pytest.warns(midair.SceneWarning, match="the drive is at most 0.30: sonicsurface switches all"):
        assert board.encode(drive) == board.off_frame
    assert board.encode(0 * drive) == board.off_frame
    drive[7] = 1
    assert board.encode(drive) != board.off_frame
    for kind in KINDS:
        board = Board(kind)
        assert board.encode(np.full(len(board.array), 0.51 + 0j)) != board.off_frame, kind
