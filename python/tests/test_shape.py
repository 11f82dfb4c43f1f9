"""Shapes as points: their positions, their distances, and rejected arguments."""

import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair import shape
from scenes import small, usable

Points = np.ndarray

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">'


@pytest.fixture
def svg(tmp_path: Path) -> Callable[..., Points]:
    """Returns a function that makes points of an SVG drawing with this content."""

    def drawn(inside: str, **keywords: Any) -> Points:
        path = tmp_path / "drawing.svg"
        path.write_text(f"{HEAD}{inside}</svg>", "utf-8")
        return shape.svg(path, **{"size": 0.08, "z": 0.15, **keywords})

    return drawn


def steps(points: Points, *, closed: bool = False) -> Points:
    """Returns the distances between consecutive points."""
    return np.linalg.norm(np.diff([*points, points[0]] if closed else points, axis=0), axis=1)


def nearest(points: Points) -> float:
    """Returns the smallest distance between two points."""
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    return float(apart[np.triu_indices(len(points), 1)].min())


def middle(points: Points) -> Points:
    return (points.min(axis=0) + points.max(axis=0)) / 2


def test_the_step_left_out_is_a_quarter_of_the_wavelength() -> None:
    assert pytest.approx(340 / 40e3 / 4) == shape.STEP
    points = shape.line([0, 0, 0.1], [0.0425, 0, 0.1])
    assert points == pytest.approx(np.linspace([0, 0, 0.1], [0.0425, 0, 0.1], 21))


@pytest.mark.parametrize("step", [0.0011, 0.003, 0.2])
def test_a_line_has_equal_steps_and_both_ends(step: float) -> None:
    start, end = np.array([-0.01, 0.02, 0.1]), np.array([0.03, -0.01, 0.2])
    points = shape.line(start, end, step=step)
    assert (points[0] == start).all()
    assert points[-1] == pytest.approx(end)
    length = np.linalg.norm(end - start)
    # The number of steps is rounded to the nearest integer, and is at least 1.
    assert steps(points) == pytest.approx(np.full(len(points) - 1, length / (len(points) - 1)))
    assert abs(length / step - (len(points) - 1)) <= 0.5 or len(points) == 2


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -3), (1, 0, 0), (-1, 1e-9, 0), (0.3, -0.2, 0.9)])
def test_a_circle_is_round_flat_even_and_not_doubled(normal: tuple[float, ...]) -> None:
    center, radius = np.array([0.01, -0.02, 0.15]), 0.02
    points = shape.circle(center, radius, normal=normal)
    away = points - center
    assert np.linalg.norm(away, axis=1) == pytest.approx(np.full(len(points), radius))
    assert away @ normal == pytest.approx(np.zeros(len(points)), abs=1e-12)
    chords = steps(points, closed=True)
    assert chords == pytest.approx(np.full(len(points), 2 * radius * np.sin(np.pi / len(points))))
    assert len(points) == round(2 * np.pi * radius / shape.STEP)
    # Counterclockwise when seen from the side that the normal points to.
    assert np.cross(away[0], away[1]) @ normal > 0
    if normal == (0, 0, 1):
        assert points[0] == pytest.approx([0.01 + radius, -0.02, 0.15])


def test_a_circle_has_the_points_that_are_counted() -> None:
    for count in (1, 2, 3, 8, 100):
        points = shape.circle([0, 0, 0.1], 0.02, count=count)
        angles = 2 * np.pi * np.arange(count) / count
        expected = np.stack([0.02 * np.cos(angles), 0.02 * np.sin(angles), 0.1 + 0 * angles], axis=1)
        assert points == pytest.approx(expected, abs=1e-12)
    for wrong, words in (
        ({"count": 0}, "count is 0: give 1 to"),
        ({"count": 4, "step": 0.01}, "step is given, too"),
    ):
        with pytest.raises(midair.SceneError, match=words):
            shape.circle([0, 0, 0.1], 0.02, **wrong)


