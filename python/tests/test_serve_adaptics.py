"""The protocol of Adaptics Engine: the tactons of tactons.py against their expected curves,
and messages that are rejected.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import numpy as np
import pytest

import midair
import tactons

pytest.importorskip("websockets")
pytest.importorskip("pythonosc")

from websockets.sync.client import connect

from midair._serve.life import HAND, SILENCE
from midair._serve.live import Live
from midair._serve.server import PointServer
from midair._serve.tacton import Moment, Tacton

pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")

#: Published tolerances of the curves: of the position in mm, and of the intensity relative to full intensity.
PLACE, STRENGTH = 0.1, 0.01

UNMOVED = [[float(i == k) for k in range(4)] for i in range(4)]


@pytest.fixture
def server() -> Iterator[PointServer]:
    with midair.connect("sonicsurface:loop", hold=SILENCE) as board, PointServer(Live(board)) as found:
        yield found


def send(client: Any, command: str, **data: Any) -> None:
    client.send(json.dumps({"cmd": command, "data": data}))


def start(client: Any, case: tactons.Case) -> None:
    """Sends the messages that the Designer sends before it plays."""
    send(client, "update_pattern", pattern_json=json.dumps(case.pattern))
    given = {"time": 0, "user_parameters": case.values, "geometric_transform": UNMOVED}
    send(client, "update_parameters", evaluator_params=given)
    send(client, "update_playstart", playstart=1.7e12, playstart_offset=0)


def received(client: Any, command: str, timeout: float = 5) -> Any:
    while True:
        message = json.loads(client.recv(timeout=timeout))
        if message["cmd"] == command:
            return message["data"]


@pytest.mark.parametrize("case", tactons.CASES, ids=lambda case: case.name)
def test_a_tacton_follows_its_curves_at_1_khz(case: tactons.Case) -> None:
    tacton, moment = Tacton(json.dumps(case.pattern)), Moment()
    times = np.arange(0.0, 3000.0)
    found, own, stops = [], [], []
    for now in times:
        touch = tacton.at(now, moment, case.values)
        moment = touch.moment
        found.append((*touch.point, touch.intensity))
        own.append(moment.pattern)
        stops.append(touch.stop)
    own_time = case.speed * times if case.loop is None else times % case.loop
    np.testing.assert_allclose(own, own_time, atol=1e-6)
    assert stops == list(own_time >= (math.inf if case.end is None else case.end - 1e-9))
    plays = ~np.array(stops)
    expected = case.expected(own_time, times, case.values)
    apart = np.abs(np.array(found).T - expected)[:, plays]
    assert apart[:3].max() < PLACE
    assert apart[3].max() < STRENGTH
    # The agreement is much closer than the tolerance.
    assert apart.max() < 1e-6
    assert np.ptp(np.array(found)[plays], axis=0)[[0, 1, 3]].min() > 0.3


@pytest.mark.slow
@pytest.mark.parametrize("case", tactons.CASES, ids=lambda case: case.name)
def test_a_tacton_is_played_on_a_board(case: tactons.Case, server: PointServer) -> None:
    board = server._live.connection
    sent: list[tuple[float, np.ndarray]] = []
    play = board.send
    board.send = lambda drive: (sent.append((time.monotonic(), np.array(drive))), play(drive))[1]  # type: ignore[method-assign]
    with connect(server.adaptics) as client:
        start(client, case)
        evals: list[dict[str, Any]] = []
        begin = time.monotonic()
        while time.monotonic() - begin < 1.2 and not (evals and evals[-1]["stop"]):
            evals += received(client, "playback_update")["evals"]
        send(client, "update_playstart", playstart=0, playstart_offset=0)
    assert len(evals) > 25
    assert any(each["stop"] for each in evals) == (case.end is not None)
    played = [each for each in evals if not each["stop"]]
    own = np.array([each["pattern_time"] for each in played])
    since = own - [each["next_eval_params"]["time_offset"] for each in played]
    points = np.array([list(each["ul_control_point"]["coords"].values()) for each in played])
    strength = np.array([each["ul_control_point"]["intensity"] for each in played])
    expected = case.expected(own, since, case.values)
    assert np.abs(points - expected[:3].T).max() < PLACE
    assert np.abs(strength - expected[3]).max() < STRENGTH
    # The board received a focus at each of these points, unless the intensity rounds to off.
    assert len(sent) >= len(played) - 1
    for point, loud, (_, drive) in zip(points, strength, sent, strict=False):
        gains = midair.Scene(board.board.array, [1e-3 * point]).propagation()[0]
        emitted = board.board.decode(board.board.encode(drive))
        share = abs(gains @ emitted) / abs(gains).sum()
        assert share < 1e-6 if loud < 0.49 else loud < 0.51 or share > 0.9, (loud, share)


def test_parameters_jumps_and_transforms() -> None:
    """Checks that a parameter's definition limits its value, and that a transformation matrix moves the
    keyframes' positions but does not change the curve drawn around them.
    """
    circle = ("circle", {"radius": "size", "am_freq": 0})
    given = tactons.pattern(
        [tactons.keyframe(0, (10, 0, 0), circle, 1), tactons.keyframe(100, (20, 0, 0))],
        {"size": (3, 1, 5)},
        shift=(0, 0, 50),
    )
    tacton = Tacton(json.dumps(given))
    for size, radius in ((None, 3), (0, 1), (9, 5), (2, 2)):
        values = {} if size is None else {"size": float(size)}
        assert tacton.at(0, Moment(), values).point == (10 + radius, 0, 50)
    moved = tacton.at(0, Moment(), {}, [[2, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, -5], [0, 0, 0, 1]])
    assert moved.point == (24, 0, 45)
    # A start at 50 ms: the point is halfway between the two keyframes.
    assert tacton.at(50, Moment(50), {}).point[0] == pytest.approx(15 + 3)


@pytest.mark.slow
def test_hands_move_a_tacton_and_silence_is_silent(server: PointServer) -> None:
    state = server._live.connection
    with (
        connect(server.adaptics, max_queue=None) as client,
        connect(server.adaptics, max_queue=None) as tracker,
    ):
        send(client, "update_tracking", enabled=True)
        hand = {"palm": {"position": {"x": 10, "y": -20, "z": 80}}}
        send(tracker, "tracking_data", tracking_frame={"hand": hand})
        assert received(client, "tracking_data")["tracking_frame"]["hand"] == hand
        start(client, tactons.CASES[0])
        # The client need not send anything more: it answers pings while it reads. The tracker does.
        begin = time.monotonic()
        while time.monotonic() - begin < 0.6:
            received(client, "playback_update")
            send(tracker, "tracking_data", tracking_frame={"hand": hand})
        assert state.state == "playing"
        frame, _ = server._live._played or (None, None)
        assert frame is not None
        assert frame.points[0, 2] == pytest.approx(0.08)
        assert np.hypot(*(frame.points[0, :2] - [0.01, -0.02])) < 0.0141
        send(client, "update_playstart", playstart=0, playstart_offset=0)
        time.sleep(0.2)
        assert state.state == "off"
        send(tracker, "tracking_data", tracking_frame={"hand": hand})
        start(client, tactons.CASES[0])
        until(server, "playing")
    assert until(server, "off") < 0.25


def until(server: PointServer, state: str, seconds: float = 2.0) -> float:
    """Waits until the board is in a state, and returns the time in s."""
    begin = time.monotonic()
    while server._live.connection.state != state:
        assert time.monotonic() - begin < seconds, server._live.state()
        time.sleep(0.005)
    return time.monotonic() - begin


HAND_HERE = {"hand": {"palm": {"position": {"x": 0, "y": 0, "z": 100}}}}


@pytest.mark.slow
@pytest.mark.parametrize("end", ["stops", "sees no hand", "leaves"])
def test_a_pattern_stops_with_the_hand_that_it_follows_and_goes_on_with_it(server: PointServer, end: str) -> None:
    with (
        connect(server.adaptics, max_queue=None) as client,
        connect(server.adaptics, max_queue=None) as tracker,
        connect(server.adaptics, max_queue=None) as other,
    ):
        send(client, "update_tracking", enabled=True)
        start(client, tactons.CASES[0])
        time.sleep(0.1)
        # No hand was there yet.
        assert server._live.connection.state == "off"
        send(tracker, "tracking_data", tracking_frame=HAND_HERE)
        until(server, "playing")
        if end == "sees no hand":
            send(tracker, "tracking_data", tracking_frame={"hand": None})
        elif end == "leaves":
            tracker.close()
        assert until(server, "off") < HAND + 0.3
        time.sleep(0.1)
        assert server._live.connection.state == "off"
        send(other, "tracking_data", tracking_frame=HAND_HERE)
        until(server, "playing")


@pytest.mark.slow
def test_a_page_whose_pattern_has_ended_keeps_no_points_of_others(server: PointServer) -> None:
    ending = tactons.pattern([tactons.keyframe(0, (0, 0, 0), None, 1), {"time": 100, "type": "stop"}])
    with connect(server.adaptics, max_queue=None) as page, connect(server.address) as game:
        start(page, tactons.Case("ending", ending, tactons.CASES[0].expected))
        until(server, "playing")
        until(server, "off")
        game.send(json.dumps({"points": [[0, 0, 0.1]]}))
        until(server, "playing")
        assert until(server, "off") < SILENCE + 0.3


def test_a_client_of_adaptics_needs_the_token(server: PointServer) -> None:
    with pytest.raises(Exception, match="403"), connect(server.adaptics.partition("?")[0]):
        pass


def changed(*keys: Any, to: Any) -> str:
    """Returns a valid pattern with one value replaced."""
    made = deepcopy(tactons.CASES[3].pattern)
    inner: Any = made
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = to
    return json.dumps(made)


def deep(levels: int) -> Any:
    made: Any = {"type": "constant", "value": 1}
    for _ in range(levels):
        made = {"type": "negate", "value": made}
    return {"type": "formula", "value": made}


FACTOR = ("pattern_transform", "intensity_factor")
BRUSH = ("keyframes", 0, "brush", "brush")
BAD = {
    "pattern is no JSON: give what Adaptics Designer saves": "{",
    "pattern is no JSON object: give what Adaptics Designer saves": "[]",
    "pattern holds NaN: give finite numbers": changed("keyframes", 0, "time", to=math.nan),
    '$DATA_FORMAT is "ahap": give "MidAirHapticsAnimationFileFormat"': changed("$DATA_FORMAT", to="ahap"),
    '$REVISION is "9": give 0.1.0-alpha.3': changed("$REVISION", to="9"),
    "keyframes is 3: give a list of objects": changed("keyframes", to=3),
    "keyframes are 5000: give 4096 at most": changed("keyframes", to=[{"type": "stop", "time": 0}] * 5000),
    "keyframes[0].time is None: give a number": changed("keyframes", 0, "time", to=None),
    'keyframes[0].type is "loop": give standard, pause, stop': changed("keyframes", 0, "type", to="loop"),
    "keyframes[0].coords is None: give an object": changed("keyframes", 0, "coords", to=None),
    "keyframes[0].coords.coords.x is None: give a number": changed("keyframes", 0, "coords", "coords", to={"y": 1}),
    'keyframes[0].brush.brush.name is "cube": give circle, line, lissajous': changed(*BRUSH, "name", to="cube"),
    "keyframes[0].brush.brush.params.length is None: give an object": changed(*BRUSH, "name", to="line"),
    'keyframes[0].intensity.transition.name is "ease": give linear, step': changed(
        "keyframes", 0, "intensity", "transition", "name", to="ease"
    ),
    "pattern_transform is None: give an object": changed("pattern_transform", to=None),
    'pattern_transform.intensity_factor.type is "list": give f64': changed(*FACTOR, "type", to="list"),
    "pattern_transform.intensity_factor.value is inf: give a finite number": changed(*FACTOR, "value", to=1).replace(
        '"intensity_factor": {"type": "f64", "value": 1}',
        '"intensity_factor": {"type": "f64", "value": 1e999}',
    ),
    "value is deeper than 32 levels: give a simpler formula": changed(*FACTOR, to=deep(60)),
    "user_parameter_definitions.near.min is True: give a number": changed(
        "user_parameter_definitions", "near", "min", to=True
    ),
    "cjumps.condition.operator.name is": changed(
        "keyframes", 2, "cjumps", 0, "condition", "operator", to={"name": "eq"}
    ),
}


@pytest.mark.parametrize("text", BAD)
def test_a_bad_pattern_gets_one_line(text: str) -> None:
    with pytest.raises(midair.SceneError) as caught:
        Tacton(BAD[text])
    assert text in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


def test_a_formula_without_a_number_is_refused_when_it_is_met() -> None:
    given = changed(*FACTOR, to=tactons.value(("divide", 1, "near")))
    with pytest.raises(midair.SceneError, match="pattern gives no number at 0 ms"):
        Tacton(given).at(1, Moment(), {"near": 0})
    square = ("multiply", 1e99, 1e99)
    huge = changed(*FACTOR, to=tactons.value(("multiply", square, square)))
    with pytest.raises(midair.SceneError, match="pattern gives no finite point at 0 ms"):
        Tacton(huge).at(1, Moment(), {"near": 1})


HOSTILE: tuple[Any, ...] = (
    "",
    "[]",
    "[" * 60_000,
    b"\xff\x00",
    '{"cmd": 3}',
    '{"cmd": "update_pattern"}',
    '{"cmd": "update_pattern", "data": {"pattern_json": 3}}',
    '{"cmd": "update_pattern", "data": {"pattern_json": "' + "[" * 500_000 + '"}}',
    '{"cmd": "update_playstart", "data": {"playstart": NaN, "playstart_offset": 0}}',
    '{"cmd": "update_playstart", "data": {"playstart": 1, "playstart_offset": 0}}',
    '{"cmd": "update_playstart", "data": {"playstart": 1' + "0" * 400 + ', "playstart_offset": 0}}',
    '{"cmd": "update_parameters", "data": {"evaluator_params": {"user_parameters": []}}}',
    json.dumps(
        {
            "cmd": "update_parameters",
            "data": {"evaluator_params": {"time": 0, "user_parameters": {}, "geometric_transform": [1, 2, 3, 4]}},
        }
    ),
    '{"cmd": "update_tracking", "data": {"enabled": 1}}',
    '{"cmd": "tracking_data", "data": {"tracking_frame": {"hand": {"palm": 3}}}}',
    '{"cmd": "shut_down", "data": {}}',
    json.dumps({"cmd": "x" * 100_000, "data": {}}),
)


@pytest.mark.slow
def test_hostile_messages_make_no_sound_and_end_nothing(server: PointServer) -> None:
    with connect(server.adaptics) as client:
        for message in HOSTILE * 59:
            client.send(message)
            answer = json.loads(client.recv(timeout=10))
            assert answer["cmd"] == "error", message[:60]
            assert len(answer["data"]["message"]) <= 300
        # A pattern below the array, where no point can be.
        low = tactons.pattern([tactons.keyframe(0, (0, 0, 0), None, 1)], shift=(0, 0, -50))
        start(client, tactons.Case("low", low, tactons.CASES[0].expected))
        assert "\n" not in received(client, "error")["message"]
        assert server._live.connection.stats.frames == 0
        start(client, tactons.CASES[0])
        assert received(client, "playback_update")["evals"]
