"""Pictures in notebooks: their content, their size, and the modules that they load."""

import base64
import io
import re
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

import midair
from midair._pictures.notebook import MOST_DOTS
from scenes import small

#: The largest number of characters that a picture may take in a notebook.
MOST = 40_000

SVG = "{http://www.w3.org/2000/svg}"

LOADS_NO_MATPLOTLIB = """
import sys, midair
scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15], [0.03, 0, 0.15]], pressures=900.0)
solution = midair.solve(scene)
for shown in (scene, solution, solution.field(), midair.solvers()):
    assert "<" in shown._repr_html_()
assert "matplotlib" not in sys.modules
"""


def drawn(html: str) -> ElementTree.Element:
    """Returns the first SVG of an HTML representation."""
    text = re.findall(r"<svg.*?</svg>", html)[0]
    return ElementTree.fromstring(text)


def rings(picture: ElementTree.Element) -> dict[str, list[tuple[int, int]]]:
    """Returns the positions of the rings, by colour."""
    groups = [group for group in picture.iter(f"{SVG}g") if group.get("fill") == "none"]
    return {
        group.get("stroke", ""): [(int(ring.get("cx", "")), int(ring.get("cy", ""))) for ring in group]
        for group in groups
    }


def test_scenes_show_their_points_from_above() -> None:
    points = [[-0.03, 0.03, 0.1], [0.03, 0.03, 0.2], [0, -0.03, 0.1]]
    picture = drawn(small(points=points, pressures=[1, 2, 0])._repr_html_())
    loud, quiet = rings(picture).values()
    assert len(loud) == 2
    assert len(quiet) == 1
    (left, right), (low,) = loud, quiet
    assert left[0] < low[0] < right[0]
    assert left[1] == right[1] < low[1], "y is up"
    (path,) = picture.iter(f"{SVG}path")
    assert path.get("d", "").count("h0") == 64


def test_discs_are_what_the_points_got() -> None:
    solution = midair.solve(small(pressures=[900, 900, 0, 900]), "naive")
    picture = drawn(solution._repr_html_())
    (discs,) = [group for group in picture.iter(f"{SVG}g") if group.get("fill") != "none"]
    radii = [int(disc.get("r", "")) for disc in discs]
    part = np.abs(solution.pressures[[0, 1, 3]]) / 900
    assert radii == pytest.approx(22 * np.clip(part, 0, 1.5), abs=0.51)


def test_large_arrays_keep_their_shape_and_are_small() -> None:
    array = midair.Array.grid(150, 100, 0.01)
    html = midair.Scene(array, [[0, 0, 0.15]])._repr_html_()
    assert len(html) < MOST
    (path,) = drawn(html).iter(f"{SVG}path")
    assert 500 < path.get("d", "").count("h0") < 2 * MOST_DOTS
    assert len(midair.Scene(midair.Array([[0, 0, 0]]), [[0, 0, 0.1]])._repr_html_()) < 2000


def test_sequences_show_the_ways_of_their_points() -> None:
    angle = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    ways = [np.stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + 0.1], axis=1) for r in (0.01, 0.02)]
    array = midair.Array.grid(5, 5, 0.01)
    drives = np.ones((3000, 25), np.complex64)
    for closed, kind in ((True, "polygon"), (False, "polyline")):
        sequence = midair.Sequence(array, np.stack(ways, axis=1), 100.0, drives, rate=1e3, closed=closed)
        html = sequence._repr_html_()
        assert len(html) < MOST
        assert len(list(drawn(html).iter(f"{SVG}{kind}"))) == 2


def test_fields_show_a_picture() -> None:
    scene = small()
    made = midair.field(scene, midair.solve(scene))
    html = made._repr_html_()
    text = re.findall(r'href="data:image/png;base64,([^"]+)"', html)[0]
    with Image.open(io.BytesIO(base64.b64decode(text))) as image:
        seen = np.asarray(image.convert("RGB"), dtype=int)
    shades = np.abs(made.pressure[::-2, ::2]) / np.abs(made.pressure).max()
    assert seen.shape == (*shades.shape, 3)
    wanted = np.asarray(colormaps["magma"](shades))[..., :3] * 255
    # Tolerance for the steps of the palette and for interpolation between colour stops.
    assert np.abs(seen - wanted).max() < 6
    assert len(html) < MOST
    assert "further planes" in html
    assert "<title>|p| where z = 149.5 mm, up to " in html
    at = midair.field(scene, np.ones(64), scene.points)._repr_html_()
    assert "at 4 points" in at
    assert "<image" not in at


def test_solutions_show_a_slice_and_the_phases_of_their_transducers() -> None:
    drive = np.exp(1j * (np.linspace(-np.pi, np.pi, 64, endpoint=False) + 0.01))
    drive[5] = 0
    solution = midair.solve(small(points=[[0, 0, 0.15]]), lambda *_: drive)
    html = solution._repr_html_()
    assert len(html) < 60_000
    assert html.count("<image") == 2, "the slice and its bar"
    paths = list(drawn(html).iter(f"{SVG}path"))
    counts = {path.get("stroke"): path.get("d", "").count("h0") for path in paths}
    assert sum(counts.values()) == 64
    assert counts.pop("currentColor") == 1
    # At most two transducers per colour; the phase pi is dark.
    assert set(counts.values()) <= {1, 2}
    assert len(counts) == 32
    assert "#303030" in counts


@pytest.mark.slow
def test_nothing_loads_matplotlib() -> None:
    subprocess.run([sys.executable, "-c", LOADS_NO_MATPLOTLIB], check=True)