def test_a_polyline_is_even_along_its_way() -> None:
    vertices = np.array([[0, 0, 0.1], [0.03, 0, 0.1], [0.03, 0.02, 0.1], [0, 0.03, 0.11]])
    for closed in (False, True):
        points = shape.polyline(vertices, step=0.002, closed=closed)
        # The same polyline, sampled in steps of a micrometre.
        corners = [*vertices, vertices[0]] if closed else list(vertices)
        fine = np.concatenate([np.linspace(a, b, round(np.linalg.norm(b - a) * 1e6)) for a, b in pairwise(corners)])
        walked = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
        count = round(walked[-1] / 0.002)
        wanted = walked[-1] * np.arange(count + (not closed)) / count
        expected = fine[np.searchsorted(walked, wanted - 1e-9).clip(max=len(fine) - 1)]
        assert len(points) == len(expected)
        assert points == pytest.approx(expected, abs=3e-6)


def test_a_triangle_and_a_line_there_and_back_have_no_point_twice() -> None:
    corner = [[0, 0, 0.1], [0.02, 0, 0.1], [0.02, 0.0001, 0.1]]
    assert nearest(shape.polyline(corner, step=0.002, closed=True)) >= 0.001 * (1 - 1e-6)
    there_and_back = shape.polyline([[0, 0, 0.1], [0.02, 0, 0.1]], step=0.002, closed=True)
    assert sorted(there_and_back[:, 0]) == pytest.approx(np.linspace(0, 0.02, 11))


def test_points_of_crossing_contours_keep_half_a_step(svg: Callable[..., Points]) -> None:
    # Each line has an even number of steps, so that both lines have a point in the middle.
    step, alone = np.hypot(0.08, 0.08) / 50, 51
    cross = svg('<path d="M0 0 L100 100 M0 100 L100 0"/>', step=step)
    assert nearest(cross) >= step / 2 * (1 - 1e-6)
    # Only one of the two coinciding middle points is left out.
    assert len(cross) == 2 * alone - 1
    # The same line twice counts as one line.
    assert len(svg('<path d="M0 0 L100 100 M0 0 L100 100"/>', step=step)) == alone


def test_thinning_keeps_what_a_plain_loop_keeps() -> None:
    points = np.random.default_rng(1).uniform(-0.01, 0.01, (400, 3))
    kept: list[Points] = []
    for point in points:
        if all(np.linalg.norm(point - other) >= 0.002 for other in kept):
            kept.append(point)
    assert 50 < len(kept) < 390
    # A contour of one vertex is a point.
    assert (midair._midair.along([point[None] for point in points], 0.004) == np.array(kept)).all()


def test_a_letter_is_as_high_as_requested_in_the_middle_and_upright() -> None:
    points = shape.text("A", height=0.03, z=0.2, step=0.001)
    assert np.ptp(points[:, 1]) == pytest.approx(0.03, abs=1e-3)
    assert middle(points) == pytest.approx([0, 0, 0.2], abs=1e-3)
    assert (points[:, 2] == 0.2).all()
    # An A is wide at the bottom, and has a hole.
    width = [np.ptp(points[half, 0]) for half in (points[:, 1] < -0.01, points[:, 1] > 0.01)]
    assert width[0] > 2 * width[1] > 0
    assert len(points) == pytest.approx(len(shape.text("A", height=0.06, z=0.2, step=0.002)), abs=2)


def test_a_word_is_read_from_left_to_right() -> None:
    points = shape.text("hi", height=0.03, z=0.15)
    assert middle(points)[:2] == pytest.approx([0, 0], abs=1e-3)
    left, right = (points[side, 1] for side in (points[:, 0] < 0, points[:, 0] > 0.01))
    # The i has a gap below its dot.
    gaps = [np.diff(np.sort(side)).max() for side in (left, right)]
    assert gaps[1] > 2 * gaps[0]
    # $ is an ordinary character, not the start of a formula.
    assert len(shape.text("$x$", height=0.03, z=0.15)) > len(shape.text("x", height=0.03, z=0.15)) + 60


