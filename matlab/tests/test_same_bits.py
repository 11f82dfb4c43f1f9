"""MATLAB's functions give the bits of the Python package."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._sequence.solve import motion_of, solve_motion

Octave = Callable[[str], str]
METRICS = ["accuracy", "sigma", "uniformity", "level", "residual", "leak"]
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
SCENES = {
    "plain": '[array]\npreset = "paper20"\n',
    "coarse": '[array]\npreset = "sonicsurface"\n[solver]\nname = "fast"\n',
    "wall": "[array]\ngrid = { nx = 12, ny = 10, pitch = 0.0105 }\n[medium]\ntemperature = 31.0\n" + WALL,
    "trap": 'signature = "trap"\n[array]\npreset = "openmpd_board"\n[bead]\nradius = 0.8e-3\n',
    "mask": "[array]\ngrid = { nx = 2, ny = 2, pitch = 0.01 }\nmask = [true, false, true, true]\n",
}
ARRAY = "[array]\ngrid = { nx = 12, ny = 10, pitch = 0.0105 }\n"
PLACES = np.array([[0.0, 0.01, 0.14], [0.01, -0.02, 0.1], [0.0, 0.0, 0.2]])
#: What write_arrays() writes of a solution.
RECORD = "write_arrays(name, parts(s.drive), parts(s.pressures), s.points, s.steps, s.scale, values(s.metrics));"
START = """
function numbers = values(s), numbers = cell2mat(struct2cell(s)); end
function numbers = parts(z), numbers = [real(z(:)), imag(z(:))].'; end
warning('off', 'midair:scene');
places = [0 0.01 0.14; 0.01 -0.02 0.1; 0 0 0.2];
"""
pytestmark = pytest.mark.filterwarnings("ignore::midair.SceneWarning")


def matrix(values: np.ndarray) -> str:
    """Returns a matrix of MATLAB with all bits."""
    return "[" + "; ".join(" ".join(f"{x:.17g}" for x in row) for row in np.atleast_2d(values)) + "]"


def drives(*solved: np.ndarray) -> bytes:
    return b"".join(array.astype(np.complex128).tobytes(order="F") for array in solved)


def reals(*values: object) -> bytes:
    return b"".join(np.asarray(value, float).tobytes(order="F") for value in values)


def expected(solution: midair.Solution) -> bytes:
    """Returns the bytes that RECORD writes."""
    metrics = [getattr(solution.metrics, name) for name in METRICS]
    return drives(solution.drive, solution.pressures) + reals(
        solution.scene.points, solution.steps, solution.scale, metrics
    )


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_from_text(octave: Octave, tmp_path: Path, name: str) -> None:
    text = SCENES[name] + POINTS
    (tmp_path / "scene.toml").write_text(text, "utf-8")
    scene = midair.Scene.parse(text)
    (tmp_path / "scene.json").write_text(scene.json(), encoding="utf-8")
    # A scene that is solved for other points in between still has its own request.
    octave(f"""{START}
    for form = {{'toml', 'json'}}
      name = form{{1}};
      scene = midair.Scene(fileread(['scene.' name]));
      for k = 1:2
        s = midair.solve(scene);
        assert(s.status, '{midair.solve(scene).status}');
        {RECORD}
        write_arrays(name, parts(midair.field(s, places)), parts(midair.field(scene, s.drive.', places)));
        write_arrays(name, values(midair.judge(scene, s.drive * s.scale)));
        other = midair.solve(scene, places, [800 600 700], 2);
        judged = midair.judge(scene, other.drive, places, 700, [1; 2; 3]);
        write_arrays(name, parts(other.drive), values(judged));
      end
    end""")
    solution = midair.solve(scene)
    played = solution.drive.astype(complex) * solution.scale
    own = midair.judge(scene, played, precision="double")
    field = midair.field(scene, solution.drive, PLACES).pressure
    moved = scene.replace(points=PLACES, pressures=[800, 600, 700], weights=[2, 2, 2])
    other = midair.solve(moved).drive
    judged = midair.judge(
        scene.replace(points=PLACES, pressures=[700] * 3, weights=[1, 2, 3]), other, precision="double"
    )
    wanted = expected(solution) + drives(midair.field(solution, PLACES).pressure, field)
    wanted += reals([getattr(own, name) for name in METRICS])
    wanted += drives(other) + reals([getattr(judged, name) for name in METRICS])
    for form in ("toml", "json"):
        assert (tmp_path / form).read_bytes() == 2 * wanted


def test_every_method(octave: Octave, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    requests = []
    for method in sorted(midair.solvers()):
        points = rng.uniform([-0.03, -0.03, 0.1], [0.03, 0.03, 0.16], (4, 3))
        requests.append((method, points, rng.uniform(500, 1000, 4)))
    octave(
        START
        + "".join(
            f"""
    scene = struct('array', struct('grid', struct('nx', 12, 'ny', 10, 'pitch', 0.0105)));
    scene.solver.name = '{method}';
    name = '{method}';
    s = midair.solve(scene, {matrix(points)}, {matrix(pressures)});
    {RECORD}"""
            for method, points, pressures in requests
        )
    )
    for method, points, pressures in requests:
        scene = midair.Scene(midair.Array.grid(12, 10, 0.0105), points, pressures=pressures)
        assert (tmp_path / method).read_bytes() == expected(midair.solve(scene, method)), method


def test_a_struct_is_the_same_scene(octave: Octave, tmp_path: Path) -> None:
    octave(f"""{START}
    content.array.preset = 'openmpd_board';
    content.medium.temperature = 31;
    content.obstacles = {{struct('point', [0 0.08 0], 'normal', [0 -1 0])}};
    content.solver = struct('name', 'greedy', 'phases', 32, 'seed', 7);
    positions = {{[-0.02 0.01 0.12], [0.02 0 0.13]}};
    content.points = struct('position', positions, 'pressure', {{900, 700}}, 'weight', {{1, 2}});
    content.signature = 'trap';
    name = 'tables';
    s = midair.solve(content);
    {RECORD}
    content.points = [-0.02 0.01 0.12; 0.02 0 0.13];
    name = 'matrix';
    s = midair.solve(content);
    {RECORD}""")
    scene = midair.Scene.parse(
        'signature = "trap"\n[array]\npreset = "openmpd_board"\n[medium]\ntemperature = 31.0\n'
        '[solver]\nname = "greedy"\nphases = 32\nseed = 7\n' + WALL + POINTS
    )
    assert (tmp_path / "tables").read_bytes() == expected(midair.solve(scene))
    alone = scene.replace(pressures=None, weights=None)
    assert (tmp_path / "matrix").read_bytes() == expected(midair.solve(alone))


def test_a_motion_and_its_bytes(octave: Octave, tmp_path: Path) -> None:
    text = (
        '[array]\npreset = "sonicsurface"\n[motion]\nrate = 200.0\n[[motion.path]]\nkind = "circle"\n'
        "center = [0.0, 0.0, 0.12]\nradius = 0.01\nfrequency = 10.0\npoints = 2\n"
    )
    (tmp_path / "motion.toml").write_text(text, "utf-8")
    octave(f"""{START}
    scene = midair.Scene(fileread('motion.toml'));
    s = midair.sequence(scene);
    assert(s.closed && s.rate == 200);
    write_arrays('drives', parts(s.drives));
    write_arrays('places', permute(s.points, [2 1 3]), s.targets);
    bytes = midair.encode(scene, 'sonicsurface', s.drives);
    write_arrays('bytes', bytes);
    assert(midair.encode(scene, 'sonicsurface', s.drives(:, 1).'), bytes(:, 1));
    write_arrays('silence', midair.silence(scene, 'sonicsurface'));""")
    moving = motion_of(tmp_path / "motion.toml")
    assert moving is not None
    wanted = solve_motion(moving)
    made = np.frombuffer((tmp_path / "drives").read_bytes(), complex).reshape(20, 256)
    np.testing.assert_allclose(made, wanted.drives, atol=2e-7)
    assert (tmp_path / "places").read_bytes() == reals(wanted.points.ravel(), wanted.targets.ravel())
    board = midair.Board("sonicsurface")
    assert (tmp_path / "bytes").read_bytes() == b"".join(bytes(board.encode(drive)) for drive in made)
    assert (tmp_path / "silence").read_bytes() == bytes(board.silence)


def test_files_are_looked_up_in_the_folder(octave: Octave, tmp_path: Path) -> None:
    (tmp_path / "ü").mkdir()
    (tmp_path / "ü" / "a.csv").write_text("0,0,0\n0.01,0,0\n0,0.01,0\n", "utf-8")
    octave("""
    content = struct('array', struct('positions', struct('file', 'a.csv')), 'points', [0 0 0.1]);
    solution = midair.solve(midair.Scene(content, fullfile(pwd, 'ü')));
    assert(numel(solution.drive), 3);""")
