"""Sessions made from the text of a scene file give the same bits as the package."""

from ctypes import c_void_p
from pathlib import Path

import numpy as np
import pytest

import midair
from library import METRICS, Library

POINTS = """
[[points]]
position = [-0.02, 0.01, 0.12]
pressure = 900.0

[[points]]
position = [0.02, 0.0, 0.13]
pressure = 700.0
weight = 2.0
"""
WALL = "[[obstacles]]\npoint = [0.0, 0.08, 0.0]\nnormal = [0.0, -1.0, 0.0]\n"
SPHERE = '[[obstacles]]\ncenter = [0.0, -0.02, 0.07]\nradius = 0.01\nkind = "soft"\n'
SCENES = {
    "plain": '[array]\npreset = "paper20"\n',
    "medium": '[array]\npreset = "autd3"\n[medium]\ntemperature = 31.0\nabsorption = 0.2\n',
    "wall": "[array]\ngrid = { nx = 12, ny = 10, pitch = 0.0105 }\n" + WALL,
    "sphere": '[array]\npreset = "openmpd_board"\n' + SPHERE,
    "two walls": '[array]\npreset = "openmpd_board"\n' + WALL + WALL.replace("-1.0", "1.0").replace("0.08", "-0.09"),
    "trap": 'signature = "trap"\n[array]\npreset = "openmpd_board"\n',
    "vortex at a wall": 'signature = "vortex"\n[array]\npreset = "openmpd_board"\n' + WALL,
    "solver": '[array]\npreset = "paper20"\n[solver]\nname = "greedy"\nphases = 32\nseed = 7\n',
    "aim": '[array]\npreset = "autd3"\n[solver]\nname = "uniform"\naim = "max"\n',
    "mask": "[array]\ngrid = { nx = 2, ny = 2, pitch = 0.01 }\nmask = [true, false, true, true]\n",
}
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")


@pytest.mark.parametrize("toml", [True, False])
@pytest.mark.parametrize("name", SCENES)
def test_a_scene_from_text(library: Library, name: str, toml: bool) -> None:
    text = SCENES[name] + POINTS
    scene = midair.Scene.parse(text)
    if not toml:
        text = scene.json()
    solution = midair.solve(scene)
    session = library.new("session_open", text, None)
    assert library.plain("session_transducers", session) == len(scene.array)
    for _ in range(2):
        drive, answer = library.solve(session, len(scene.array), np.zeros((0, 3)))
        assert drive.tobytes() == solution.drive.astype(np.complex64).tobytes()
        assert [answer[metric] for metric in METRICS] == [getattr(solution.metrics, metric) for metric in METRICS]
        count = library.plain("session_points", session)
        assert count == len(scene.points)
        pressures, points = np.zeros(count, np.complex64), np.zeros((count, 3))
        library.done("session_pressures", session, pressures, points, count)
        assert pressures.tobytes() == solution.pressures.astype(np.complex64).tobytes()
        np.testing.assert_array_equal(points, scene.points)
        judged = midair.judge(scene, solution.drive, precision="double")
        metrics = np.zeros(len(METRICS))
        library.done("session_judge", session, drive, len(drive), None, None, None, 0, metrics)
        assert metrics.tolist() == [getattr(judged, metric) for metric in METRICS]
        # A call with points of the caller solves another request; the next call without points solves the
        # scene's own request again.
        library.solve(session, len(scene.array), np.array([[0.0, 0.01, 0.14]]))
    library.plain("session_free", session)


