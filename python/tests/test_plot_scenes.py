"""Plots of traps, nodes and bodies, and the style for journals, checked by the data on their axes."""

from contextlib import nullcontext
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib import rc_context, rcdefaults, rcParams
from matplotlib.patches import Circle
from matplotlib.quiver import Quiver
from matplotlib.text import Text

import midair
from figures import flat, images, titles
from scenes import small


@pytest.fixture(autouse=True)
def no_window():
    plt.switch_backend("agg")


def test_a_style_holds_within_its_statement_or_from_now_on() -> None:
    solution = midair.solve(small(points=[[-0.02, 0, 0.15], [0.02, 0, 0.15]]), "naive")
    before = dict(rcParams)
    with midair.style("ieee"):
        assert solution.plot(panels="field").get_figwidth() == 3.5
        figure = solution.plot()
        assert (figure.get_figwidth(), figure.get_suptitle()) == (7.16, "")
        assert plt.figure().get_figwidth() == 3.5
        figure.draw_without_rendering()
        texts = [text for text in figure.findobj(Text) if text.get_text()]
        assert {text.get_fontsize() for text in texts} == {8.0}
        assert solution.plot(size=5).get_figwidth() == 5
        assert midair.plot(solution).get_title() == "z = 150 mm"
    assert dict(rcParams) == before
    assert solution.plot().get_suptitle().startswith("2 points at ")
    with rc_context():
        midair.style("ieee")
        assert solution.plot(panels="points").get_figwidth() == 3.5
        rcdefaults()
        assert solution.plot(panels="points").get_figwidth() == 6.4
    with pytest.raises(midair.SceneError, match=r"style is .nature.: give"):
        midair.style("nature")


@pytest.mark.long
@pytest.mark.parametrize("style", [None, "ieee"])
def test_no_file_of_ours_has_a_type_3_font(style: str | None, tmp_path: Path) -> None:
    solution = midair.solve(flat(), "naive")
    with nullcontext() if style is None else midair.style(style):
        figures = {
            "solution": solution.plot(),
            "window": midair.plot(solution).figure,
            "table": midair.compare(flat(), ["naive", "gspat"]).plot(),
            "tolerance": midair.tolerate(solution, phase=5, trials=3).plot(),
        }
        for name, figure in figures.items():
            for ending in ("pdf", "svg"):
                figure.savefig(tmp_path / f"{name}.{ending}")
            pdf = (tmp_path / f"{name}.pdf").read_bytes()
            assert b"/Type3" not in pdf
            assert b"/CIDFontType2" in pdf, "TrueType"
            assert b"<text" in (tmp_path / f"{name}.svg").read_bytes()


PAIR = midair.Array.preset("sonicsurface_pair")


def test_traps_are_drawn_in_two_upright_planes_each_with_the_force_on_a_bead() -> None:
    scene = midair.Scene(PAIR, [[-0.02, 0, 0], [0.02, 0.01, 0]], signature="trap")
    solution = midair.solve(scene, "uniform")
    panels = solution.field().panels
    assert [(panel.plane.axis, panel.plane.at) for panel in panels] == [
        ("y", 0), ("y", 0.01), ("x", -0.02), ("x", 0.02)
    ]  # fmt: skip
    figure = solution.plot()
    for image, panel in zip(images(figure), panels, strict=True):
        assert np.asarray(image) == pytest.approx(np.abs(panel.pressure), rel=1e-6)
        # The field around the trap is about as loud as the focus with the trap's signature.
        assert image.max() > 0.5 * np.abs(solution.pressures).max()
    assert "arrows" in titles(figure)
    for ax, trap in zip(figure.axes, [0, 1, 0, 1], strict=False):
        (arrows,) = (mark for mark in ax.collections if isinstance(mark, Quiver))
        across = [axis for axis in range(3) if "xyz"[axis] != panels[figure.axes.index(ax)].plane.axis]
        place = np.full((len(arrows.X), 3), scene.points[trap])
        place[:, across] = 1e-3 * np.column_stack([arrows.X, arrows.Y])
        force = solution.gorkov(place).force[:, across]
        drawn = np.column_stack([arrows.U, arrows.V])
        assert (drawn * force).sum(1) == pytest.approx(
            np.linalg.norm(drawn, axis=1) * np.linalg.norm(force, axis=1), abs=1e-9
        )


@pytest.mark.filterwarnings("ignore:no point lies in")
def test_a_plane_of_next_to_nothing_says_so_and_is_dark() -> None:
    # At a soft wall the pressure is 0 up to rounding.
    wall = midair.Wall([0, 0, 0.2], [0, 0, -1], kind="soft")
    solution = midair.solve(small(points=[[0, 0, 0.15]], obstacles=[wall]), "uniform")
    node = solution.field(midair.Plane(0.2, 0.06))
    ax = midair.plot(node)
    factor = {"|p| / Pa": 1, "|p| / mPa": 1e-3, "|p| / µPa": 1e-6}[ax.figure.axes[-1].get_ylabel()]
    high = factor * ax.images[0].get_clim()[1]
    assert high >= 0.99e-4 * np.abs(solution.pressures).max() > np.abs(node.pressure).max()
    assert "dark: |p| is below 1e-4 of what the points get" in ax.get_title()
    assert "dark" not in titles(solution.plot())


def test_a_ball_is_seen_in_the_default_picture() -> None:
    ball = midair.Sphere([0, 0, 0.1], 0.02)
    solution = midair.solve(small(points=[[0.03, 0.01, 0.18], [-0.03, 0, 0.18]], obstacles=[ball]), "uniform")
    circles = [patch for ax in solution.plot().axes for patch in ax.patches if isinstance(patch, Circle)]
    assert [(circle.center, circle.radius) for circle in circles] == [((0, 100), pytest.approx(20))]


def test_two_plots_are_two_pictures() -> None:
    field = midair.field(flat(), np.ones(64))
    first = midair.plot(field)
    second = midair.plot(field)
    assert first.figure is not second.figure
    assert [len(ax.images) for ax in (first, second)] == [1, 1]
