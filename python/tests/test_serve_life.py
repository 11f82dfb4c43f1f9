"""Who may keep a board emitting: random histories of `Life`, and real ones of servers on simulated boards.

MIDAIR_SLOW=1 (`make test-serve`) checks 1,000,000 histories of `Life` and 1,000 real ones.
"""

from __future__ import annotations

import json
import math
import os
import random
import re
import socket
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable, Hashable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
import tactons
from midair._boards.transport import before_what_computes
from midair._serve.life import HAND, MOST_SOURCES, SILENCE, Life

SLOW = bool(os.environ.get("MIDAIR_SLOW"))
HISTORIES = 1_000_000 if SLOW else 5_000
REAL = 1000 if SLOW else 8

#: Number of events of a history; the sources and the trackers, of which one is also a source.
EVENTS, SOURCES, TRACKERS = 16, ("page", "game", "phone"), ("page", "tracker")

#: Time in s of a tick, of which no whole number is SILENCE or HAND; the largest number of ticks within each.
TICK = SILENCE / 20.5
SILENT, UNSEEN = 20, math.floor(HAND / TICK)

#: Ticks between two events.
GAPS = (0, 0, 1, 3, 8, SILENT - 1, SILENT, SILENT + 1, 2 * SILENT, UNSEEN - SILENT, UNSEEN, UNSEEN + 1)


class Ticks:
    """Plain oracle of `Life`: counts the ticks since each sign, and stops the player when they are over."""

    def __init__(self) -> None:
        self.player: Hashable | None = None
        self.tracked = False
        self.silent: dict[Hashable, float] = dict.fromkeys((*SOURCES, *TRACKERS), math.inf)
        self.hand: tuple[Hashable, float] | None = None

    def pass_(self, ticks: int) -> None:
        self.silent = {source: age + ticks for source, age in self.silent.items()}
        if self.hand is not None:
            self.hand = self.hand[0], self.hand[1] + ticks
        if self.player is not None and self.silent[self.player] > SILENT:
            self.player = None

    def sign(self, source: Hashable, ago: int) -> None:
        self.silent[source] = min(self.silent[source], ago)

    def play(self, source: Hashable, tracked: bool) -> None:
        if self.silent[source] <= SILENT:
            self.player, self.tracked = source, tracked

    def leave(self, source: Hashable) -> None:
        self.silent[source] = math.inf
        self.lose(source)
        if self.player == source:
            self.player = None

    def lose(self, tracker: Hashable) -> None:
        if self.hand is not None and self.hand[0] == tracker:
            self.hand = None

    @property
    def emits(self) -> bool:
        return self.player is not None and (not self.tracked or (self.hand is not None and self.hand[1] <= UNSEEN))


def wrong(make: Callable[[], Life], seed: int) -> list[tuple[int, int, str, str]]:
    """Plays one random history; returns the events up to the first disagreement, empty if there is none.

    An event is its tick, its kind, and the source and the tracker that it may be about.
    """
    draws = random.Random(seed).randbytes(3 * EVENTS)
    life, oracle, now = make(), Ticks(), 0
    told: list[tuple[int, int, str, str]] = []
    for k in range(EVENTS):
        act, who, gap = draws[3 * k : 3 * k + 3]
        ticks = GAPS[gap % len(GAPS)]
        now += ticks
        oracle.pass_(ticks)
        source, tracker = SOURCES[who % 3], TRACKERS[who % 2]
        told.append((now, act % 12, source, tracker))
        if act % 12 < 5:
            # It came `ago` ticks before it is seen, unless its source would have stopped meanwhile.
            ago = gap % 7 if oracle.silent[source] <= SILENT else 0
            life.sign(source, (now - ago) * TICK)
            oracle.sign(source, ago)
        if act % 12 in (3, 4, 5):
            life.play(source, now * TICK, tracked=bool(who & 8))
            oracle.play(source, bool(who & 8))
        elif act % 12 == 6:
            life.off()
            oracle.player = None
        elif act % 12 == 7:
            left = (*SOURCES, *TRACKERS)[who % 5]
            life.leave(left)
            oracle.leave(left)
        elif act % 12 in (8, 9):
            life.hand(tracker, now * TICK)
            oracle.hand = tracker, 0
        elif act % 12 == 10:
            life.hand(tracker, None)
            oracle.lose(tracker)
        if who & 16 and (life.left(now * TICK) > 0) != oracle.emits:
            return told
    return told if (life.left(now * TICK) > 0) != oracle.emits else []


def test_no_history_lets_a_board_emit_without_its_source_and_none_silences_one_that_lives() -> None:
    for seed in range(HISTORIES):
        told = wrong(Life, seed)
        assert not told, (seed, told)


class AnybodysSigns(Life):
    def sign(self, source: Hashable, at: float) -> None:
        super().sign(source if self.player is None else self.player, at)


class LateReturn(Life):
    def sign(self, source: Hashable, at: float) -> None:
        self._signs[source] = at


class StalePoints(Life):
    def play(self, source: Hashable, now: float, *, tracked: bool = False) -> bool:
        self.sign(source, now)
        return super().play(source, now, tracked=tracked)