def test_fonts_go_by_name() -> None:
    serif = shape.text("I", height=0.03, z=0.15, font="DejaVu Serif")
    assert np.ptp(serif[:, 0]) > 1.5 * np.ptp(shape.text("I", height=0.03, z=0.15)[:, 0])


def test_svg_circles_are_round_and_ellipses_even(svg: Callable[..., Points]) -> None:
    points = svg('<circle cx="31" cy="7" r="20"/>', step=0.002)
    assert np.linalg.norm(points - [0, 0, 0.15], axis=1) == pytest.approx(np.full(len(points), 0.04), rel=2e-4)
    assert len(points) == round(2 * np.pi * 0.04 / 0.002)
    ellipse = svg('<ellipse cx="0" cy="0" rx="40" ry="10"/>', step=0.002)
    apart = steps(ellipse, closed=True)
    assert apart.max() < 1.01 * np.median(apart)
    assert np.ptp(ellipse, axis=0) == pytest.approx([0.08, 0.02, 0], abs=2e-4)


def test_svg_curves_are_where_their_formulas_are(svg: Callable[..., Points]) -> None:
    p = np.array([[0, 0], [10, 90], [60, -40], [100, 30]], float)
    points = svg('<path d="M0 0 C10 90 60 -40 100 30"/>', step=0.001)
    t = np.linspace(0, 1, 100_001)[:, None]
    curve = (1 - t) ** 3 * p[0] + 3 * t * (1 - t) ** 2 * p[1] + 3 * t**2 * (1 - t) * p[2] + t**3 * p[3]
    # The longer side is scaled to 80 mm, the middle is at 0, and y points up.
    scale = 0.08 / np.ptp(curve, axis=0).max()
    curve = (curve - (curve.min(axis=0) + curve.max(axis=0)) / 2) * scale * [1, -1]
    away = np.abs(points[:, None, :2] - curve[None, ::20]).max(axis=2).min(axis=1)
    assert away.max() < 5e-5
    assert steps(points) == pytest.approx(np.full(len(points) - 1, 0.001), rel=0.02)


def test_svg_has_y_up_groups_moved_and_hidden_things_left_out(svg: Callable[..., Points]) -> None:
    inside = """<defs><circle cx="0" cy="0" r="500"/></defs>
    <g transform="translate(10 10) scale(2)"><path d="M0 0 h20 v5"/></g>
    <path d="M-500 -500 L500 500" display="none"/><text x="900" y="900">hi</text>"""
    with pytest.warns(midair.SceneWarning, match=r"draws .*drawing\.svg without 1 text: convert them to paths"):
        points = svg(inside, step=0.001)
    # A horizontal line, then a shorter one downwards: y points down in SVG.
    assert points[0] == pytest.approx([-0.04, 0.01, 0.15])
    assert points[-1] == pytest.approx([0.04, -0.01, 0.15])
    assert len(points) == 101


REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "a step of 0": (lambda: shape.line([0, 0, 0], [1, 0, 0], step=0), "step is 0.0: give a number above 0"),
    "a step that is none": (
        lambda: shape.circle([0, 0, 0], 1, step=float("nan")),
        "step is NaN: give a finite",
    ),
    "a word for a step": (lambda: shape.line([0, 0, 0], [1, 0, 0], step="a"), 'step is "a": give a number'),
    "too many points": (lambda: shape.circle([0, 0, 0], 1, step=1e-6), "step is 1e-6: 6.283 m of contours"),
    "too many steps": (
        lambda: shape.line([0, 0, 0], [1, 0, 0], step=1e-300),
        "step is 1e-300: 1 m of contours",
    ),
    "no line": (lambda: shape.line([0, 0, 1], [0, 0, 1]), "end is [0.0, 0.0, 1.0]: it is where the start is"),
    "two numbers": (
        lambda: shape.line([0, 0], [0, 0, 1]),
        "start is [0, 0]: give 3 numbers",
    ),
    "no numbers": (
        lambda: shape.line([0, 0, None], [0, 0, 1]),
        "start is a list of 3 values: give 3 numbers",
    ),
    "an infinite one": (
        lambda: shape.line([0, 0, np.inf], [0, 0, 1]),
        "start is [0.0, 0.0, inf]: give three finite",
    ),
    "a ragged list": (
        lambda: shape.polyline([[0, 0, 1], [0, 1]]),
        "points[1] is [0, 1]: give 3 numbers",
    ),
    "one corner": (lambda: shape.polyline([[0, 0, 1]]), "points is [[0.0, 0.0, 1.0]]: give at least two"),
    "corners in one place": (lambda: shape.polyline([[0, 0, 1]] * 3), "they are all in one place"),
    "a word for closed": (
        lambda: shape.polyline([[0, 0, 1], [0, 1, 1]], closed="no"),  # type: ignore[arg-type]
        'closed is "no": give true or false',
    ),
    "a circle of no size": (lambda: shape.circle([0, 0, 1], 0), "radius is 0.0: give a number above 0"),
    "no direction": (
        lambda: shape.circle([0, 0, 1], 1, normal=[0, 0, 0]),
        "normal is [0.0, 0.0, 0.0]: give a",
    ),
    "no text": (lambda: shape.text(" ", height=1, z=1), 'string is " ": give at least a letter'),
    "no word": (lambda: shape.text(3, height=1, z=1), "string is 3: give text"),  # type: ignore[arg-type]
    "a missing letter": (lambda: shape.text("a一", height=1, z=1), "the font has no '一'"),
    "two lines": (lambda: shape.text("a\nb", height=1, z=1), "the font has no '\\n', give one line"),
    "an unknown font": (
        lambda: shape.text("a", height=1, z=1, font="Nofont"),
        'font is "Nofont": matplotlib',
    ),
    "no height": (lambda: shape.text("a", height=-1, z=1), "height is -1: give a number above 0"),
    "no file": (lambda: shape.svg("none.svg", size=1, z=1), 'path is "none.svg": there is no such file'),
    "a folder": (lambda: shape.svg(".", size=1, z=1), 'path is ".": there is no such file'),
    "a number for a file": (lambda: shape.svg(3, size=1, z=1), "path is 3: give an SVG file"),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_drawn_is_refused_in_one_line(what: str) -> None:
    draw, reported = REFUSED[what]
    with pytest.raises(midair.SceneError) as error:
        draw()
    assert reported in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "inside",
    ["", "<g/>", '<path d=""/>', '<path d="M3 3"/>', "<text>hi</text>", '<path d="M0 0 L0 0 Z"/>'],
)
def test_a_drawing_with_nothing_in_it_is_refused(svg: Callable[..., Points], inside: str) -> None:
    with pytest.raises(midair.SceneError, match="nothing is drawn in it"):
        svg(inside)


@pytest.mark.parametrize("content", [b"", b"<svg", b"\x89PNG", b"<html></html>", b"\xff\xfe\x00"])
def test_what_is_no_svg_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "no.svg"
    path.write_bytes(content)
    with pytest.raises(midair.SceneError, match=r"^path is .*(cannot be read|nothing is drawn)"):
        shape.svg(path, size=0.1, z=0.1)


def test_without_svgelements_the_extra_is_named(svg: Callable[..., Points], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "svgelements", None)
    with pytest.raises(midair.SceneError, match=r'svgelements: pip install "midair\[shapes\]"'):
        svg('<path d="M0 0 L3 3"/>')


def test_a_shape_is_solved() -> None:
    scene = small(points=shape.circle([0, 0, 0.1], 0.015, step=0.004), pressures=200)
    solution = midair.solve(scene, "greedy", balance=True)
    assert usable(solution)
    assert 0.5 < solution.metrics.accuracy < 1.5
