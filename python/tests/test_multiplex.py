"""Drives that play in turn, against plain sums of point sources, and modulated solutions of traps."""

import numpy as np
import pytest

import midair

ARRAY = midair.Array.grid(16, 16, 10.5e-3)
POINTS = np.array([[0.004 * x, 0.004 * y, 0.1] for x in range(-4, 5) for y in range(-4, 5)])
# A cross that is three times as loud as its surroundings.
TARGETS = np.where((abs(POINTS[:, 0]) < 5e-3) | (abs(POINTS[:, 1]) < 5e-3), 900.0, 300.0)


def pressures(drives: np.ndarray) -> np.ndarray:
    """Returns |p| (T, M) by a plain sum over point sources."""
    r = np.linalg.norm(POINTS[:, None] - ARRAY.positions, axis=2)
    gains = 4.386 * np.exp(2j * np.pi * 40e3 / 340 * r) / r
    return np.abs(drives.astype(complex) @ gains.T)


def error(amplitudes: np.ndarray) -> float:
    return float(np.sqrt(((amplitudes - TARGETS) ** 2).sum() / (TARGETS**2).sum()))


def test_several_drives_have_the_requested_mean() -> None:
    scene = midair.Scene(ARRAY, POINTS, pressures=TARGETS)
    single = error(pressures(midair.solve(scene, "lm").drive))
    turns = midair.multiplex(scene, 3, "lm", rate=1e3, rounds=8)
    mean = np.sqrt((pressures(turns.drives) ** 2).mean(axis=0))
    assert mean == pytest.approx(turns.rms, rel=1e-4)
    assert error(mean) < min(0.01, single / 2)
    assert (len(turns), turns.closed, turns.rate) == (3, True, 1e3)
    # No frame alone is the pattern.
    assert min(error(frame) for frame in pressures(turns.drives)) > 0.05


def test_a_mean_that_is_out_of_reach_is_reported() -> None:
    scene = midair.Scene(ARRAY, POINTS, pressures=20 * TARGETS)
    with pytest.warns(midair.SceneWarning, match="the mean of 2 frames misses the pressures by"):
        midair.multiplex(scene, 2, rate=1e3, rounds=1)


@pytest.mark.parametrize(
    ("scene", "reported"),
    [
        (midair.Scene(ARRAY, POINTS), "give a midair.Scene with pressures="),
        (midair.Scene(ARRAY, POINTS, pressures=100, signature="twin"), "scene.signature is given"),
        (midair.Scene(ARRAY, POINTS[:1], pressures=100), "frames is 2: each needs a point of a pressure"),
        (
            midair.Scene(ARRAY, POINTS[:2], [1, 0], weights=[1, 2]),
            "frames is 2: each needs a point of a pressure",
        ),
    ],
)
def test_what_has_no_mean_is_refused(scene: midair.Scene, reported: str) -> None:
    with pytest.raises(midair.SceneError, match=reported):
        midair.multiplex(scene, 2, rate=1e3)


@pytest.mark.parametrize("frames", [10, 2**40, 2**70])
def test_more_frames_than_points_are_refused_at_once(frames: int) -> None:
    scene = midair.Scene(ARRAY, POINTS[:3], pressures=100)
    with pytest.raises(midair.SceneError, match=f"frames is {frames}: each needs a point"):
        midair.multiplex(scene, frames, rate=1e3)


def test_a_modulated_solution_keeps_its_traps_and_bead() -> None:
    bead = midair.Bead(radius=0.5e-3)
    scene = midair.Scene(ARRAY, [[0, 0, 0.1]], signature="twin", bead=bead)
    pulses = midair.solve(scene).modulated(200)
    assert (pulses.scene(0).signature, pulses.scene(0).bead) == (scene.signature, bead)
    assert pulses.pressures.max(axis=0) == pytest.approx(pulses.targets.max(axis=0), rel=1e-4)
