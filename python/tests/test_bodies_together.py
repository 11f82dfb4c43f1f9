"""Several bodies: those that touch, and those that the boundary element method cannot solve."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair

pytest.importorskip("scipy")
from test_bodies import POINTS, ball

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("cache")]


def brick(at: Any, lengths: Any, kind: Any = "rigid") -> midair.Mesh:
    corners = np.array(at) + np.indices((2, 2, 2)).reshape(3, -1).T * lengths
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    return midair.Mesh(corners, np.array(faces), kind)


BOX = brick([-0.006, -0.006, 0.09], 0.012)
UNSOLVABLE = {
    "twice": ([BOX, BOX], "are there twice near"),
    "one surface doubled": (
        [midair.Mesh(np.tile(BOX.vertices, (2, 1)), np.concatenate([BOX.faces, BOX.faces + 8]))],
        "are there twice near",
    ),
    "crossing": ([BOX, brick([0, -0.006, 0.09], 0.012)], "bodies that cross"),
    "within": ([BOX, brick([-0.003, -0.003, 0.093], 0.006, "soft")], "contain each other"),
    "within, the other way": ([brick([-0.003, -0.003, 0.093], 0.006, "soft"), BOX], "contain each other"),
    "a plate of 50 um": (
        [brick([-0.012, -0.012, 0.1], [0.024, 0.024, 50e-6])],
        "a body thinner than 0.27 mm",
    ),
    "foil": ([brick([-0.012, -0.012, 0.1], [0.024, 0.024, 1e-6], "soft")], "a body thinner than 0.27 mm"),
}


@pytest.mark.parametrize("name", UNSOLVABLE)
def test_bodies_that_cannot_be_solved_are_refused_in_one_line(name: str, cache: Path) -> None:
    bodies, reported = UNSOLVABLE[name]
    kept = set(cache.rglob("*.npz"))
    with pytest.raises(midair.SceneError, match=reported) as error:
        midair.Scene(midair.Array.grid(4, 4, 10e-3), POINTS[:1], obstacles=bodies)
    assert "\n" not in str(error.value)
    assert set(cache.rglob("*.npz")) == kept


def test_a_plate_as_thin_as_allowed_has_the_shadow_of_a_thick_one() -> None:
    """Compares the plates in the shadow only: beside it, the edges of the two plates scatter differently."""
    array = midair.Array.grid(6, 6, 10e-3)
    places = [[0, 0, 0.16], [0.01, 0.005, 0.15]]
    thin, thick = (
        midair.Scene(array, places, obstacles=[brick([-0.012, -0.012, 0.1], [0.024, 0.024, thickness])]).propagation()
        for thickness in (0.3e-3, 1e-3)
    )
    # With faces of a sixth of this size, the fields of the two plates differ by 4 %.
    assert np.abs(thin - thick).max() < 0.05 * np.abs(thick).max()


def test_bodies_that_touch_are_their_union() -> None:
    array = midair.Array.grid(6, 6, 10e-3)
    two = [BOX, brick([0.006, -0.006, 0.09], 0.012)]
    one = [brick([-0.006, -0.006, 0.09], [0.024, 0.012, 0.012])]
    places = [[0, 0, 0.14], [0.03, 0, 0.12], [-0.02, 0.02, 0.1]]
    split, union = (midair.Scene(array, places, obstacles=bodies).propagation() for bodies in (two, one))
    assert np.abs(split - union).max() < 0.05 * np.abs(union).max()


def test_sound_that_is_left_inside_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    from midair._points import boundary

    monkeypatch.setattr(boundary, "LEFT", 1e-4)
    with pytest.raises(midair.SceneError, match=r"elements that lets \d+% of the sound into its inside: mend"):
        midair.Scene(midair.Array.grid(4, 4, 10e-3), POINTS[:1], obstacles=[ball(1, radius=0.0078)])
