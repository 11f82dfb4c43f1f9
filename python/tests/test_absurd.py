"""Absurd arguments, as numbers of any size, empty or ragged lists, None: each gets an answer or one line."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import midair
from absurd import ARRAY, CALLS, FOLDER, FRAMES, LINE, PAIR_OF_FOCI, SCENE, SOLUTION
from midair._serve.live import Live

ABSURD: list[Any] = [
    *(None, True, 1j, "x", "\ud800", b"x", object(), {}, [], [[]], [[1, 2], [3]], [[None] * 3], [["a", "b", "c"]]),
    *(1e308, -1e308, 1e-308, 5e-324, 1e-90, 1e90, 2**70, 1e30, float("nan"), float("inf"), {"\ud800": 1}),
    *([[1e308] * 3], [[1e-308] * 3], np.zeros((0, 3)), np.zeros(0), np.zeros((2, 2, 3, 2)), np.array(None)),
]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("name", CALLS)
def test_absurd_arguments_get_one_line_or_an_answer(name: str) -> None:
    for bad in ABSURD:
        try:
            CALLS[name](bad)
        except (midair.SceneError, TypeError, MemoryError) as error:
            text = str(error)
            assert "\n" not in text, bad
            assert 0 < len(text) < 600, bad
            # Python's own words are of the package's inside, not of the argument.
            assert "unsupported operand" not in text, bad
            assert "has no attribute" not in text, bad


STILL, DRIVES = midair.path.still([0, 0, 0.1], duration=1), np.ones((2, len(ARRAY)), np.complex64)


def on_a_board(call: Callable[[midair.Connection], Any]) -> None:
    with midair.connect("sonicsurface:loop") as board:
        call(board)


#: Every place that reads frames per second.
RATES: dict[str, Callable[[float], Any]] = {
    "from_array": lambda rate: midair.path.from_array(FRAMES, rate=rate),
    "frames": lambda rate: STILL.frames(rate),
    "lcode": lambda rate: midair.path.lcode(FOLDER / "rated", rate=rate),
    "sequence": lambda rate: midair.sequence(ARRAY, FRAMES, rate=rate),
    "sequence of a path": lambda rate: midair.sequence(ARRAY, STILL, rate=rate),
    "sequence with later frames": lambda rate: midair.sequence(ARRAY, FRAMES, rate=rate, ahead="all"),
    "Sequence": lambda rate: midair.Sequence(ARRAY, FRAMES, 1.0, DRIVES, rate=rate),
    "stream": lambda rate: next(midair.stream(ARRAY, iter(FRAMES), rate=rate)),
    "glide": lambda rate: midair.solve(SCENE, "glide", rate=rate),
    "modulated": lambda rate: SOLUTION.modulated(200, rate=rate),
    "multiplex": lambda rate: midair.multiplex(PAIR_OF_FOCI, 2, rate=rate),
    "haptic": lambda rate: midair.haptic(LINE, ARRAY, rate=rate),
    "serve": lambda rate: on_a_board(lambda board: Live(board, rate)),
    "played": lambda rate: on_a_board(lambda board: board.stream([], rate=rate)),
}


@pytest.mark.parametrize("name", RATES)
def test_frames_per_second_have_one_bound(name: str) -> None:
    (FOLDER / "rated").write_text("L1:0,0,0.01;\nL1:0,0.001,0.01;", "utf-8")
    for rate in (1e-90, 9.9e-3, 1.01e7, 1e90):
        with pytest.raises(midair.SceneError, match=r"rate is .*: give 0\.01 to 1e7 frames a second$"):
            RATES[name](rate)