class StayingHand(Life):
    def leave(self, source: Hashable) -> None:
        hand = self._hand
        super().leave(source)
        self._hand = hand


@pytest.mark.parametrize("faulty", [AnybodysSigns, LateReturn, StalePoints, StayingHand])
def test_the_histories_see_each_fault(faulty: type[Life]) -> None:
    assert any(wrong(faulty, seed) for seed in range(5_000))


def test_sources_without_number_do_not_make_the_player_forgotten() -> None:
    life = Life()
    life.sign("game", 0.0)
    assert life.play("game", 0.0)
    for k in range(10 * MOST_SOURCES):
        life.sign(k, 0.1)
    assert life.left(0.1) == pytest.approx(0.1)
    assert len(life._signs) <= MOST_SOURCES


#: Frames per second of the real servers, and how many run at once. Time in s by which a busy computer may be
#: late.
RATE, STAGES, LATE = 50.0, 8, 0.8

#: A pattern that ends after 300 ms, and one without an end.
ENDING, ENDLESS = (
    json.dumps(tactons.pattern([tactons.keyframe(0, (0, 0, 50), None, 1), last], {"on": (1, 0, 1)}))
    for last in (
        {"time": 300, "type": "stop"},
        tactons.keyframe(100, (5, 0, 50), None, 1, jumps=(("on", "gt", 0, 0),)),
    )
)


#: How the playback of each kind of player may end, and after how many s the board is off then: it sends no
#: more, closes its connection, another client switches it off, its pattern of 0.3 s ends; the hand is not
#: seen, not told of, or its tracker leaves.
ENDS = {
    "game": {"hang": SILENCE, "leave": 0, "off": 0},
    "phone": {"hang": SILENCE, "off": 0},
    "page": {"leave": 0, "off": 0, "end": 0.3},
    "hand": {"leave": 0, "off": 0, "unseen": 0, "untold": HAND, "untracked": 0},
}


def tracked(hand: bool) -> str:
    """Returns the message of a program that tracks a hand, which it sees or not."""
    frame = {"hand": {"palm": {"position": {"x": 0, "y": 0, "z": 100}}} if hand else None}
    return json.dumps({"cmd": "tracking_data", "data": {"tracking_frame": frame}})


class Pulse(threading.Thread):
    """Measures by how much this program itself is late, because the computer is busy."""

    PERIOD, NOTED = 0.01, 0.01

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self._last = time.monotonic()
        self._late: list[tuple[float, float]] = []
        self.start()

    def run(self) -> None:
        while True:
            time.sleep(self.PERIOD)
            last, self._last = self._last, time.monotonic()
            if (late := self._last - last - self.PERIOD) > self.NOTED:
                self._late.append((self._last, late))

    def late(self, since: float) -> float:
        """Returns the time in s that this program has lost since then."""
        return sum(late for at, late in self._late if at >= since) + max(
            0.0, time.monotonic() - self._last - self.PERIOD - self.NOTED
        )


class Stage:
    """A `midair serve`, whose simulated board writes its frames into a pipe.

    It is a process of its own: in this one, it would wait for the tests' threads.
    """

    def __init__(self, folder: Path, pulse: Pulse) -> None:
        pipe = folder / "frames.bin"
        os.mkfifo(pipe)
        self.emits, self.pulse = False, pulse
        #: When the last frame came that emits.
        self.lit = -math.inf
        self._news = threading.Condition()
        self._off = midair.Board("autd3").off_frame
        threading.Thread(target=self._read, args=(pipe,), daemon=True).start()
        command = [sys.executable, "-m", "midair", "serve", "--on", f"file:{pipe}", "--rate", str(RATE)]
        self._program = subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8")
        assert self._program.stdout is not None
        self.address, osc, adaptics = (self._program.stdout.readline().strip() for _ in range(3))
        (self.osc, self.token), self.adaptics = re.findall(r":(\d+) token (.+)", osc)[0], adaptics.split()[0]

    def close(self) -> None:
        self._program.terminate()
        self._program.communicate(timeout=20)

    def _read(self, pipe: Path) -> None:
        before_what_computes()
        with pipe.open("rb") as stream:
            while len(frame := stream.read(len(self._off))) == len(self._off):
                with self._news:
                    self.emits = frame != self._off
                    self.lit = time.monotonic() if self.emits else self.lit
                    self._news.notify_all()

    def stays(self, emits: bool, seconds: float) -> bool:
        """Returns whether the board emits, or does not, for so long."""
        with self._news:
            return not self._news.wait_for(lambda: self.emits != emits, seconds)

    def ends(self, seconds: float) -> bool:
        """Returns whether the board is off within this time, without what this program loses."""
        begin = time.monotonic()
        with self._news:
            while self.emits:
                left = begin + seconds + self.pulse.late(begin) - time.monotonic()
                if left <= 0:
                    return False
                self._news.wait(left)
            return True


