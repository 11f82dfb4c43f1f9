"""`midair.haptic`: what it chooses is felt as reported, within the bound, and spares ears."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import midair

ARRAY = midair.Array.preset("autd3")
Z = 0.15
LINE = [[-0.02, 0, Z], [0.02, 0, Z]]


def along(touch: midair.Skin, places: Any) -> float:
    return float(20 * np.log10(touch.along(places).mean()))


@pytest.mark.slow
def test_strokes_are_felt_more_than_the_usual_techniques() -> None:
    found = midair.haptic(LINE, ARRAY, rate=4e3)
    assert found.gain > 0.2
    assert len(found.standards) == 4
    assert found.technique not in found.standards
    assert len(found.sequence) <= 1024
    # What is reported is what the skin gets of the drives.
    again = midair.skin(found.sequence, found.skin.hand)
    places = np.linspace(*np.array(LINE), 20)
    assert along(again, places) == pytest.approx(found.strength, abs=0.2)
    assert "strokes" in repr(found)
    assert "dB" in found._repr_html_()


@pytest.mark.slow
def test_even_is_at_least_as_strong_where_it_is_weakest() -> None:
    strong, even = (midair.haptic(LINE, ARRAY, rate=4e3, aim=aim) for aim in ("strong", "even"))
    assert even.weakest >= strong.weakest
    assert even.strength <= strong.strength


@pytest.mark.slow
def test_ears_are_spared_at_a_lower_level() -> None:
    ears = {"ear": [0, 0.05, 0.3]}
    loud = midair.haptic(LINE, ARRAY, rate=4e3, ears=ears, limit=160.0)
    spared = midair.haptic(LINE, ARRAY, rate=4e3, ears=ears, limit=loud.exposure["ear"].spl - 6)
    assert spared.exposure["ear"].spl == pytest.approx(loud.exposure["ear"].spl - 6, abs=0.05)
    with pytest.raises(midair.SceneError, match="and the board has one amplitude: move away"):
        midair.haptic(LINE, midair.Array.preset("sonicsurface"), rate=89, ears=ears, limit=60)
    # The push goes with the square of the pressure.
    assert spared.strength == pytest.approx(loud.strength - 12, abs=0.1)


@pytest.mark.slow
def test_the_bound_is_kept_and_a_slow_board_has_its_frames() -> None:
    small = midair.Array.grid(8, 8, 0.01)
    bounded = midair.haptic(LINE, small, rate=2e3, change=0.5)
    assert bounded.sequence.metrics.largest_change <= 0.5 + 1e-6
    slow = midair.haptic(LINE, midair.Array.preset("sonicsurface"), rate=89)
    assert slow.sequence.rate == 89
    assert slow.gain >= 0


@pytest.mark.parametrize(
    ("ask", "told"),
    [
        (lambda: midair.haptic(LINE, ARRAY, rate=0), "rate is 0: give a number above 0"),
        (lambda: midair.haptic(LINE, ARRAY, rate=4e3, aim="loud"), 'aim is "loud": give "strong" or "even"'),
        (lambda: midair.haptic([[0, 0, Z]], ARRAY, rate=4e3), "shape is .*: give at least two places"),
        (lambda: midair.haptic([[0, 0, Z]] * 2, ARRAY, rate=4e3), 'shape is "0 m long": give places'),
        (
            lambda: midair.haptic(midair.path.still([0, 0, Z], duration=1), ARRAY, rate=4e3),
            'shape is "0 m long"',
        ),
    ],
)
def test_what_is_no_shape_is_refused_in_one_line(ask: Callable[[], Any], told: str) -> None:
    with pytest.raises(midair.SceneError, match=told):
        ask()
