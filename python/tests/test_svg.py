"""SVG drawings as a browser shows them: transforms of any element, and what no browser shows."""

import warnings
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

import midair
from midair import shape

Points = np.ndarray[Any, Any]

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="-300 -300 600 600">'
RECT = '<rect width="40" height="10"/>'
SQUARE = '<path d="M0 0H10V10H0Z"/>'
BIG = '<rect width="100" height="100"/>'


def drawn(inside: str) -> Points:
    return shape.svg(f"{HEAD}{inside}</svg>", size=0.2, z=0.1, step=0.0005)


def ratio(inside: str) -> float:
    width, height, _ = np.ptp(drawn(inside), axis=0)
    return float(width / height)


def rotated(width: float, height: float, degrees: float) -> float:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return float((width * cos + height * sin) / (width * sin + height * cos))


#: A drawing, and its width over its height.
SHOWN = {
    "a rect that is rotated": ('<rect width="40" height="10" transform="rotate(30)"/>', rotated(40, 10, 30)),
    "by a style": ('<rect width="40" height="10" style="transform: rotate(30deg)"/>', rotated(40, 10, 30)),
    "by a group": (f'<g transform="rotate(30)">{RECT}</g>', rotated(40, 10, 30)),
    "a circle that a rotation moves": (
        f'{SQUARE}<circle transform="rotate(90)" r="10" cx="100" cy="0"/>',
        20 / 110,
    ),
    "a circle that is mirrored": (
        f'{SQUARE}<circle transform="scale(1,-1)" r="2" cx="100" cy="211"/>',
        102 / 223,
    ),
    "an ellipse that is skewed": (
        '<ellipse rx="40" ry="10" transform="skewX(45)"/>',
        np.hypot(40, 10) / 10,
    ),
    "an origin of a transform": (
        f'{SQUARE}<rect x="50" width="40" height="10" transform="rotate(90)" transform-origin="50 0"/>',
        50 / 40,
    ),
    "lengths with units": (
        '<rect style="transform: translate(10mm) scaleX(2)" width="40" height="10"/><path d="M0 0h1v1"/>',
        (10 * 96 / 25.4 + 80) / 10,
    ),
    "a colour without blue": ('<rect width="40" height="10" fill="rgb(255,0,0)"/>', 4.0),
    "turns": ('<rect style="transform: rotate(0.25turn)" width="10" height="40"/>', 4.0),
    "a mask": (f'<mask id="m">{BIG}</mask>{RECT}', 4.0),
    "a clip": (f'<clipPath id="m">{BIG}</clipPath>{RECT}', 4.0),
    "a marker": (f'<marker id="m">{BIG}</marker>{RECT}', 4.0),
    "a pattern": (f'<pattern id="m">{BIG}</pattern>{RECT}', 4.0),
    "definitions": (f"<defs>{BIG}</defs>{RECT}", 4.0),
    "a symbol that is not used": (f'<symbol id="m">{BIG}</symbol>{RECT}', 4.0),
    "an unknown element": (f"<other>{BIG}</other>{RECT}", 4.0),
    "another language": (f'<x:g xmlns:x="urn:x">{BIG}</x:g>{RECT}', 4.0),
    "hidden": (f'<g visibility="hidden">{BIG}</g>{RECT}', 4.0),
    "collapsed": (f'<g style="visibility: collapse">{BIG}</g>{RECT}', 4.0),
    "visible in something hidden": (
        f'<g visibility="hidden">{BIG}<rect width="40" height="10" visibility="visible"/></g>',
        4.0,
    ),
    "visible as what is around": (f'<g visibility="hidden"><g visibility="inherit">{BIG}</g></g>{RECT}', 4.0),
    "visible by inheritance": (f'<g visibility="inherit">{RECT}</g>', 4.0),
    "no display in capitals": (f'<g style="display: NONE">{BIG}</g>{RECT}', 4.0),
    "the first of two names": (
        f'<rect id="a" width="40" height="10"/><use href="#a"/><g id="a" display="none">{BIG}</g>',
        4.0,
    ),
    "no display": (f'<g display="none">{BIG}</g>{RECT}', 4.0),
    "no display of a class": (f"<style>.a, b {{display: none}}</style><g class='b a'>{BIG}</g>{RECT}", 4.0),
    "an id is above a class": (
        f"<style>#i {{display: inline}} .a {{display: none}}</style><g id='i' class='a'>{RECT}</g>",
        4.0,
    ),
    "no opacity": (f'<g opacity="0.0">{BIG}</g>{RECT}', 4.0),
    "the first of a switch": (f"<switch><x requiredExtensions='y'/>{RECT}{BIG}</switch>", 4.0),
    "a rect of no width": (f'<rect height="90"/>{RECT}', 4.0),
    "an ellipse of one radius": ('<ellipse ry="7"/>', 1.0),
    "percentages and units": ('<rect width="10%" height="15px"/>', 4.0),
    "a use that is placed": (f'<defs><g id="m">{SQUARE}</g></defs><use href="#m" x="30"/>{SQUARE}', 4.0),
    "a use of a shape": (
        '<use xlink:href="#m" transform="scale(1 .25)"/><defs><path id="m" d="M0 0h9v9z"/></defs>',
        4.0,
    ),
    "a symbol with a viewBox": (
        f'<symbol id="m" viewBox="0 0 100 100">{BIG}</symbol><use href="#m" width="10" height="10"/>'
        '<path d="M0 0h40v1"/>',
        4.0,
    ),
    "a symbol as large as it says": (
        f'<symbol id="m" viewBox="0 0 100 100" width="10" height="10">{BIG}</symbol><use href="#m"/>'
        '<path d="M0 0h40v1"/>',
        4.0,
    ),
    "a drawing in a drawing": (
        f'<svg x="30" y="0" width="10" height="10" viewBox="0 0 100 100">{BIG}</svg>{SQUARE}',
        4.0,
    ),
    "without proportions": (
        f'<svg width="40" height="10" viewBox="0 0 100 100" preserveAspectRatio="none">{BIG}</svg>',
        4.0,
    ),
}


