"""Memory stays the same over 100,000 calls."""

from collections.abc import Callable


def test_many_calls_take_no_more_memory(octave: Callable[[str], str]) -> None:
    grown, unit = octave("many_calls(10000)").split()
    assert unit == "kB"
    # A leak of 4 bytes a call would be 352 kB.
    assert int(grown) < 256
