"""`midair.haptic`: the reported strength is right, the change bound is kept,
and levels at ears are limited.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._midair import Membrane
from midair._touch.schedule import Curve, Foci

ARRAY = midair.Array.preset("autd3")
Z = 0.15
LINE = [[-0.02, 0, Z], [0.02, 0, Z]]


def along(touch: midair.Skin, places: Any) -> float:
    return float(20 * np.log10(touch.along(places).mean()))


@pytest.mark.slow
def test_a_schedule_is_felt_more_than_the_usual_techniques() -> None:
    found = midair.haptic(LINE, ARRAY, rate=4e3)
    assert found.gain > 1
    assert len(found.standards) == 4
    assert found.technique not in found.standards
    assert len(found.sequence) <= 1024
    # The reported strength is the one that `midair.skin` computes for the drives.
    again = midair.skin(found.sequence, found.skin.hand)
    places = np.linspace(*np.array(LINE), 20)
    assert along(again, places) == pytest.approx(found.strength, abs=0.2)
    assert "schedule of" in repr(found)
    assert "dB" in found._repr_html_()
    figure = found.plot()
    assert figure.axes[0].collections, "a map of the skin"
    dots = [line.get_xdata()[0] for line in figure.axes[1].lines]
    np.testing.assert_allclose(dots, [found.strength, *found.standards.values()])
    with pytest.raises(midair.SceneError, match='give one of "skin", "techniques"'):
        found.plot(panels="ears")


def foci(rate: float, frames: int) -> tuple[Foci, Any, midair.Plane]:
    curve = np.linspace(*np.array(LINE), 20)
    plane = midair.Plane(z=Z, size=0.07, pixels=33)
    return Foci.beside(ARRAY, curve, plane, 0.008, Membrane(), rate, frames), curve, plane


def scores(found: Foci, schedule: Any) -> Any:
    """Returns the strength for the skin's fast receptors along the curve: a plain sum over spectral lines."""
    moved = 0
    total = np.zeros(found.answers.shape[1])
    for k, answer in enumerate(found.answers):
        moved = sum(
            answer[:, focus] * np.exp(-2j * np.pi * (k + 1) * t / found.frames)
            for t, focus in enumerate(schedule)
            if focus >= 0
        )
        total += np.abs(moved) ** 2
    return np.sqrt(total)


@pytest.mark.slow
def test_an_ascent_counts_what_the_skin_feels_and_does_not_fall() -> None:
    found, curve, plane = foci(4e3, 80)
    assert np.all(np.linalg.norm(found.places[:, None] - curve, axis=2).min(axis=1) <= 0.008 + 1e-9)
    start = np.arange(80) % 20
    start[5] = -1
    strong, even = found.climb(start, "strong"), found.climb(start, "even")
    assert scores(found, strong).mean() > scores(found, start).mean()
    assert scores(found, even).min() >= scores(found, start).min()
    # Another ascent, from the result of the first one, changes nothing.
    again = found.climb(strong, "strong")
    assert scores(found, again).mean() == pytest.approx(scores(found, strong).mean(), rel=1e-3)
    on = (strong >= 0)[:, None]
    played = midair.Sequence(
        ARRAY, found.places[strong][:, None], 1.0 * on, found.drives[strong] * on, rate=4e3, closed=True
    )
    felt = midair.skin(played, plane).fast
    nearest = [int(np.linalg.norm(midair.skin(played, plane).places - place, axis=1).argmin()) for place in curve]
    ratio = felt[nearest] / scores(found, strong)
    assert ratio == pytest.approx(ratio.mean(), rel=0.08)


@pytest.mark.slow
def test_even_is_at_least_as_strong_where_it_is_weakest() -> None:
    strong, even = (midair.haptic(LINE, ARRAY, rate=4e3, aim=aim) for aim in ("strong", "even"))
    assert even.weakest >= strong.weakest
    assert even.strength <= strong.strength


@pytest.mark.slow
def test_ears_are_spared_at_a_lower_level() -> None:
    ears = {"ear": [0, 0.05, 0.3]}
    loud = midair.haptic(LINE, ARRAY, rate=4e3, ears=ears, limit=160.0)
    # The largest amplitude of the board below half of the largest one.
    half = 20 * np.log10(127 / 255)
    spared = midair.haptic(LINE, ARRAY, rate=4e3, ears=ears, limit=loud.exposure["ear"].spl - 6.05)
    assert spared.exposure["ear"].spl == pytest.approx(loud.exposure["ear"].spl + half, abs=0.05)
    with pytest.raises(midair.SceneError, match="limit is 60: the least amplitude of the board gives"):
        midair.haptic(LINE, midair.Array.preset("sonicsurface"), rate=89, ears=ears, limit=60)
    # The force is proportional to the square of the pressure. The technique is the best within the limit.
    assert spared.strength >= loud.strength + 2 * half - 0.1
    assert spared.strength == pytest.approx(along(spared.skin, np.linspace(*np.array(LINE), 20)), abs=1e-6)