@pytest.mark.parametrize("name", SHOWN)
def test_a_drawing_has_the_proportions_that_a_browser_shows(name: str) -> None:
    inside, expected = SHOWN[name]
    assert ratio(inside) == pytest.approx(expected, rel=3e-3)
    if name == "a rect that is rotated":
        corners = midair.path.svg(f"{HEAD}{inside}</svg>", size=0.2, z=0.1, speed=1).frames(5e3)[0][:, 0]
        width, height, _ = np.ptp(corners, axis=0)
        assert width / height == pytest.approx(expected, rel=3e-3)


LEFT_OUT = {
    "text": (f"<text>hi</text><text>ho</text>{RECT}", "without 2 text: convert"),
    "an image": (f'<image href="a.png" width="9" height="9"/>{RECT}', "1 image"),
    "a mask": ('<rect width="40" height="10" mask="url(#m)"/>', "1 mask"),
    "a clip": (f'<g clip-path="url(#m)">{RECT}</g>', "1 clip-path"),
    "markers": ('<path d="M0 0h40v10" marker-end="url(#m)"/>', "1 marker"),
    "no paint": (f'<path d="M-90 0h900v900z" fill="none"/>{RECT}', "1 shape without fill and stroke"),
    "no opacity of its fill": (f'<g fill-opacity="0">{BIG}</g>{RECT}', "1 shape without fill and stroke"),
    "a clear colour": (f'<g fill="rgba(9, 9, 9, 0)">{BIG}</g>{RECT}', "1 shape without fill and stroke"),
    "no width": (f'<g fill="none" stroke="red" stroke-width="0">{BIG}</g>{RECT}', "1 shape without"),
    "outside of the page": (
        f'<g transform="translate(301)">{BIG}</g>{RECT}',
        "1 outline outside of the page",
    ),
    "for printers": (
        f"<style>@media print {{rect {{display: none}}}}</style>{RECT}",
        'style of "@media print"',
    ),
    "a box of its own": (
        '<rect width="40" height="10" style="transform-box: fill-box; transform: scale(2)"/>',
        "1 transform-box",
    ),
    "another file": (f'<use href="other.svg#a"/>{RECT}', r'1 use of "other\.svg#a"'),
    "a rule": (f"<style>g > rect {{display: none}}</style>{RECT}", '1 style of "g > rect"'),
}


@pytest.mark.parametrize("name", LEFT_OUT)
def test_what_a_browser_shows_and_midair_does_not_draw_is_named(name: str) -> None:
    inside, reported = LEFT_OUT[name]
    with pytest.warns(midair.SceneWarning, match=reported) as found:
        assert ratio(inside) == pytest.approx(4.0, rel=3e-3)
    assert len(found) == 1
    assert "\n" not in str(found[0].message)


