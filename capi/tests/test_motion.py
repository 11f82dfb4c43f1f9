"""Motion files: their frames, their drives and the bytes of a board are those of the package."""

from ctypes import c_void_p
from pathlib import Path

import numpy as np
import pytest

import midair
from library import Library
from midair._sequence.solve import motion_of, solve_motion

#: The layout of midair_motion in C.
MOTION = np.dtype([("frames", "u8"), ("points", "u8"), ("rate", "f8"), ("closed", "i4")], align=True)
CIRCLE = """
[[motion.path]]
kind = "circle"
center = [0.0, 0.0, 0.15]
radius = 0.01
frequency = 20.0
points = 2
"""
LINE = """
[[motion.path]]
kind = "line"
start = [-0.02, 0.0, 0.13]
end = [0.02, 0.01, 0.15]
frequency = 20.0
there_and_back = true
"""
FILES = {
    "circle": '[array]\npreset = "autd3"\n[motion]\nrate = 1000.0\n' + CIRCLE,
    "two paths of pressures": '[array]\npreset = "autd3"\n[motion]\nrate = 1e3\nchange = 0.4\n'
    + CIRCLE
    + "pressure = 150.0\n"
    + LINE
    + "pressure = 90.0\nam = { frequency = 100.0 }\n",
    "modulated": '[array]\npreset = "sonicsurface"\n[motion]\nrate = 1e3\nchange_rate = 400.0\ntau = 0.2e-3\n'
    + CIRCLE
    + "am = { frequency = 40.0, depth = 0.5 }\n",
    "traps": 'signature = "trap"\n[array]\npreset = "openmpd_pair"\n[bead]\nradius = 1.2e-3\n'
    "[motion]\nrate = 2e3\n[[motion.path]]\nkind = 'polyline'\nclosed = true\nspeed = 0.3\n"
    "corners = [[0.0, 0.0, 0.0], [0.004, 0.0, 0.0], [0.004, 0.0, 0.004]]\n",
    "another solver": '[array]\npreset = "paper20"\n[solver]\nname = "greedy"\nphases = 16\n'
    "[motion]\nrate = 500.0\n" + LINE,
    "frames": '[array]\npreset = "sonicsurface"\n[motion]\nrate = 200.0\nfile = "points.npy"\n',
}
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")


@pytest.mark.parametrize("name", FILES)
def test_a_motion_file_is_played_as_by_the_package(library: Library, name: str, tmp_path: Path) -> None:
    random = np.random.default_rng(5).normal(0, 2e-5, (12, 3, 3)).cumsum(axis=0)
    start = np.array([[-0.02, 0, 0.12], [0.02, 0, 0.12], [0, 0.02, 0.14]])
    np.save(tmp_path / "points.npy", start + random)
    file = tmp_path / "motion.toml"
    file.write_text(FILES[name], "utf-8")
    moving = motion_of(file)
    assert moving is not None
    wanted = solve_motion(moving)
    array = moving.scene.array
    session = library.new("session_open", FILES[name], str(tmp_path))
    motion = np.zeros(1, MOTION)
    library.done("session_motion", session, motion)
    frames, count = wanted.targets.shape
    assert motion[0].tolist() == (frames, count, wanted.rate, wanted.closed)
    points, targets = np.zeros((frames, count, 3)), np.zeros((frames, count))
    library.done("session_frames", session, 0, frames, points, targets)
    np.testing.assert_array_equal(points, wanted.points)
    np.testing.assert_array_equal(targets, wanted.targets)
    # In two parts: the second one goes on from the first. In one call for methods that do not remember.
    drives, some = np.zeros((frames, len(array)), np.complex64), 7 if name != "another solver" else frames
    library.done("session_follow", session, 0, some, drives[:some], len(array))
    if some < frames:
        library.done("session_follow", session, some, frames - some, drives[some:], len(array))
    # Phase codes are converted back to drives, which rounds.
    np.testing.assert_allclose(drives, wanted.drives, atol=2e-7)
    if wanted.codes is None:
        np.testing.assert_array_equal(drives, wanted.drives)
    if kind := midair.presets()[FILES[name].partition('preset = "')[2].partition('"')[0]].board:
        board, own = midair.Board(kind, array), library.new("board_of_session", kind, session)
        frame = np.zeros(library.plain("board_frame_size", own), np.uint8)
        for drive, other in zip(drives, wanted.drives, strict=True):
            library.done("board_encode", own, drive, len(array), frame, len(frame))
            assert frame.tobytes() == board.encode(other)
        library.plain("board_free", own)
    library.plain("session_free", session)


REFUSED = {
    "frames beyond the last": (["session_follow", 40, 20], "frames is 20 from 40 on: the motion has 50"),
    "no frames": (["session_follow", 0, 0], "frames is 0 from 0 on"),
    "the scene's own request": (["session_solve"], "points is left out: the scene has [motion]"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_a_motion_has_not_is_refused(library: Library, what: str) -> None:
    session = library.new("session_open", FILES["circle"], None)
    (name, *numbers), fault = REFUSED[what]
    drives = np.zeros((20, 249), np.complex64)
    rest = [None, None, None, 0, drives, 249, None] if name == "session_solve" else [*numbers, drives, 249]
    result, message = library.call(name, session, *rest)
    assert result == 1
    assert fault in message
    library.plain("session_free", session)


def test_an_option_leaves_the_motion_as_it_is(library: Library) -> None:
    session, motion = library.new("session_open", FILES["circle"], None), np.zeros(1, MOTION)
    library.done("session_set_number", session, "steps", 3.0)
    library.done("session_motion", session, motion)
    assert motion[0].tolist() == (50, 2, 1000.0, 1)
    library.plain("session_free", session)


def test_what_is_no_motion_is_refused(library: Library) -> None:
    text = '[array]\npreset = "autd3"\n[[points]]\nposition = [0.0, 0.0, 0.15]\n'
    session = library.new("session_open", text, None)
    result, message = library.call("session_motion", session, np.zeros(1, MOTION))
    assert (result, message.partition(":")[0]) == (1, "motion is not there")
    library.plain("session_free", session)
    for wrong, fault in (
        ("ahead = 4", "line 5, column 9: motion.ahead is 4: midair's Python package solves"),
        ("rate = -1", "line 4, column 8: motion.rate is"),
    ):
        text = FILES["circle"].replace("rate = 1000.0", wrong if "rate" in wrong else f"rate = 1000.0\n{wrong}")
        result, message = library.call("session_open", text, None, np.zeros(1, np.uintp))
        assert result == 1
        assert fault in message


def test_points_that_are_too_fast_are_reported_as_by_the_package(library: Library, tmp_path: Path) -> None:
    text = FILES["circle"].replace("frequency = 20.0", "frequency = 50.0")
    handle = np.zeros(1, np.uintp)
    said = library.done("session_open", text, None, handle)
    library.plain("session_free", c_void_p(int(handle[0])))
    (tmp_path / "motion.toml").write_text(text, "utf-8")
    with pytest.warns(midair.SceneWarning) as reported:
        solve_motion(motion_of(tmp_path / "motion.toml"))
    assert [said] == [str(each.message) for each in reported if "m/s needs" in str(each.message)]