def history(stage: Stage, seed: int) -> tuple[str, float]:
    """Lets one source play while others only watch; it must play on until it ends, and then no longer.

    Returns how it ended, and the time in s by which the board was off later than stated, without what this
    program lost.
    """
    from pythonosc.osc_message_builder import OscMessageBuilder
    from websockets.sync.client import connect

    draw = random.Random(seed)
    player = draw.choice(("game", "phone", "page", "hand"))
    end = draw.choice(list(ENDS[player]))
    shown = (seed, player, end)
    gaps: list[float] = []
    phone = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    game, monitor = connect(stage.address, max_queue=None), connect(stage.address, max_queue=None)
    page, tracker = connect(stage.adaptics, max_queue=None), connect(stage.adaptics, max_queue=None)

    def osc(name: str, *values: float) -> None:
        built = OscMessageBuilder(f"/midair/{name}")
        for value in (stage.token, *values):
            built.add_arg(value)
        phone.sendto(built.build().dgram, ("127.0.0.1", int(stage.osc)))

    def tell(command: str, **data: Any) -> None:
        page.send(json.dumps({"cmd": command, "data": data}))

    def start(pattern: str) -> None:
        tell("update_tracking", enabled=player == "hand")
        tell("update_pattern", pattern_json=pattern)
        tell("update_playstart", playstart=1, playstart_offset=0)

    def watch(seconds: float, act: Callable[[], object] = lambda: None) -> None:
        """Asks for the state, and does what the player does, again and again."""
        begin = now = time.monotonic()
        while now < begin + seconds:
            monitor.send(draw.choice(('{"state": true}', '{"keep": true}', '{"metrics": true}')))
            act()
            time.sleep(draw.uniform(0.01, 0.05))
            before, now = now, time.monotonic()
            gaps.append(now - before)

    with phone, game, monitor, page, tracker:
        if draw.random() < 0.5:
            # A page whose pattern has ended stays and answers pings.
            start(ENDING.replace("300", "30"))
            watch(0.1)
        assert stage.ends(SILENCE + LATE), shown
        same = '{"points": [[0, 0, 0.15]]}'
        circle = '{"path": {"kind": "circle", "center": [0, 0, 0.15], "radius": 0.01, "frequency": 2}}'
        first = draw.choice((same, circle))
        again = {
            "game": lambda: game.send(draw.choice((first, '{"keep": true}', '{"state": true}'))),
            "phone": lambda: osc("points", 0, 0, 0.15),
            "page": lambda: None,
            "hand": lambda: tracker.send(tracked(True)),
        }[player]
        begin = pressed = time.monotonic()
        if player == "game":
            game.send(first)
        again()
        if player in ("page", "hand"):
            start(ENDING if end == "end" else ENDLESS)
        watch(0.1, again)
        # The signs go on: the server drops points that are older than its last sign of life.
        while stage.lit < begin:
            assert time.monotonic() < begin + LATE + 0.1 + stage.pulse.late(begin), shown
            if player in ("page", "hand") and stage.pulse.late(pressed) > SILENCE / 2:
                pressed = time.monotonic()
                start(ENDING if end == "end" else ENDLESS)
            watch(0.02, again)
        if end != "end":
            begin = time.monotonic()
            playing = threading.Thread(target=watch, args=(0.4, again))
            playing.start()
            steady = stage.stays(True, 0.4)
            playing.join()
            # If this program was late, it may have been silent itself.
            assert steady or max(*gaps, stage.pulse.late(begin)) > SILENCE / 2, shown
        ends: dict[str, Callable[[], object]] = {
            "leave": (game if player == "game" else page).close,
            "off": lambda: monitor.send('{"off": true}'),
            "unseen": lambda: tracker.send(tracked(False)),
            "untracked": tracker.close,
        }
        stated, begin = ENDS[player][end], time.monotonic()
        watching = threading.Thread(target=watch, args=(stated + LATE + 0.2,))
        watching.start()
        ends.get(end, lambda: None)()
        assert stage.ends(stated + LATE), shown
        late = time.monotonic() - begin - stated - stage.pulse.late(begin)
        assert stage.stays(False, 0.15), shown
        watching.join()
    return f"{player}, {end}", late


@pytest.mark.slow
def test_no_real_history_leaves_a_board_emitting_and_none_silences_who_plays(tmp_path: Path) -> None:
    pytest.importorskip("websockets")
    pytest.importorskip("pythonosc")
    seeds = iter(range(REAL))
    failed: list[str] = []
    late: dict[str, list[float]] = {}
    pulse = Pulse()

    def play(folder: Path) -> None:
        folder.mkdir()
        with closing(Stage(folder, pulse)) as stage:
            for seed in seeds:
                try:
                    end, after = history(stage, seed)
                    late.setdefault(end, []).append(after)
                except BaseException:
                    failed.append(f"history {seed}: {traceback.format_exc()}")

    threads = [threading.Thread(target=play, args=(tmp_path / str(k),)) for k in range(min(STAGES, REAL // 2))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for end, each in sorted(late.items()):
        print(f"{end}: off {np.median(each):.3f} s later than stated, at most {max(each):.3f} s, of {len(each)}")
    assert not failed, "\n".join(failed)