@pytest.mark.parametrize("transform", ["rotateZ(9deg)", "translate(50%)", "skew(9deg)", "translate3d(1px, 2px, 0)"])
def test_a_transform_that_is_not_read_is_refused(transform: str) -> None:
    with pytest.raises(midair.SceneError, match=r"its transform .* is not read, give a matrix"):
        drawn(f'<rect width="40" height="10" style="transform: {transform}"/>')


def test_a_drawing_of_no_page_has_no_outside() -> None:
    inside = '<path d="M0 0H400V100H0Z"/><circle cx="300" r="9"/>'
    drawing = f'<svg xmlns="http://www.w3.org/2000/svg" width="100%">{inside}</svg>'
    assert np.ptp(shape.svg(drawing, size=0.4, z=0.1), axis=0)[0] == pytest.approx(0.4)


def test_a_drawing_of_text_alone_says_so() -> None:
    with pytest.raises(midair.SceneError, match=r"nothing is drawn in it \(only 1 text\), give one"):
        drawn("<text>hi</text>")


def random_transform(random: np.random.Generator) -> tuple[str, Points]:
    """Returns a transform as text, and its matrix (3, 3)."""
    a, b = random.uniform(-2, 2, 2).round(3)
    angle = round(random.uniform(-80, 80), 3)
    t = np.tan(np.radians(angle))
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    move = np.array([[1, 0, a], [0, 1, b], [0, 0, 1]])
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    m = random.uniform(-1, 1, 6).round(3)
    choices = [
        (f"translate({a},{b})", move),
        (f"rotate({angle})", turn),
        (f"rotate({angle} {a} {b})", move @ turn @ np.linalg.inv(move)),
        (f"scale({a})", np.diag([a, a, 1])),
        (f"scale({a} {b})", np.diag([a, b, 1])),
        (f"skewX({angle})", np.array([[1, t, 0], [0, 1, 0], [0, 0, 1]])),
        (f"skewY({angle})", np.array([[1, 0, 0], [t, 1, 0], [0, 0, 1]])),
        (f"matrix({','.join(map(str, m))})", np.array([[m[0], m[2], m[4]], [m[1], m[3], m[5]], [0, 0, 1]])),
    ]
    return choices[random.integers(len(choices))]


