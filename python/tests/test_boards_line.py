"""The rate of a serial line, by a simulated clock that advances only while something waits."""

import itertools

import numpy as np
import pytest

from midair._boards import transport
from midair._boards.transport import LineTransport


class Clock:
    """Replaces the module `time`. Each wait ends late by the next value of `late`."""

    def __init__(self):
        self.now = 100.0
        self.late = itertools.repeat(0.0)

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        assert seconds >= 0
        self.now += seconds + next(self.late)


class Stop:
    """Replaces the event that ends modulation: it is set once the clock is at `end`."""

    def __init__(self, clock, end):
        self.clock, self.end = clock, end

    def wait(self, seconds):
        self.clock.sleep(seconds)
        return self.is_set()

    def is_set(self):
        return self.clock.now >= self.end


class Kept(LineTransport):
    def __init__(self, clock):
        super().__init__(baud=230400, silence="97", off="20", swap="fd")
        self.clock = clock
        self.kept = []

    def _write(self, content):
        self.kept.append((self.clock.now, content))

    def look(self):
        pass

    def close(self):
        pass

    def times(self):
        return np.array([at for at, _ in self.kept])


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(transport, "time", clock)
    # Without `os`, the transport does not give the tests' process a real-time priority.
    monkeypatch.setattr(transport, "os", None)
    return clock


def test_one_frame_waits_behind_the_one_that_the_line_carries(clock):
    kept = Kept(clock)
    for _ in range(10):
        kept.play(bytes(258))
    frame = 258 * 10 / 230400
    np.testing.assert_allclose(kept.times() - 100, np.r_[0, np.arange(9)] * frame, atol=1e-9)


def test_less_of_a_long_frame_waits(clock):
    kept = Kept(clock)
    for _ in range(3):
        kept.play(bytes(2304))
    np.testing.assert_allclose(kept.times() - 100, [0, 0.1 - 0.025, 0.2 - 0.025], atol=1e-9)


def test_silence_waits_for_nothing(clock):
    kept = Kept(clock)
    kept.play(bytes(258))
    kept.play(bytes(258))
    kept.silence()
    assert kept.kept[-1] == (100.0, b"\x97")


def test_silence_that_is_in_the_line_is_not_sent_again(clock):
    kept = Kept(clock)
    kept.play(bytes(258))
    for _ in range(60):
        kept.silence()
    assert [content for _, content in kept.kept] == [bytes(258), b"\x97"]
    # A frame after it waits no longer than behind a single silence.
    begin = clock.now
    kept.play(bytes(258))
    assert clock.now - begin < 2 * 258 * 10 / 230400
    # Once the line is free, the board may have been off its supply meanwhile.
    kept.silence()
    clock.now += 1
    kept.silence()
    assert [content for _, content in kept.kept[2:]] == [bytes(258), b"\x97", b"\x97"]


def swings(kept, seconds, hz=200):
    kept._swing(Stop(kept.clock, 100 + seconds), 100.0, 0.5 / hz)
    return kept.times() - 100


def test_swaps_are_evenly_spaced(clock):
    times = swings(Kept(clock), 1.0001)
    np.testing.assert_allclose(times, np.arange(1, 401) / 400, atol=1e-9)


def test_swaps_that_come_late_do_not_drift(clock):
    clock.late = iter(np.random.default_rng(0).uniform(0, 2e-3, 1000))
    times = swings(Kept(clock), 1.01)[:400]
    late = times - np.arange(1, 401) / 400
    assert (late >= -1e-9).all()
    assert (late < 2e-3).all()


def test_swaps_that_were_delayed_stay_in_step(clock):
    clock.late = itertools.chain([0.0] * 10, [0.5031], itertools.repeat(0.0))
    times = swings(Kept(clock), 1.0001)
    assert np.count_nonzero(np.diff(times) < 1e-9) <= 2
    later = times[times > 0.6]
    # The odd swaps play the frame, as before.
    first = np.searchsorted(times, 0.6)
    assert [round(at * 400) % 2 for at in later] == [(first + 1 + k) % 2 for k in range(len(later))]


def test_a_swap_that_fails_is_reported_at_the_next_call(clock, monkeypatch):
    kept = Kept(clock)
    kept.play(bytes(258))

    def fails(content):
        raise transport.BoardError("gone")

    monkeypatch.setattr(kept, "_write", fails)
    swings(kept, 1)
    monkeypatch.undo()
    with pytest.raises(transport.BoardError, match="gone"):
        kept.play(bytes(258))
    kept.play(bytes(258))
