"""Memory stays the same over 100,000 calls."""

from collections.abc import Callable


def test_many_calls_take_no_more_memory(octave: Callable[[str], str]) -> None:
    grown, unit = octave("many_calls(10000)").split()
    assert unit == "kB"
    # A leak of 4 bytes a call would be 352 kB.
    assert int(grown) < 256


def test_scenes_are_closed_after_their_functions_are_cleared(octave: Callable[[str], str]) -> None:
    octave("""
    content.array.preset = 'autd3';
    scene = midair.Scene(setfield(content, 'points', [0 0 0.15]));
    copy = scene;
    clear midair_mex scene
    solution = midair.solve(copy);
    lastwarn('');
    clear -f
    clear copy solution
    assert(isempty(lastwarn()), lastwarn());
    clear all
    """)
