"""Drawn points in scene files, on the command line and in figures: target, result and difference."""

import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image

import midair
from midair import _cli as cli, shape
from midair._midair import scene_files
from midair._pictures.plot import answer, at_points

ARRAY = "[array]\ngrid = { nx = 10, ny = 10, pitch = 0.01 }\n"
SVG = '<svg xmlns="http://www.w3.org/2000/svg"><rect width="30" height="10"/></svg>'


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("logo.svg").write_text(SVG, "utf-8")
    Image.fromarray(np.array([[255, 0], [128, 255]], np.uint8)).save("logo.png")


def parse(text: str) -> midair.Scene:
    return midair.Scene.parse(ARRAY + text, folder=".")


TABLES = {
    "kind = 'line'\nstart = [0, 0, 0.1]\nend = [0.03, 0, 0.12]": shape.line([0, 0, 0.1], [0.03, 0, 0.12]),
    "kind = 'circle'\ncenter = [0, 0, 0.1]\nradius = 0.02\nnormal = [1, 0, 0]\nstep = 0.003": shape.circle(
        [0, 0, 0.1], 0.02, normal=[1, 0, 0], step=0.003
    ),
    "kind = 'polyline'\npoints = [[0, 0, 0.1], [0.02, 0, 0.1], [0, 1, 1]]\nclosed = true": shape.polyline(
        [[0, 0, 0.1], [0.02, 0, 0.1], [0, 1, 1]], closed=True
    ),
    "kind = 'text'\nstring = 'hi'\nheight = 0.02\nz = 0.1\nfont = 'DejaVu Serif'": shape.text(
        "hi", height=0.02, z=0.1, font="DejaVu Serif"
    ),
}


@pytest.mark.parametrize("table", TABLES)
def test_a_table_has_the_points_of_its_function(table: str) -> None:
    for head, pressure in (("[shape]", "pressure = 70"), ("[[shape]]", "weight = 2.0")):
        scene = parse(f"{head}\n{table}\n{pressure}\n")
        assert (scene.points == TABLES[table]).all()
        count = len(scene.points)
        if "weight" in pressure:
            assert scene.pressures is None
            assert scene.weights == pytest.approx(np.full(count, 2.0))
        else:
            assert scene.pressures == pytest.approx(np.full(count, 70.0))
            assert scene.weights is None
    tables = midair.Scene.parse(json.dumps({**json.loads(scene.json()), "shape": []}))
    assert (tables.points == scene.points).all()


def test_points_shapes_and_pictures_stand_side_by_side_and_files_beside_the_scene(tmp_path: Path) -> None:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    for name in ("logo.svg", "logo.png"):
        Path(name).rename(folder / name)
    scene_file = folder / "scene.toml"
    scene_file.write_text(
        f"""{ARRAY}
[image]
file = "logo.png"
size = 0.02
z = 0.1
pixels = 2
[[shape]]
kind = "svg"
file = "logo.svg"
size = 0.03
z = 0.12
pressure = 30
weight = 3
[[shape]]
kind = "line"
start = [0, 0, 0.1]
end = [0.02, 0, 0.1]
pressure = 0
[[points]]
position = [0, 0, 0.11]
pressure = 10
""",
        encoding="utf-8",
    )
    scene = midair.Scene.load(scene_file)
    drawing, line = shape.svg(folder / "logo.svg", size=0.03, z=0.12), shape.line([0, 0, 0.1], [0.02, 0, 0.1])
    picture = midair.image(folder / "logo.png", size=0.02, z=0.1, pixels=2)
    assert (scene.points == np.concatenate([[[0, 0, 0.11]], drawing, line, picture.points])).all()
    counts = [1, len(drawing), len(line)]
    assert scene.pressures == pytest.approx(np.concatenate([np.repeat([10, 30, 0], counts), picture.pressures]))
    assert scene.weights == pytest.approx(np.repeat([1, 3, 1, 1], [*counts, 3]))
    assert scene_files(scene_file) == [scene_file, folder / "logo.svg", folder / "logo.png"]
    # Drawn shapes are saved as points: a saved scene needs no fonts and no drawings.
    scene.save(tmp_path / "saved.json")
    assert midair.Scene.load(tmp_path / "saved.json") == scene


