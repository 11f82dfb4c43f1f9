"""Protocol of Adaptics Engine: clients send tactons (tactile patterns), parameters, starts and hand places.

A message is {"cmd": ..., "data": {...}}; docs/serve.md lists all messages. Lengths are in mm, times in ms.
"""

from __future__ import annotations

import asyncio
import json
import math
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from .._boards.errors import BoardError
from .._midair import SceneError, numbers, stated
from .._support.arguments import flag, json_object, number, refused, word
from .live import Frame, Live, Wanted
from .messages import Client
from .tacton import Matrix, Moment, Tacton, Touch

#: Largest number of characters of an error message to a client: the message may quote data from the client.
MOST_TEXT = 300

#: Time in s between two playback reports to a client, and the largest number of touches that wait for the
#: next report.
REPORT, MOST_REPORTED = 1 / 60, 4096


class Player:
    """Plays the tacton that clients chose. Stores its parameters and transform, and the hand's place."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self._tacton: Tacton | None = None
        self._values: dict[str, float] = {}
        self._matrix: Matrix | None = None
        self._time = 0.0
        self._tracked = False
        self._palm = (0.0, 0.0, 0.0)
        #: The clients that get reports.
        self.pages: set[Page] = set()

    def obey(self, message: str | bytes, page: Page, at: float) -> None:
        """Execute a client's message, which came at a time of `time.monotonic`.

        Raises SceneError for an invalid message, BoardError if the board is gone.
        """
        given = json_object("message", message, 'give {"cmd": ..., "data": {...}}')
        command, data = given.get("cmd"), given.get("data")
        act = COMMANDS.get(command) if isinstance(command, str) else None
        if act is None:
            raise refused("cmd", command, f"give {', '.join(COMMANDS)}")
        if not isinstance(data, dict):
            raise refused("data", data, "give an object")
        act(self, data, page, at)

    def _pattern(self, data: dict[str, Any], page: Page, at: float) -> None:
        self._tacton = Tacton(word("pattern_json", data.get("pattern_json")))

    def _parameters(self, data: dict[str, Any], page: Page, at: float) -> None:
        given = data.get("evaluator_params")
        if not isinstance(given, dict) or not isinstance(given.get("user_parameters"), dict):
            raise refused("evaluator_params", given, "give time, user_parameters and geometric_transform")
        values = {name: number(name, value) for name, value in given["user_parameters"].items()}
        cure = "give 4 rows of 4 numbers"
        matrix = numbers("geometric_transform", given.get("geometric_transform"), [(4, 4)], cure)
        self._time = number("time", given.get("time"))
        self._values, self._matrix = values, matrix.tolist()

    def _start(self, data: dict[str, Any], page: Page, at: float) -> None:
        start, offset = (number(key, data.get(key)) for key in ("playstart", "playstart_offset"))
        if not start:
            self.live.off()
            return
        if self._tacton is None:
            raise stated("no pattern", "is there", "send update_pattern before update_playstart")
        begin = time.monotonic() + offset / 1e3
        frames = self._frames(begin, Moment(self._time))
        self.live.play(Wanted(page.client, frames, change=math.pi), tracked=self._tracked)

    def _tracking(self, data: dict[str, Any], page: Page, at: float) -> None:
        self._tracked = flag("enabled", data.get("enabled"))
        with self.live.life() as life:
            life.tracked = self._tracked and life.player in [page.client for page in self.pages]

    def _hand(self, data: dict[str, Any], page: Page, at: float) -> None:
        frame = data.get("tracking_frame")
        if not isinstance(frame, dict):
            raise refused("tracking_frame", frame, "give an object")
        if (hand := frame.get("hand")) is not None:
            self._palm = _palm(hand)
        with self.live.life() as life:
            life.hand(page.client, None if hand is None else at)
        for other in tuple(self.pages):
            if other is not page:
                other.send("tracking_data", tracking_frame=frame)

    def _frames(self, begin: float, start: Moment) -> Callable[[float], Frame | None]:
        """Return a function that computes the frame to play now.

        The function uses this computer's clock and ignores its argument.
        """
        moment, over = start, False

        def frame(_: float) -> Frame | None:
            nonlocal moment, over
            if over or self._tacton is None:
                return None
            now = 1e3 * (time.monotonic() - begin)
            touch = self._tacton.at(now, moment, self._values, self._matrix)
            moment, over = touch.moment, touch.stop
            for page in tuple(self.pages):
                page.reported.append(touch)
            if over:
                return None
            x, y, z = touch.point
            if self._tracked:
                x, y, z = x + self._palm[0], y + self._palm[1], self._palm[2]
            point = 1e-3 * np.array([[x, y, z]])
            return Frame(point, loudness=min(max(touch.intensity, 0.0), 1.0))

        return frame


COMMANDS: dict[str, Callable[[Player, dict[str, Any], Page, float], None]] = {
    "update_pattern": Player._pattern,
    "update_playstart": Player._start,
    "update_parameters": Player._parameters,
    "update_tracking": Player._tracking,
    "tracking_data": Player._hand,
}


class Page:
    """A client of this protocol. It gets reports and pings; its answers to pings are signs of life."""

    def __init__(self, client: Client, player: Player) -> None:
        self.client = client
        self.reported: deque[Touch] = deque(maxlen=MOST_REPORTED)
        self._player = player

    def obey(self, message: str | bytes, at: float) -> None:
        """Execute a message, which came at a time of `time.monotonic`."""
        try:
            self._player.obey(message, self, at)
        except (SceneError, BoardError) as error:
            self.send("error", message=str(error)[:MOST_TEXT])

    def send(self, command: str, **data: Any) -> None:
        """Send a message."""
        self.client.say(json.dumps({"cmd": command, "data": data}))

    async def report(self) -> None:
        """Send the touches that were played, the error that ended them, and pings, one after another."""
        live, failed = self._player.live, None
        pong: Any = None
        self._player.pages.add(self)
        try:
            while True:
                await asyncio.sleep(REPORT)
                touches = [self.reported.popleft() for _ in range(len(self.reported))]
                if touches:
                    self.send("playback_update", evals=[_evaluated(touch) for touch in touches])
                if failed != (failed := live.failed) and failed is not None and failed[0] is self.client:
                    self.send("error", message=failed[1][:MOST_TEXT])
                if pong is None or pong.done():
                    with live.life() as life:
                        life.sign(self.client, self.client.arrived)
                    pong = await self.client.ping()
        finally:
            self._player.pages.discard(self)


def _evaluated(touch: Touch) -> dict[str, Any]:
    x, y, z = touch.point
    control = {"coords": {"x": x, "y": y, "z": z}, "intensity": touch.intensity}
    moment = {"last_eval_pattern_time": touch.moment.pattern, "time_offset": touch.moment.ahead}
    played = {"pattern_time": touch.moment.pattern, "stop": touch.stop}
    return {"ul_control_point": control, **played, "next_eval_params": moment}


def _palm(hand: Any) -> tuple[float, float, float]:
    try:
        place = hand["palm"]["position"]
        x, y, z = (number(f"palm.position.{axis}", place[axis]) for axis in "xyz")
    except (TypeError, KeyError):
        raise refused("hand", hand, "give palm.position with x, y, z in mm") from None
    return x, y, z