def test_a_shape_far_away_is_reported_once() -> None:
    array = midair.Array.grid(8, 8, 0.01)
    with warnings.catch_warnings(record=True) as reported:
        warnings.simplefilter("always")
        midair.haptic([[0, 0, 6], [0.02, 0, 6]], array, rate=100)
    assert [str(one.message).partition(" m")[0] for one in reported] == ["shape[0] is [0, 0, 6]"]


def test_drives_within_a_limit_are_those_of_the_board() -> None:
    array = midair.Array.grid(8, 8, 0.01, quantization={"phases": 16, "amplitudes": [0.0, 0.1, 0.35, 1.0]})
    ears = {"ear": [0, 0.05, 0.3]}
    loud = midair.haptic(LINE, array, rate=500, ears=ears, limit=160.0)
    limit = loud.exposure["ear"].spl - 6
    found = midair.haptic(LINE, array, rate=500, ears=ears, limit=limit)
    assert found.exposure["ear"].spl <= limit
    assert midair.exposure(found.sequence, ears)["ear"].spl == found.exposure["ear"].spl
    apart = np.abs(np.abs(found.sequence.drives)[..., None] - [0, 0.1, 0.35, 1]).min(axis=-1)
    assert apart.max() < 1e-6
    # The usual techniques are within the limit, too: each is weaker than at full level, and none is stronger
    # than the result.
    assert max(found.standards.values()) <= found.strength + 1e-9
    assert found.standards["LM at 100 Hz, 4 foci"] < loud.standards["LM at 100 Hz, 4 foci"]
    with pytest.raises(midair.SceneError, match=r'limit is 20: the least amplitude of the board gives .* "ear"'):
        midair.haptic(LINE, array, rate=500, ears=ears, limit=20)


@pytest.mark.slow
def test_the_bound_is_kept_and_a_slow_board_has_its_frames() -> None:
    small = midair.Array.grid(8, 8, 0.01)
    bounded = midair.haptic(LINE, small, rate=2e3, change=0.5)
    assert bounded.sequence.metrics.largest_change <= 0.5 + 1e-6
    slow = midair.haptic(LINE, midair.Array.preset("sonicsurface"), rate=89)
    assert slow.sequence.rate == 89
    assert slow.gain >= 0


