"""Plots, checked by the data on their axes: fields in planes, targets and pressures, contact sheets."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.figure import Figure

import midair
from figures import flat, images, kilo, marks, titles
from midair._pictures.colours import table
from midair._pictures.plot import answer, contact_sheet
from scenes import POINTS, small

BOARD = {"phases": 32, "amplitudes": [0, 1]}


@pytest.fixture(autouse=True)
def no_window():
    plt.switch_backend("agg")


def test_plot_draws_into_the_axes_given_and_marks_the_points() -> None:
    points = [[0.01, 0.02, 0.15], [-0.01, 0.005, 0.15], [0.015, -0.01, 0.17], [0.02, 0, 0.15]]
    scene = small(points=points, pressures=[1, 2, 3, 0])
    field = midair.field(scene, np.ones(64), midair.Plane(0.15, 0.08, pixels=41))
    _, (left, right) = plt.subplots(1, 2)
    assert midair.plot(field, right) is right
    assert not left.images
    (image,) = right.images
    # The image is |p| in Pa: bottom row first, pixels centred on their samples, a colour scale from 0 to the
    # maximum.
    assert np.asarray(image.get_array()) == pytest.approx(np.abs(field.pressure), rel=1e-6)
    assert image.origin == "lower"
    assert image.get_extent() == pytest.approx([-41, 41, -41, 41])
    assert image.get_clim() == pytest.approx((0, image.get_array().max()))
    found = marks(right)
    assert found["dots"] == pytest.approx(np.array([[10, 20], [-10, 5]]))
    assert found["rings"] == pytest.approx(np.array([[15, -10]]))
    assert found["crosses"] == pytest.approx(np.array([[20, 0]]))
    assert (right.get_xlabel(), right.get_ylabel()) == ("x / mm", "y / mm")
    for word in ("targets 1 to 3 Pa", "1 quiet", "z = 150 mm, 3 of 4 points", "rings", "crosses"):
        assert word in right.get_title()


def test_plot_without_axes_draws_into_the_present_ones() -> None:
    ax = plt.gca()
    assert midair.plot(midair.field(small(), np.ones(64))) is ax
    assert len(ax.images) == 1


@pytest.mark.slow
def test_plot_without_axes_has_a_panel_for_each_plane() -> None:
    solution = midair.solve(small(points=[[-0.02, 0, 0.1], [0.02, 0.01, 0.12], [0, -0.02, 0.15]]), "uniform")
    figure = midair.plot(solution).figure
    panels = midair.field(solution.scene, solution).panels
    assert len(panels) == 3
    for image, panel in zip(images(figure), panels, strict=True):
        assert np.asarray(image) == pytest.approx(np.abs(panel.pressure), rel=1e-6)
        # A black panel would wrongly show that the points are silent.
        assert image.max() > 0.9 * solution.targets.min()
    assert [ax.get_title() for ax in figure.axes[:3]] == [
        f"z = {height} mm, 1 of 3 points" for height in (100, 120, 150)
    ]
    assert len({ax.images[0].get_clim() for ax in figure.axes[:3]}) == 1


@pytest.mark.slow
def test_a_met_request_has_values_at_the_points_and_an_upright_plane() -> None:
    points = [[-0.02, 0, 0.15], [0.02, 0, 0.15], [0, 0.02, 0.15]]
    solution = midair.solve(small(points=points, pressures=[30, 40, 50]), "uniform")
    assert np.abs(solution.pressures) == pytest.approx([30, 40, 50], rel=0.01)
    figure = solution.plot()
    assert [ax.get_title() for ax in figure.axes[:2]] == ["z = 150 mm", "y = 0 mm, 2 of 3 points"]
    assert len(figure.axes) == 3, "two planes and a bar"
    first, second = ([text.get_text() for text in ax.texts] for ax in figure.axes[:2])
    values = [f"{abs(p):#.3g} Pa" for p in solution.pressures]
    assert first == [*(f"{k}  {value}" for k, value in enumerate(values, 1)), "\u03bb"]
    assert second == ["1", "2"]
    assert "within 0" in figure.get_suptitle()
    # A request that is missed has a panel of the points instead.
    missed = midair.solve(small(points=points, pressures=[30, 40, 50]), "naive", limit="normalize").plot()
    assert "got" in [text.get_text() for text in missed.axes[-1].get_legend().get_texts()]


def test_an_upright_picture_names_its_axes() -> None:
    ax = midair.plot(midair.field(small(points=[[0, 0, 0.1], [0, 0, 0.14]]), np.ones(64)))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x / mm", "z / mm")
    assert "y = 0 mm" in ax.get_title()
    assert marks(ax)["dots"] == pytest.approx(np.array([[0, 100], [0, 140]]))


# A source pressure of 400 Pa m causes a warning.
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize(
    ("source_pressure", "quantity", "label", "factor"),
    [
        (4.386, "pressure", "|p| / kPa", 1e-3),
        (100, "pressure", "|p| / kPa", 1e-3),
        (1e-2, "pressure", "|p| / Pa", 1),
        (1e-3, "pressure", "|p| in the paper's unit", 1),
        (4.386, "radiation", "radiation pressure / Pa", 1),
        (0.1, "radiation", "radiation pressure / mPa", 1e3),
        (1e-3, "radiation", "|p|² in the paper's unit", 1),
        (4.386, "spl", "sound pressure level / dB re 20 µPa", 1),
        (1e-3, "spl", "|p| / dB re the paper's unit", 1),
        (4.386, "phase", "phase of p / rad", 1),
    ],
)
def test_plot_says_what_its_colours_mean(source_pressure: float, quantity: str, label: str, factor: float) -> None:
    scene = small(points=[[0, 0, 0.15]], source_pressure=source_pressure)
    field = midair.field(scene, midair.solve(scene, "naive"))
    ax = midair.plot(field, quantity=quantity)
    assert ax.figure.axes[-1].get_ylabel() == label
    image, pressure = ax.images[0].get_array(), np.abs(field.pressure).astype(float)
    unit = 1 if scene.in_paper_unit else 20e-6 * 2**0.5
    expected = {
        "pressure": pressure,
        "radiation": pressure**2 if scene.in_paper_unit else field.radiation,
        "spl": 20 * np.log10(pressure / unit),
        "phase": np.angle(field.pressure),
    }[quantity]
    if quantity == "phase":
        # The pressure is interpolated to four times as many samples; its phase fades out where it is faint.
        loud, near = pressure > 0.3 * pressure.max(), np.asarray(image)[1::4, 1::4]
        assert np.abs(np.angle(np.exp(1j * (near - expected))))[loud].max() < 0.3
        assert ax.images[0].get_alpha()[1::4, 1::4] == pytest.approx(np.sqrt(pressure / pressure.max()), abs=0.1)
    else:
        assert np.asarray(image) == pytest.approx(expected * factor, rel=1e-5)
    low, high = ax.images[0].get_clim()
    top = expected.max() * factor
    assert (low, high) == pytest.approx(
        {"spl": (top - 60, top), "phase": (-np.pi, np.pi)}.get(quantity, (0, top)), rel=1e-5
    )
    # The unit suits the values: the colour bar's top is neither 0.0 nor 1e7.
    assert quantity == "spl" or 0.02 <= high < 1e4


def test_plot_of_silence_and_of_a_given_top_have_a_scale() -> None:
    field = midair.field(flat(), np.zeros(64))
    for quantity in ("pressure", "radiation", "spl", "phase"):
        _, ax = plt.subplots()
        low, high = midair.plot(field, ax, quantity=quantity).images[0].get_clim()
        assert low < high
    _, ax = plt.subplots()
    assert midair.plot(field, ax, vmax=300.0).images[0].get_clim() == (0, 300)


def test_a_transducer_in_the_picture_does_not_black_out_the_rest() -> None:
    scene = small(points=[[0, 0.005, 0.06], [0.01, 0.005, 0.08]])
    solution = midair.solve(scene, "uniform")
    field = midair.field(scene, solution, midair.Plane(axis="y", at=0.005, size=0.16, pixels=161, center=(0, 0.07)))
    ax = midair.plot(field)
    top = kilo(ax.figure) * ax.images[0].get_clim()[1]
    assert np.abs(field.pressure).max() > 5 * top
    assert 0.5 * solution.targets.max() < top < 2 * solution.targets.max()


@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
def test_pictures_count_the_scale_in_and_tell_it() -> None:
    array = midair.Array.grid(8, 8, 0.01, quantization=BOARD)
    table = midair.compare(flat(array=array, pressures=16), ["naive", "uniform"], balance=True)
    solution = table["naive"]
    assert solution.scale < 0.1
    reported = f"level {solution.metrics.level:.3f}, scale {solution.scale:.3g}"
    plotted = midair.plot(solution).figure
    for figure in (plotted, solution.plot()):
        assert f"naive, targets 16 Pa, {reported}" in titles(figure)
        # The brightest pixel has the highest pressure of the table, or less if the focus is between pixels.
        assert images(figure)[0].max() == pytest.approx(np.abs(solution.pressures).max(), rel=0.05)
    sheet = table.plot()
    assert f"naive, scale {solution.scale:.3g}" in titles(sheet)
    for image, one in zip(images(sheet), table, strict=True):
        assert 8 < image.max() < 64
        assert image.max() > 0.99 * np.abs(one.pressures).max()


def test_titles_tell_the_options_that_are_not_the_defaults() -> None:
    scene = flat()
    assert "\ngreedy, targets" in midair.plot(midair.solve(scene, "greedy")).get_title()
    assert "\ngreedy, phases=8, targets" in midair.plot(midair.solve(scene, "greedy", phases=8)).get_title()
    assert midair.plot(midair.solve(scene, lambda g, *_: g.conj()[0] / abs(g[0]).max())).get_title()


def test_plot_refuses_what_is_no_picture() -> None:
    at_points = midair.field(small(), np.ones(64), POINTS)
    with pytest.raises(midair.SceneError, match="Plane"):
        midair.plot(at_points)
    field = midair.field(flat(), np.ones(64))
    with pytest.raises(midair.SceneError, match=r'"presure".*"pressure", "radiation", "spl" or "phase"'):
        midair.plot(field, quantity="presure")
    for vmax in (0, -1, np.nan, "loud"):
        with pytest.raises(midair.SceneError, match="vmax"):
            midair.plot(field, vmax=vmax)
    with pytest.raises(midair.SceneError, match="vmax"):
        midair.plot(field, quantity="phase", vmax=1)
    with pytest.raises(TypeError, match=r"ax is 'field.png': .* writes a file"):
        midair.plot(field, "field.png")
    with pytest.raises(TypeError, match="Field"):
        midair.plot(field.pressure)
    matrix = midair.solve(midair.Propagation(small().propagation()), "naive")
    for draw in (midair.plot, lambda solution: midair.Comparison(None, None, (solution,), ({},)).plot()):
        with pytest.raises(midair.SceneError, match="matrix"):
            draw(matrix)


@pytest.mark.slow
def test_a_sheet_shares_axes_and_a_scale_that_no_method_alone_sets() -> None:
    scene = flat(pressures=60)
    table = midair.compare(scene, ["naive", "uniform", "gspat", "evd"], balance=True)
    figure = table.plot()
    panels = [ax for ax in figure.axes if ax.images]
    assert len(panels) == 4
    assert len({ax.images[0].get_clim() for ax in panels}) == len({ax.get_xlim() for ax in panels}) == 1
    # One label per row and column: of 3 + 1 panels, the second to fourth are the lowest of their columns.
    assert [bool(ax.get_xlabel()) for ax in panels] == [False, True, True, True]
    assert [bool(ax.get_ylabel()) for ax in panels] == [True, False, False, True]
    for ax, name, solution in zip(panels, table.names, table, strict=True):
        metrics = solution.metrics
        assert ax.get_title().startswith(name)
        assert f"accuracy {metrics.accuracy:.3f}" in ax.get_title()
        assert "sigma" in ax.get_title()
    assert "targets 60 Pa" in figure.get_suptitle()
    assert "z = 150 mm" in figure.get_suptitle()
    # A panel that is far louder than requested is clipped, and the colour bar has an arrow.
    right, loud = midair.field(scene, table[0]), midair.field(scene, np.ones(64))
    assert np.abs(loud.pressure).max() > 5 * 60
    sheet = contact_sheet([right, right, loud], ["a", "b", "loud"])
    assert sheet.axes[0].images[0].get_clim()[1] <= 1.5 * 60
    assert sheet.axes[-1]._colorbar.extend == "max"
    assert panels[0].figure.axes[-1]._colorbar.extend == "neither"


@pytest.mark.slow
def test_a_sheet_has_a_row_a_solver_where_points_lie_in_several_planes() -> None:
    table = midair.compare(small(points=[[0, 0, 0.1], [0.02, 0.01, 0.15]], pressures=1000), ["naive", "uniform"])
    figure = table.plot(quantity="radiation")
    panels = [panel for one in table for panel in midair.field(one.scene, one).panels]
    assert len(panels) == 4
    for image, panel in zip(images(figure), panels, strict=True):
        assert np.asarray(image) == pytest.approx(panel.radiation, rel=1e-6)
    assert "rings are points off the plane" in figure.get_suptitle()


# Some of a hundred points are close together, which causes a warning.
@pytest.mark.filterwarnings("ignore::midair.SceneWarning")
@pytest.mark.parametrize("count", [2, 3, 100])
def test_a_solution_plots_what_was_requested_and_got(count: int) -> None:
    rng = np.random.default_rng(2)
    points = rng.uniform([-0.03, -0.03, 0.15], [0.03, 0.03, 0.15], (count, 3))
    targets = rng.uniform(20, 60, count) * (np.arange(count) != 2)
    solution = midair.solve(small(points=points, pressures=targets), "greedy", balance=True)
    figure = solution.plot(panels=["field", "points"])
    assert isinstance(figure, Figure)
    ax = figure.axes[-1]
    assert ax.get_ylabel() == "|p| / Pa"
    got = dict(zip(range(1, count + 1), np.abs(solution.pressures), strict=True))
    dots = {int(x): y for line in ax.lines for x, y in zip(*line.get_data(), strict=True)}
    assert dots == pytest.approx(got)
    requested = np.array([segment[:, 1].mean() for segment in ax.collections[-1].get_segments()])
    assert requested == pytest.approx(targets)
    # A stem leads from each target to the dot.
    stems = np.concatenate([stem.get_segments() for stem in ax.collections[:-1]])
    ends = {round(stem[0, 0]): stem[:, 1].tolist() for stem in stems}
    assert all(ends[k] == pytest.approx([targets[k - 1], got[k]]) for k in got)
    assert ax.get_ylim()[1] > max(*got.values(), targets.max())
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert ("got at a quiet point" in labels) == (count > 2)


def test_a_single_point_has_no_bar_and_a_smooth_focus() -> None:
    figure = midair.solve(small(points=[[0, 0, 0.15]], pressures=60), "naive").plot()
    assert [bool(ax.images) for ax in figure.axes] == [True, True, False]
    assert figure.axes[0].images[0].get_interpolation() == "bicubic"
    assert titles(figure).startswith("1 point at 60 Pa ")


def test_pictures_take_plane_colours_panels_and_size() -> None:
    solution = midair.solve(flat(), "naive")
    plane = midair.Plane(0.15, 0.05)
    figure = solution.plot(plane=plane, cmap="cividis", panels=["field"], size=3.5)
    assert figure.get_figwidth() == 3.5
    (image,) = figure.axes[0].images
    assert image.get_cmap().name == "cividis"
    assert np.asarray(image.get_array()) == pytest.approx(np.abs(solution.field(plane).pressure), rel=1e-6)
    assert not images(solution.plot(panels=["points"]))
    ax = midair.plot(solution, plane=plane, cmap="cividis", size=(7.16, 3))
    assert tuple(ax.figure.get_size_inches()) == (7.16, 3)
    for wrong in ({"cmap": "rainbows"}, {"panels": ["bars"]}, {"size": -1}):
        with pytest.raises(midair.SceneError, match=next(iter(wrong))):
            solution.plot(**wrong)


def test_pictures_have_one_map_of_fields_and_one_of_phases() -> None:
    field = midair.field(flat(), np.ones(64))
    for quantity, name in (("pressure", "magma"), ("spl", "magma"), ("phase", "midair.phase")):
        assert midair.plot(field, quantity=quantity).images[0].get_cmap().name == name
        plt.close("all")
    shades = np.linspace(0, 1, 256)
    assert np.abs(table("field") - 255 * colormaps["magma"](shades)[:, :3]).max() < 3
    assert np.abs(table("phase") - 255 * colormaps["midair.phase"](shades)[:, :3]).max() < 1
    assert (table("phase")[0] == table("phase")[-1]).all(), "a turn is none"
    # On a light page, silence has the page's colour, and a louder field is darker.
    light = table("field_light")
    assert light[0].tolist() == [246, 248, 250]
    assert light[-1].tolist() == table("field")[0].tolist()
    assert (np.diff(light @ [0.2126, 0.7152, 0.0722]) < 0.5).all()
    assert np.abs(light - 255 * colormaps["midair.light"](shades)[:, :3]).max() < 1


def test_axes_of_ones_own_hold_one_panel() -> None:
    solution = midair.solve(small(), "naive")
    own, ax = plt.subplots()
    assert solution.plot(ax) is own
    assert ax.images[0].get_array() is not None
    assert len(own.axes) == 2, "the panel and its bar"
    assert not solution.plot(ax=plt.figure().subplots(), panels="points").axes[0].images
    table = midair.compare(flat(), ["naive", "gspat"])
    assert [ax.get_title().split("\n")[0] for ax in table.plot(panels=["gspat"]).axes[:1]] == ["gspat"]
    assert table.plot(plt.figure().gca(), panels="naive", cmap="cividis").axes[0].images
    for wrong, word in (({"panels": ["field", "points"]}, "one panel"), ({"panels": "bars"}, "panels")):
        with pytest.raises(midair.SceneError, match=word):
            solution.plot(ax, **wrong)
    for draw in (table.plot, midair.tolerate(solution, phase=5, trials=3).plot):
        with pytest.raises(midair.SceneError, match="panels"):
            draw(panels="gs")


def test_a_solution_of_a_matrix_plots_what_was_requested_and_got_alone() -> None:
    solution = midair.solve(midair.Propagation(small().propagation()), "naive", pressures=500)
    figure = answer(solution)
    assert not images(figure)
    assert figure.axes[0].lines[0].get_ydata() == pytest.approx(np.abs(solution.pressures) / kilo(figure))