def random_shape(random: np.random.Generator) -> tuple[str, Points]:
    """Returns a shape as text, and a fine sample of its outline (K, 2)."""
    x, y = random.uniform(-20, 20, 2).round(2)
    w, h = random.uniform(5, 30, 2).round(2)
    t = np.linspace(0, 1, 2001)[:, None]

    def lines(*corners: tuple[float, float]) -> Points:
        each = pairwise(corners)
        return np.concatenate([np.array(a) + t * (np.array(b) - a) for a, b in each])

    around = np.concatenate([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)], axis=1)
    p = np.array([[x, y], [x + w, y - h], [x - w, y + h], [x + w, y + w]])
    curve = (1 - t) ** 3 * p[0] + 3 * t * (1 - t) ** 2 * p[1] + 3 * t**2 * (1 - t) * p[2] + t**3 * p[3]
    corners = " ".join(f"{a},{b}" for a, b in p)
    choices = [
        (
            f'<rect x="{x}" y="{y}" width="{w}" height="{h}"/>',
            lines((x, y), (x + w, y), (x + w, y + h), (x, y + h), (x, y)),
        ),
        (f'<circle cx="{x}" cy="{y}" r="{w}"/>', np.array([x, y]) + w * around),
        (f'<ellipse cx="{x}" cy="{y}" rx="{w}" ry="{h}"/>', np.array([x, y]) + [w, h] * around),
        (f'<line x1="{x}" y1="{y}" x2="{w}" y2="{h}"/>', lines((x, y), (w, h))),
        (f'<polyline points="{corners}"/>', lines(*map(tuple, p))),
        (f'<polygon points="{corners}"/>', lines(*map(tuple, p), tuple(p[0]))),
        (f'<path d="M{x} {y}C{" ".join(map(str, p[1:].ravel()))}"/>', curve),
        (
            f'<path d="M{x + w} {y}A{w} {h} 0 0 1 {x - w} {y}"/>',
            np.array([x, y]) + [w, h] * around[: len(around) // 2 + 1],
        ),
    ]
    return choices[random.integers(len(choices))]


def placed(points: Points, matrix: Points) -> Points:
    return points @ matrix[:2, :2].T + matrix[:2, 2]


def random_drawing(random: np.random.Generator, depth: int, ids: list[str]) -> tuple[str, str, Points]:
    """Returns an element with transforms, its definitions, and its outlines in its parent's units."""
    moves = [random_transform(random) for _ in range(random.integers(0, 3))]
    matrix = np.eye(3)
    for _, one in moves:
        matrix = matrix @ one
    transform = f' transform="{" ".join(text for text, _ in moves)}"' if moves else ""
    if depth == 0:
        text, outline = random_shape(random)
        return text.replace("/>", f"{transform}/>"), "", placed(outline, matrix)
    children = [random_drawing(random, depth - 1, ids) for _ in range(random.integers(1, 3))]
    text, defs = "".join(child[0] for child in children), "".join(child[1] for child in children)
    outline = np.concatenate([child[2] for child in children])
    x, y, w, h, left, up, across, down = random.uniform(10, 60, 8).round(2)
    scale = min(w / across, h / down)
    fitted = np.diag([scale, scale, 1.0])
    fitted[:2, 2] = [(w - across * scale) / 2 - left * scale, (h - down * scale) / 2 - up * scale]
    move = np.array([[1, 0, x], [0, 1, y], [0, 0, 1]])
    view = f'viewBox="{left} {up} {across} {down}"'
    ids.append(f"i{len(ids)}")
    kind = random.integers(4)
    if kind == 0:
        return f"<g{transform}>{text}</g>", defs, placed(outline, matrix)
    if kind == 1:
        defs += f'<g id="{ids[-1]}">{text}</g>'
        return f'<use href="#{ids[-1]}" x="{x}" y="{y}"{transform}/>', defs, placed(outline, matrix @ move)
    if kind == 2:
        defs += f'<symbol id="{ids[-1]}" {view}>{text}</symbol>'
        text = f'<use href="#{ids[-1]}" x="{x}" y="{y}" width="{w}" height="{h}"{transform}/>'
        return text, defs, placed(outline, matrix @ move @ fitted)
    nested = f'<svg x="{x}" y="{y}" width="{w}" height="{h}" {view}>{text}</svg>'
    return f"<g{transform}>{nested}</g>", defs, placed(outline, matrix @ move @ fitted)


@pytest.mark.parametrize("seed", range(40))
def test_nested_transforms_are_where_matrix_algebra_puts_them(seed: int) -> None:
    text, defs, outline = random_drawing(np.random.default_rng(seed), 3, [])
    size = 0.2
    points = shape.svg(f"{HEAD}<defs>{defs}</defs>{text}</svg>", size=size, z=0.1, step=size / 300)[:, :2]
    # Scaled as `shape.svg` does: the longer side is `size`, the middle is at 0, and y points up.
    least, most = outline.min(axis=0), outline.max(axis=0)
    expected = (outline - (least + most) / 2) * [1, -1] * size / (most - least).max()
    assert KDTree(expected).query(points)[0].max() < 1e-3 * size
    # Points nearer than half a step to an earlier one are left out.
    assert KDTree(points).query(expected)[0].max() < 5e-3 * size


def test_letters_that_need_a_shaper_are_refused_by_name() -> None:
    for string, script in (("سلام", "Arabic"), ("שלום", "Hebrew"), ("नमस्ते", "Devanagari"), ("a س", "Arabic")):
        with pytest.raises(midair.SceneError, match=f"{script} letters need a shaper") as error:
            shape.text(string, height=0.03, z=0.1)
        assert "\n" not in str(error.value)


def test_a_warning_of_a_scene_file_names_the_drawing(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text(f"{HEAD}<text>hi</text>{RECT}</svg>", "utf-8")
    text = '[array]\npreset = "paper20"\n[shape]\nkind = "svg"\nfile = "a.svg"\nsize = 0.02\nz = 0.1\n'
    with pytest.warns(midair.SceneWarning, match=r"a\.svg without 1 text"):
        midair.Scene.parse(text, folder=tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (tmp_path / "a.svg").write_text(f"{HEAD}{RECT}</svg>", "utf-8")
        midair.Scene.parse(text, folder=tmp_path)