@pytest.mark.parametrize(
    ("table", "reported"),
    [
        (
            "kind = 'square'",
            'line 4, column 8: shape.kind is "square": give one of line, circle, polyline, text',
        ),
        ("radius = 1.0", "line 3, column 1: shape.kind is left out: give one of line"),
        (
            "kind = 'circle'\nradius = 1.0",
            "line 3, column 1: shape.center is left out: circle needs center, radius",
        ),
        (
            "kind = 'line'\nradius = 1.0",
            "line 5, column 10: shape.radius is 1.0: line has start, end, step, pressure, weight, leave",
        ),
        (
            "kind = 'line'\nstart = [0, 0, 1]\nend = [0, 1]",
            "line 6, column 7: shape.end is [0, 1]: give 3",
        ),
        (
            "kind = 'line'\nstart = [0, 0, 1]\nend = [0, 1, 0]\nstep = nan",
            "line 7, column 8: shape.step is NaN",
        ),
        (
            "kind = 'line'\nstart = [0, 0, 1]\nend = [0, 1, 0]\npressure = -3",
            "column 12: shape.pressure is -3: give",
        ),
        (
            "kind = 'line'\nstart = [0, 0, 1]\nend = [0, 1, 0]\nweight = -3",
            "column 10: shape.weight is -3: give",
        ),
        (
            "kind = 'svg'\nsize = 1\nz = 1\nfile = 'no.svg'",
            'column 8: shape.file is "no.svg": there is no such',
        ),
        ("kind = 'svg'\nsize = 1\nz = 1\nfile = 3", "column 8: shape.file is 3: give text"),
        ("kind = 'svg'\nsize = 1\nz = 1", "shape.file is left out: svg needs file, size, z"),
        (
            "kind = 'text'\nheight = 1\nz = 1\nstring = ''",
            'column 10: shape.string is "": give at least a letter',
        ),
    ],
)
def test_a_wrong_table_is_refused_with_its_place(table: str, reported: str) -> None:
    with pytest.raises(midair.SceneError) as error:
        parse(f"[shape]\n{table}\n")
    assert reported in str(error.value)
    assert "\n" not in str(error.value)


def test_a_text_without_a_folder_has_no_files() -> None:
    with pytest.raises(midair.SceneError, match=r"image\.file is .logo\.png.: this document has no folder"):
        midair.Scene.parse(f"{ARRAY}[image]\nfile = 'logo.png'\nsize = 1\nz = 1\npixels = 2\n")


def test_what_is_no_refusal_goes_through_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("midair._toolbox.points", interrupted)
    with pytest.raises(KeyboardInterrupt):
        parse("[shape]\nkind = 'text'\nstring = 'hi'\nheight = 1\nz = 1\n")


@pytest.mark.slow
def test_the_command_line_solves_compares_and_draws_them(capsys: pytest.CaptureFixture[str]) -> None:
    Path("scene.toml").write_text(
        f"{ARRAY}[shape]\nkind = 'circle'\ncenter = [0, 0, 0.1]\nradius = 0.02\nstep = 0.002\n",
        encoding="utf-8",
    )
    for command in (
        ["solve", "scene.toml", "--solver", "gspat"],
        ["compare", "scene.toml", "--solvers", "naive,gspat"],
    ):
        with pytest.raises(SystemExit) as left:
            cli.main([*command, "--image", "field.png"])
        assert not left.value.code, capsys.readouterr().err
        with Image.open("field.png") as picture:
            assert min(picture.size) > 500
    with pytest.raises(SystemExit) as left:
        cli.main(["solve", "scene.toml", "-o", "logo.npz"])
    assert not left.value.code
    Path("scene.toml").write_text(f"{ARRAY}[shape]\nkind = 'svg'\nfile = 'drive.npz'\nsize = 1\nz = 1\n", "utf-8")
    with pytest.raises(SystemExit) as left:
        cli.main(["solve", "scene.toml", "-o", "drive.npz"])
    assert left.value.code == 2
    assert 'is the file "drive.npz" itself' in capsys.readouterr().err