@pytest.mark.parametrize(
    ("ask", "reported"),
    [
        (lambda: midair.haptic(LINE, ARRAY, rate=0), "rate is 0: give a number above 0"),
        (lambda: midair.haptic(LINE, ARRAY, rate=1e6), "rate is 1000000.0: give 10 to 50000 frames"),
        (lambda: midair.haptic(LINE, ARRAY, rate=0.5), "rate is 0.5: give 10 to 50000 frames per second"),
        (lambda: midair.haptic(LINE, ARRAY, rate=1e308), r"rate is 1e\+308: give a number from"),
        (
            lambda: midair.haptic(LINE, ARRAY, rate=4e3, aim="loud"),
            'aim is "loud": give "strong", "even" or "pressure"',
        ),
        (
            lambda: midair.haptic(LINE, ARRAY, rate=4e3, beside=-1),
            "beside is -1: give a number of at least 0",
        ),
        (
            lambda: midair.haptic([[0, 0, Z]], ARRAY, rate=4e3),
            "shape is of shape \\(1, 3\\): give at least 2 points",
        ),
        (lambda: midair.haptic([[0, 0, Z]] * 2, ARRAY, rate=4e3), 'shape is "0 m long": give places'),
        (
            lambda: midair.haptic(midair.path.still([0, 0, Z], duration=1), ARRAY, rate=4e3),
            'shape is "0 m long"',
        ),
        (
            lambda: midair.haptic(1e3 * np.array(LINE), ARRAY, rate=4e3),
            'shape is "40 m large": give places in m',
        ),
        (
            lambda: midair.haptic([LINE[0], [0, np.nan, Z]], ARRAY, rate=4e3),
            r"shape\[1, 1\] is nan: give finite numbers",
        ),
        (
            lambda: midair.haptic([[0, 0, -Z], [0.02, 0, -Z]], ARRAY, rate=4e3),
            r"shape\[0\] is \[0.0, 0.0, -0.15\]: no transducer reaches it",
        ),
        (
            lambda: midair.haptic(LINE, ARRAY, rate=4e3, limit="acgih ear"),
            'limit is "acgih ear": give howard',
        ),
        (
            lambda: midair.haptic(LINE, ARRAY, rate=4e3, ears=[0, 0.1, 0.4]),
            r"ears is \[0, 0.1, 0.4\]: give a dict of names",
        ),
        (lambda: midair.haptic(LINE, ARRAY, rate=4e3, loss=0), "loss is 0: give a number of at least 0.1"),
    ],
)
def test_what_is_no_shape_is_refused_in_one_line(ask: Callable[[], Any], reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        ask()


def test_a_path_says_itself_whether_it_is_closed() -> None:
    ring = Curve.of(midair.path.circle([0, 0, 0.1], 0.02, frequency=1), False)
    line = Curve.of(midair.path.line([0, 0, 0.1], [0.05, 0, 0.1], speed=1), True)
    assert (ring.closed, line.closed) == (True, False)
    assert ring.length == pytest.approx(2 * np.pi * 0.02, rel=1e-5)
    assert line.length == pytest.approx(0.05, rel=1e-3)
    # From the last place of a closed curve to its first is a step like the others.
    steps = np.linalg.norm(np.roll(ring.places, -1, axis=0) - ring.places, axis=1)
    assert steps == pytest.approx(ring.length / len(ring.places), rel=1e-2)
    last = len(line.places) - 1
    assert line.indices(np.array([0, 1, 1.25, 2])).tolist() == [0, last, np.rint(0.75 * last), 0]
    assert ring.indices(np.array([0, 1, 4 / 3])).tolist() == [0, 0, len(ring.places) // 3]


def test_a_solution_is_modulated_by_a_shape_or_by_samples() -> None:
    solution = midair.solve(midair.Scene(ARRAY, [[0, 0, Z]], 2000))
    sine = solution.modulated(200, "cosine")
    assert (len(sine), sine.rate, sine.closed) == (20, 4000, True)
    assert sine.drives[0] == pytest.approx(solution.drive, abs=1e-6)
    assert sine.pressures[5, 0] == pytest.approx(abs(solution.pressures[0]) / 2, rel=1e-3)
    steps = solution.modulated([1, 0.5, 0, 0.5], samples_rate=400, rate=800)
    amplitudes = np.abs(steps.drives).max(axis=1) / np.abs(solution.drive).max()
    assert amplitudes == pytest.approx(np.repeat([1, 0.5, 0, 0.5], 2))
    with pytest.raises(midair.SceneError, match=r"frequency is 33\.33: no whole periods at 4000 frames/s"):
        solution.modulated(33.33)
    with pytest.raises(midair.SceneError, match=r"rate is 300\.0: the modulation needs 400 frames"):
        solution.modulated(200, rate=300)


def test_samples_modulate_a_board_that_holds_some() -> None:
    samples = (1 + np.cos(2 * np.pi * np.arange(200) / 20)) / 2
    with midair.connect("autd3:loop", array=ARRAY) as board:
        board.send(midair.solve(midair.Scene(board.board.array, [[0, 0, Z]])))
        board.modulate(samples)
        assert board.state == "modulating"
        board.modulate(None)
        assert board.state == "playing"
        with pytest.raises(midair.SceneError, match=r"hz\[1\] is 2.0: give numbers from 0 to 1"):
            board.modulate([0.0, 2.0])
        with pytest.raises(midair.BoardError, match="modulation of 1 sample: an AUTD3 board holds 2 to 65536"):
            board.modulate([1.0])
    with (
        midair.connect("sonicsurface:loop") as board,
        pytest.raises(midair.BoardError, match="sonicsurface holds no samples: give a frequency"),
    ):
        board.modulate(samples)


def test_samples_become_the_boards_codes() -> None:
    from midair._boards import autd3_commands as commands

    steps = commands.modulation(bytes([255, 128, 0, 128]))
    assert steps[0].payloads[0].endswith(bytes([255, 128, 0, 128]))


@pytest.mark.slow
def test_techniques_of_a_caller_are_compared_at_equal_drive() -> None:
    place, rate = [0, 0, 0.2], 4e3
    ring = midair.path.circle(place, 0.01, frequency=200)
    corners = midair.shape.circle(place, 0.01)
    own = {
        "AM": midair.path.still(corners, duration=0.1).modulated(200, "cosine"),
        "AM of eight": midair.path.still(corners[::4], duration=0.1).modulated(200, "cosine"),
        "STM": ring,
    }
    found = midair.haptic(ring, ARRAY, rate=rate, techniques=own)
    assert list(found.standards)[:3] == list(own)
    assert len(found.standards) == 7
    assert (found.technique, found.gain) == ("STM", 0)
    # The level does not depend on how finely the same circle is sampled.
    assert abs(found.standards["AM"] - found.standards["AM of eight"]) < 3
    alone = midair.sequence(ARRAY, ring, rate=rate, change=np.pi)
    assert np.abs(found.sequence.drives).max() == pytest.approx(np.abs(alone.drives).max())
    with pytest.raises(midair.SceneError, match=r"techniques\.AM is 3: give a path of midair\.path"):
        midair.haptic(ring, ARRAY, rate=rate, techniques={"AM": 3})


def test_a_push_is_found_that_presses_more_than_usual_techniques() -> None:
    line = [[-0.015, 0, 0.15], [0.015, 0, 0.15]]
    found = midair.haptic(line, ARRAY, rate=1e3, aim="pressure")
    assert found.technique.startswith("pressure")
    assert "of pressure" in repr(found)
    assert found.gain > 6
    assert found.pressure == pytest.approx(20 * np.log10(found.skin.pressed[nearest(found, line)].mean()), abs=1)
    assert found.strength < max(found.standards.values())


def nearest(found: midair.Haptic, line: Any) -> list[int]:
    """Returns the indices of the skin's places nearest to places along a line."""
    places = np.linspace(*line, 16)
    return [int(np.linalg.norm(found.skin.places - place, axis=1).argmin()) for place in places]


@pytest.mark.slow
def test_it_is_as_quiet_as_requested_at_the_ears() -> None:
    array = midair.Array.grid(8, 8, 10e-3)
    line, ears = [[-0.01, 0, 0.1], [0.01, 0, 0.1]], {"ear": [0, 0.1, 0.3]}
    own = {"amplitude": midair.path.still([0, 0, 0.1], duration=0.05).modulated(200)}
    loud = midair.haptic(line, array, rate=1e3, techniques=own, ears=ears, limit=150)
    level = midair.exposure(loud.sequence, ears, audible=True).loudest
    quiet = midair.haptic(line, array, rate=1e3, techniques=own, ears=ears, limit=150, quiet=level - 20)
    assert quiet.exposure.loudest <= level - 20 + 1e-6
    assert max(quiet.standards.values()) == pytest.approx(quiet.strength)
    assert "dB(A) at most" in repr(quiet)
    # Strength and audible pressure go with the square of the drives.
    played = midair.sequence(array, own["amplitude"], rate=1e3, change=np.pi)
    before = midair.exposure(played, ears, audible=True).loudest
    assert loud.standards["amplitude"] - quiet.standards["amplitude"] == pytest.approx(
        max(before - level + 20, 0), abs=0.2
    )
    with pytest.raises(midair.SceneError, match="ears is None: give the ears"):
        midair.haptic(line, array, rate=1e3, quiet=30)


@pytest.mark.long
def test_the_page_has_the_strength_push_and_sound_of_six_techniques() -> None:
    page = (Path(__file__).parents[2] / "docs/touch.md").read_text("utf-8")
    array, place = midair.Array.preset("autd3"), [0, 0, 0.15]
    for name, path in list(midair.recipes(place).items())[:6]:
        played = midair.sequence(array, path, rate=4e3, change=np.pi)
        (row,) = [line.split("|") for line in page.splitlines() if line.startswith(f"| {name} |")]
        skin = midair.skin(played)
        sound = played.exposure({"ear": [0, 0.15, 0.45]}, audible=True, limit=150).loudest
        if name == "AM":
            least = sound - skin.level
        if name == "LM":
            fine = midair.sequence(array, path, rate=20e3, change=np.pi)
            quiet = fine.exposure({"ear": [0, 0.15, 0.45]}, audible=True, limit=150).loudest
            assert quiet == pytest.approx(33, abs=0.6)
            assert quiet - midair.skin(fine).level < least - 15
        found = np.array([skin.level, 1e3 * skin.felt_force, sound])
        assert found == pytest.approx([float(cell) for cell in row[3:6]], abs=0.6), name