def test_a_bead_by_name_is_that_of_a_scene(library: Library) -> None:
    trap = '[array]\npreset = "tinylev"\nchannels = [' + ", ".join(map(str, range(72))) + "]\n"
    text = 'signature = "trap"\n' + trap + "[[points]]\nposition = [0.0, 0.0, 0.002]\n"
    bead = {"radius": 0.8e-3, "density": 150.0, "sound_speed": 1000.0, "gravity": [-9.81, 0.0, 0.5]}
    wanted = midair.solve(midair.Scene.parse(text).replace(bead=bead))
    session = library.new("session_open", text, None)
    usual, _ = library.solve(session, 72, np.zeros((0, 3)))
    for name, value in bead.items():
        if isinstance(value, list):
            library.done("session_set_numbers", session, f"bead.{name}", np.array(value), 3)
        else:
            library.done("session_set_number", session, f"bead.{name}", value)
    drive, _ = library.solve(session, 72, np.zeros((0, 3)))
    assert drive.tobytes() == wanted.drive.astype(np.complex64).tobytes()
    assert drive.tobytes() != usual.tobytes()
    library.plain("session_free", session)


@pytest.mark.parametrize(("channels", "fallen"), [("", True), (f"channels = {[*range(72)]}\n", False)])
def test_beads_that_fall_are_in_the_message_of_a_solve(library: Library, channels: str, fallen: bool) -> None:
    places = [[0.01, 0, 0], [-0.01, 0, 0], [0, 0.01, 0], [0, -0.01, 0]]
    points = "".join(f"[[points]]\nposition = {place}\n" for place in places)
    text = f'signature = "trap"\n[array]\npreset = "tinylev"\n{channels}{points}'
    session = library.new("session_open", text, None)
    drive = np.zeros(72, np.complex64)
    said = [library.done("session_solve", session, None, None, None, 0, drive, 72, None) for _ in range(2)]
    assert said[0].startswith("traps hold 0 of 4 beads: ") if fallen else not said[0]
    assert not said[1]
    library.plain("session_free", session)


def test_positions_in_millimetres_are_in_the_messages_of_session_and_solve(library: Library) -> None:
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    array = library.new("array_new", np.stack([10 * x, 10 * y, 0 * x], axis=-1).reshape(16, 3).copy(), None, 16)
    handle, drive = np.zeros(1, np.uintp), np.zeros(16, np.complex64)
    said = library.done("session_new", array, "uniform", handle)
    assert "10 mm are 0.01 m" in said
    session, points = c_void_p(int(handle[0])), np.array([[15.0, 15.0, 100.0]])
    solves = [library.done("session_solve", session, points, None, None, 1, drive, 16, None) for _ in range(2)]
    assert solves[0].splitlines()[0] == said
    assert said not in solves[1]
    library.plain("session_free", session)
    library.plain("array_free", array)


def test_files_are_looked_up_in_the_folder(library: Library, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("0,0,0\n0.01,0,0\n0,0.01,0\n0.01,0.01,0\n", "utf-8")
    text = '[array]\npositions = { file = "a.csv" }\n' + POINTS
    session = library.new("session_open", text, str(tmp_path))
    assert library.plain("session_transducers", session) == 4
    library.plain("session_free", session)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "scene: empty: it needs at least [array]"),
        ('[array]\nprest = "autd3"\n', "scene, line 2, column 1: unknown key of array"),
        ('{"array": {"preset": "autd3"}, "points": [{"position": [0, 0]}]}', "scene, line 1, column 56"),
        (
            '[array]\npositions = { file = "a.csv" }\n' + POINTS,
            "this document has no folder to find files in",
        ),
        ('[array]\npreset = "autd3"\n[motion]\nrate = 1\n', "motion.path is left out"),
        (
            '[array]\npreset = "autd3"\n[[shape]]\nkind = "text"\nstring = "hi"\nheight = 0.03\nz = 0.15\n',
            "midair's Python package draws it",
        ),
    ],
)
def test_a_text_that_is_no_scene_is_refused_in_its_line(library: Library, text: str, fault: str) -> None:
    handle = np.zeros(1, np.uintp)
    result, message = library.call("session_open", text, None, handle)
    assert result == 1
    assert fault in message
    assert "\n" not in message
    assert handle[0] == 0