def drawn(**keywords: object) -> midair.Solution:
    """Returns the solution for a circle of 63 points by a method that leaves differences."""
    array = midair.Array.grid(10, 10, pitch=0.01)
    points = shape.circle([0, 0, 0.1], 0.02, step=0.002)
    return midair.solve(midair.Scene(array, points, 400), "gspat", **keywords)


@pytest.mark.slow
def test_wanted_made_and_difference_have_the_numbers_of_the_points() -> None:
    solution = drawn()
    figure = solution.plot()
    axes = [ax for ax in figure.axes if ax.get_title()][:3]
    assert [ax.get_title() for ax in axes] == ["wanted", "made, z = 100 mm", "made - wanted"]
    wanted, made, difference = axes[0].collections[0], axes[1].images[0], axes[2].collections[0]
    field = midair.field(solution.scene, solution)
    assert np.asarray(made.get_array()) == pytest.approx(np.abs(field.pressure), rel=1e-6)
    # Both fields share one colour scale from 0; the scale of the difference is symmetric about 0.
    assert wanted.get_clim() == made.get_clim()
    assert made.get_clim()[0] == 0
    assert made.get_clim()[1] >= 400
    low, high = difference.get_clim()
    assert low == -high
    assert set(wanted.get_array()) == {400.0}
    assert np.asarray(difference.get_array()) == pytest.approx(np.abs(solution.pressures) - 400, abs=1e-3)
    places = [path.vertices[:4].mean(axis=0) for path in difference.get_paths()]
    assert np.array(places) == pytest.approx(1e3 * solution.scene.points[:, :2], abs=1e-9)
    # No pressure was requested in the middle.
    assert not any(path.contains_point((0, 0)) for path in difference.get_paths())
    assert difference.axes.get_facecolor() == plt.matplotlib.colors.to_rgba("lightgrey")


def test_radiation_is_compared_as_radiation() -> None:
    solution = drawn()
    wanted = next(ax for ax in solution.plot(quantity="radiation").axes if ax.get_title() == "wanted")
    # For 400 Pa, p^2/(rho c^2) is 1.17 Pa.
    shown = np.asarray(wanted.collections[0].get_array())
    assert shown == pytest.approx(np.full(len(shown), 400**2 / (1.223 * 340**2)))


def test_few_points_other_quantities_and_points_off_the_plane_are_drawn_as_before() -> None:
    solution = drawn()
    for quantity in ("spl", "phase"):
        assert "wanted" not in [ax.get_title() for ax in solution.plot(quantity=quantity).axes]
    array = midair.Array.grid(10, 10, pitch=0.01)
    slanted = midair.Scene(array, shape.circle([0, 0, 0.1], 0.02, step=0.002, normal=[1, 1, 1]))
    few = midair.Scene(array, shape.circle([0, 0, 0.1], 0.02, step=0.01))
    for scene in (slanted, few):
        figure = answer(midair.solve(scene, "naive"))
        assert "wanted" not in [ax.get_title() for ax in figure.axes]


def test_each_point_is_a_square_as_wide_as_a_step_but_no_less_than_a_sample() -> None:
    solution = drawn()
    points = 1e3 * solution.scene.points[:, :2]
    step = np.linalg.norm(points[0] - points[1])
    for pixels, side in ((80, step), (20, 60 / 19)):
        field = midair.field(solution.scene, solution, midair.Plane(0.1, 0.06, pixels=pixels))
        squares = at_points(field, plt.figure().subplots(), solution.targets, "magma", (0, 400))
        for place, path in zip(points, squares.get_paths(), strict=True):
            corners = path.vertices[:4]
            assert corners.mean(axis=0) == pytest.approx(place, abs=1e-9)
            assert np.ptp(corners, axis=0) == pytest.approx([side, side], rel=1e-6)
