"""Bad inputs: an error of one line each, and no crash."""

import re
from collections.abc import Callable


def test_a_thousand_bad_calls(octave: Callable[[str], str]) -> None:
    printed = octave("bad_inputs")
    found = re.fullmatch(r"(\d+) bad calls, (\d+) refused by midair\n", printed)
    assert found, printed
    assert int(found[1]) >= 1000
    # The others are refused by the language, such as a cell instead of a drive.
    assert int(found[2]) > 800


def test_errors_have_the_codes_of_the_library(octave: Callable[[str], str]) -> None:
    octave("""
    function line = refusal(id, call)
      try
        call();
        error('not refused');
      catch fault
        assert(fault.identifier, id);
        line = fault.message;
      end
    end
    content.array.grid = struct('nx', 2, 'ny', 2, 'pitch', 0.01);
    scene = midair.Scene(setfield(content, 'points', [0 0 0.1]));
    point = [0 0 0.1];
    assert(refusal('midair:too_near', @() midair.solve(scene, [0.005 0.005 0])), ...
      ['points[0] is 0.000e0 m from transducer 3: ' ...
      'move it at least 8.500e-5 m (a hundredth of the wavelength) away']);
    assert(refusal('midair:shape', @() midair.solve(scene, [0 0 0.1; 0 0 0.11]')), ...
      'points is 3 x 2: give M x 3, a row for each point');
    assert(refusal('midair:shape', @() midair.solve(scene, zeros(0, 3))), ...
      'points is 0 x 3: give M x 3, a row for each point');
    assert(refusal('midair:shape', @() midair.solve(scene, point, [1 2])), ...
      'pressures has 2 numbers for 1 points: give points, and one number or one for each');
    assert(refusal('midair:type', @() midair.solve(scene, single(point))), ...
      'points is of class single: give real numbers of class double');
    assert(refusal('midair:missing', @() midair.solve(content)), ...
      ['scene, line 1, column 1: points is empty: give at least one point; ' ...
      'for example "points": [{"position": [0.0, 0.0, 0.15]}]']);
    delete(scene);
    assert(refusal('midair:missing', @() midair.solve(scene)), ...
      'the scene is closed: make another one by midair.Scene');
    """)


def test_warnings_are_those_of_matlab(octave: Callable[[str], str]) -> None:
    octave("""
    content.array.preset = 'autd3';
    midair.solve(content, [0 0 0.15], 1e6);
    [line, id] = lastwarn();
    assert(id, 'midair:scene');
    assert(strncmp(line, 'at 6.2 kPa the second harmonic', 30), line);
    """)
