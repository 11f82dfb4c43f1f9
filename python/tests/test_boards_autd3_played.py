"""The output of emulated AUTD3 boards, sample by sample, for all calls of a transport."""

from collections.abc import Callable
from typing import Any

import autd3
import numpy as np
import pytest
from autd3_emulator import Emulator, Recorder

from autd3_boards import codes, frame, some_boards, some_poses, widths
from autd3_makers import OLDER, do, geometry
from midair._boards import autd3 as module
from midair._boards.autd3 import Autd3Transport
from midair._boards.autd3_commands import Step

BOARDS = 2
ARRAY = some_boards(BOARDS)
RNG = np.random.default_rng(1)
#: Drives whose phases never pass the end of the cycle, because the emulator's silencer fails there.
DRIVES = RNG.uniform(0, 1, (9, len(ARRAY))) * np.exp(2j * np.pi * RNG.integers(64, 192, (9, len(ARRAY))) / 256)
WANTED = [np.concatenate([phase.ravel(), widths(amplitude).ravel()]) for phase, amplitude in map(codes, DRIVES)]


class Reported:
    """A link that stores its steps for a `Recorder`, which must stay in one thread."""

    protocol = OLDER

    def __init__(self) -> None:
        self.log: list[Step | int] = []

    def open(self, address: str, boards: int) -> "Reported":
        assert (address, boards) == ("autd3", BOARDS)
        return self

    def send(self, step: Step, wanted: Callable[[], bool] = lambda: True) -> list[bytes]:
        assert wanted()
        self.log.append(step)
        return [b""] * BOARDS

    def look(self) -> None:
        """Does nothing: this link loses no datagram."""

    def close(self) -> None:
        """Does nothing: this link has no socket."""


GEOMETRY = geometry(some_poses(BOARDS))


@pytest.fixture
def reported(monkeypatch: pytest.MonkeyPatch) -> Reported:
    made = Reported()
    monkeypatch.setattr(module, "Link", made.open)
    return made


def samples(reported: Reported) -> np.ndarray:
    """Returns phases and pulse widths (T, 2 N), from the steps and the waits between them."""

    def play(recorder: Recorder) -> None:
        for each in reported.log:
            if isinstance(each, int):
                recorder.tick(autd3.Duration.from_micros(25 * each))
            else:
                do(recorder, each)

    record = Emulator(GEOMETRY).record(play)
    return np.concatenate([record.phase().to_numpy().T, record.pulse_width().to_numpy().T], axis=1)


def sequence(*which: int) -> bytes:
    return b"".join(frame(DRIVES[k]) for k in which)


def test_one_thing_after_the_other(reported: Reported) -> None:
    boards = Autd3Transport("autd3", BOARDS)
    steps: list[tuple[Any, set[int | None]]] = [
        (lambda: None, {None}),
        (lambda: boards.play(frame(DRIVES[0])), {0}),
        (lambda: boards.play(frame(DRIVES[1])), {1}),
        (lambda: boards.upload(sequence(2, 3), 2, 40000), {2, 3}),
        (lambda: boards.upload(sequence(4, 5, 6), 3, 20000), {4, 5, 6}),
        (lambda: boards.upload(sequence(7, 8), 2, 1000), {7, 8}),
        (lambda: boards.play(frame(DRIVES[0])), {0}),
        (lambda: boards.upload(sequence(1, 2, 3), 3, 8000), {1, 2, 3}),
        (boards.silence, {None}),
        (boards.silence, {None}),
        (lambda: boards.upload(sequence(4, 5), 2, 800), {4, 5}),
        (boards.close, {None}),
    ]
    # Each step lasts twice as long as the slowest sequence. The silencer has the first half to settle.
    half = 120
    for act, _ in steps:
        act()
        reported.log.append(2 * half)
    played = samples(reported).reshape(len(steps), 2 * half, -1)[:, half:]
    for (_, expected), rows in zip(steps, played, strict=True):
        seen = [played_by(row) for row in rows]
        assert set(seen) - {-1} == expected
        assert seen.count(-1) <= (0 if len(expected) < 2 else 39 * half // 40)


def played_by(row: np.ndarray) -> int | None:
    """Returns the index of the drive that plays:
    None if the board is silent, -1 during a change between two drives.
    """
    if not row[len(ARRAY) :].any():
        return None
    return next((k for k, wanted in enumerate(WANTED) if np.array_equal(row, wanted)), -1)


def test_modulation_goes_on_over_frames_and_silence(reported: Reported) -> None:
    boards = Autd3Transport("autd3", BOARDS)
    boards.modulate(500)
    for _ in range(2):
        boards.play(frame(np.ones(len(ARRAY))))
        reported.log.append(800)
        boards.silence()
        reported.log.append(800)
    boards.play(frame(np.ones(len(ARRAY))))
    boards.modulate(None)
    reported.log.append(800)
    boards.close()
    widest = samples(reported)[:, len(ARRAY)].reshape(5, 800)[:, 100:]
    for k in (0, 2):
        assert widest[k].min() < 5
        assert widest[k].max() > 240
        # One period of 500 Hz is 80 samples.
        assert np.array_equal(widest[k][80:], widest[k][:-80])
    assert not widest[[1, 3]].any()
    assert (widest[4] == 256).all()
