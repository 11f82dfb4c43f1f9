"""Protocol of Adaptics Engine: clients send tactons (tactile patterns), parameters, starts and hand places.

A message is {"cmd": ..., "data": {...}}; docs/serve.md lists all messages. Lengths are in mm, times in ms.
"""

from __future__ import annotations

import json
import math
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from .._boards.errors import BoardError
from .._midair import SceneError
from .._support.arguments import flag, json_object, number, refused, word
from .live import Frame, Live, Wanted
from .tacton import Matrix, Moment, Tacton, Touch

#: Largest number of characters of an error message to a client: the message may quote data from the client.
MOST_TEXT = 300

#: Time in s between two playback reports to a client, and the largest number of touches that wait for the
#: next report.
REPORT, MOST_REPORTED = 1 / 60, 4096


class Player:
    """Plays the tacton that clients chose. Stores its parameters and transform, and the hand's place."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._tacton: Tacton | None = None
        self._values: dict[str, float] = {}
        self._matrix: Matrix | None = None
        self._time = 0.0
        self._tracked = False
        self._palm: tuple[float, float, float] | None = None
        self._clients: list[Client] = []

    def obey(self, message: str | bytes, client: Client) -> None:
        """Execute a client's message.

        Raises SceneError for an invalid message, BoardError if the board is gone.
        """
        given = json_object("message", message, 'give {"cmd": ..., "data": {...}}')
        command, data = given.get("cmd"), given.get("data")
        act = COMMANDS.get(command) if isinstance(command, str) else None
        if act is None:
            raise refused("cmd", command, f"give {', '.join(COMMANDS)}")
        if not isinstance(data, dict):
            raise refused("data", data, "give an object")
        act(self, data, client)

    def _pattern(self, data: dict[str, Any], client: Client) -> None:
        self._tacton = Tacton(word("pattern_json", data.get("pattern_json")))

    def _parameters(self, data: dict[str, Any], client: Client) -> None:
        given = data.get("evaluator_params")
        if not isinstance(given, dict) or not isinstance(given.get("user_parameters"), dict):
            raise refused("evaluator_params", given, "give time, user_parameters and geometric_transform")
        values = {name: number(name, value) for name, value in given["user_parameters"].items()}
        matrix = _matrix(given.get("geometric_transform"))
        self._time = number("time", given.get("time"))
        self._values, self._matrix = values, matrix

    def _start(self, data: dict[str, Any], client: Client) -> None:
        start, offset = (number(key, data.get(key)) for key in ("playstart", "playstart_offset"))
        if not start:
            self._live.off()
            return
        if self._tacton is None:
            raise SceneError("no pattern is there: send update_pattern before update_playstart")
        client.begins()
        begin = time.monotonic() + offset / 1e3
        self._live.play(Wanted(self._frames(begin, Moment(self._time)), change=math.pi))

    def _tracking(self, data: dict[str, Any], client: Client) -> None:
        self._tracked = flag("enabled", data.get("enabled"))

    def _hand(self, data: dict[str, Any], client: Client) -> None:
        frame = data.get("tracking_frame")
        if not isinstance(frame, dict):
            raise refused("tracking_frame", frame, "give an object")
        self._palm = None if (hand := frame.get("hand")) is None else _palm(hand)
        for other in self._clients:
            if other is not client:
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
            for client in self._clients:
                client.reported.append(touch)
            if over:
                return None
            x, y, z = touch.point
            if self._tracked and self._palm is not None:
                x, y, z = x + self._palm[0], y + self._palm[1], self._palm[2]
            point = 1e-3 * np.array([[x, y, z]])
            return Frame(point, loudness=min(max(touch.intensity, 0.0), 1.0))

        return frame

    def join(self, client: Client) -> None:
        """Add a client to the list of clients that receive reports."""
        self._clients = [*self._clients, client]

    def leave(self, client: Client) -> None:
        """Remove a client, and turn the board off if this client had started the playback."""
        self._clients = [each for each in self._clients if each is not client]
        if client.playing:
            self._live.off()

    def others(self, client: Client) -> None:
        """Record that this client started the playback.

        From now on the playback goes on if another client disconnects.
        """
        for other in self._clients:
            other.playing = other is client


COMMANDS: dict[str, Callable[[Player, dict[str, Any], Client], None]] = {
    "update_pattern": Player._pattern,
    "update_playstart": Player._start,
    "update_parameters": Player._parameters,
    "update_tracking": Player._tracking,
    "tracking_data": Player._hand,
}


class Client:
    """A WebSocket client, to which reports and pings are sent. Its answers to pings are signs of life."""

    def __init__(self, socket: Any, player: Player, live: Live) -> None:
        self.reported: deque[Touch] = deque(maxlen=MOST_REPORTED)
        self.playing = False
        self._socket = socket
        self._player = player
        self._live = live
        self._gone = threading.Event()

    def begins(self) -> None:
        """Record this client as the one that started the playback."""
        self._player.others(self)

    def send(self, command: str, **data: Any) -> None:
        """Send a message, unless the connection is closed."""
        try:
            self._socket.send(json.dumps({"cmd": command, "data": data}))
        # The library raises several kinds of errors for a broken connection.
        except Exception:
            self._gone.set()

    def talk(self) -> None:
        """Execute the client's messages until the connection closes."""
        self._player.join(self)
        threading.Thread(target=self._report, daemon=True).start()
        try:
            for message in self._socket:
                try:
                    self._player.obey(message, self)
                except (SceneError, BoardError) as error:
                    self.send("error", message=str(error)[:MOST_TEXT])
        finally:
            self._gone.set()
            self._player.leave(self)

    def _report(self) -> None:
        """Send the touches that were played, and pings.

        Each answered ping keeps this client's playback going.
        """
        answered: Any = None
        error: str | None = None
        while not self._gone.wait(REPORT):
            touches = [self.reported.popleft() for _ in range(len(self.reported))]
            if touches:
                self.send("playback_update", evals=[_evaluated(touch) for touch in touches])
            if self.playing and error != (error := self._live.error) and error is not None:
                self.send("error", message=error)
            try:
                if answered is None or answered.is_set():
                    if answered is not None and self.playing:
                        self._live.keep()
                    answered = self._socket.ping()
            # The library raises several kinds of errors for a broken connection.
            except Exception:
                return


def _evaluated(touch: Touch) -> dict[str, Any]:
    x, y, z = touch.point
    control = {"coords": {"x": x, "y": y, "z": z}, "intensity": touch.intensity}
    moment = {"last_eval_pattern_time": touch.moment.pattern, "time_offset": touch.moment.ahead}
    played = {"pattern_time": touch.moment.pattern, "stop": touch.stop}
    return {"ul_control_point": control, **played, "next_eval_params": moment}


def _matrix(given: Any) -> Matrix:
    try:
        return [[number("geometric_transform", value) for value in row] for row in _rows(given)]
    except TypeError:
        raise refused("geometric_transform", given, "give 4 rows of 4 numbers") from None


def _rows(given: Any) -> Any:
    if not isinstance(given, list) or len(given) != 4 or any(len(row) != 4 for row in given):
        raise refused("geometric_transform", given, "give 4 rows of 4 numbers")
    return given


def _palm(hand: Any) -> tuple[float, float, float]:
    try:
        place = hand["palm"]["position"]
        x, y, z = (number(f"palm.position.{axis}", place[axis]) for axis in "xyz")
    except (TypeError, KeyError):
        raise refused("hand", hand, "give palm.position with x, y, z in mm") from None
    return x, y, z
