"""Absurd arguments, as numbers of any size, empty or ragged lists, None: each gets an answer or one line."""

from typing import Any

import numpy as np
import pytest

import midair
from absurd import CALLS

ABSURD: list[Any] = [
    *(None, True, 1j, "x", b"x", object(), {}, [], [[]], [[1, 2], [3]], [[None] * 3], [["a", "b", "c"]]),
    *(1e308, -1e308, 1e-308, 5e-324, 2**70, 1e30, float("nan"), float("inf")),
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
