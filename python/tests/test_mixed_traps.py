"""Traps and foci in one scene, judged by an own model in double precision."""

from typing import Any

import numpy as np
import pytest

import beads
import midair
import traps
from oracle import Complex, Real
from traps import scattered

BOX, APART = [0.05, 0.05, 0.02], 0.02


class Field:
    """Pressures, stiffness and resting places of a drive of two OpenMPD boards of point sources."""

    def __init__(self, drive: Any) -> None:
        self.drive = np.asarray(drive, complex)
        self.air = beads.Air(traps.openmpd()[0])

    def pressure(self, points: Real) -> Complex:
        """The pressure (M,) at points (M, 3)."""
        r = np.linalg.norm(points[:, None] - self.air.positions, axis=2)
        return (self.air.source * np.exp(2j * np.pi / traps.WAVELENGTH * r) / r) @ self.drive

    def hessian(self, points: Real) -> Real:
        """The stiffness (M, 3, 3), by differences of the force."""

        def force(at: Real) -> Real:
            return self.air.force(self.drive, at.reshape(-1, 3)).reshape(at.shape)

        slope = traps.along(force, points)
        return -(slope + slope.swapaxes(1, 2)) / 2

    def softest(self, points: Real) -> float:
        """The least stiffness of all in N/m."""
        return float(np.linalg.eigvalsh(self.hessian(points)).min())

    def apart(self, points: Real) -> float:
        """The largest distance in m at which a bead rests from its point."""
        net = self.air.force(self.drive, points) + self.air.weight
        return float(np.linalg.norm(np.linalg.solve(self.hessian(points), net[..., None]), axis=1).max())


@pytest.mark.parametrize("quantization", [{}, {"phases": 16}], ids=["free", "16"])
@pytest.mark.parametrize(("traps_", "foci"), [(1, 1), (2, 2)])
def test_traps_beside_foci_are_stiff_and_the_foci_have_their_pressures(
    quantization: Any, traps_: int, foci: int
) -> None:
    array = midair.Array(*traps.openmpd(), quantization=quantization)
    for seed in (20, 21):
        points = scattered(traps_ + foci, BOX, APART, seed)
        trapped, focused = points[:traps_], points[traps_:]
        pressures = [0.0] * traps_ + [1000.0, 3000.0][:foci]
        scene = midair.Scene(array, points, pressures, signature=["trap"] * traps_ + [None] * foci)
        solution = midair.solve(scene)
        found = Field(solution.drive)
        assert solution.status == "done"
        np.testing.assert_allclose(abs(found.pressure(focused)), pressures[traps_:], rtol=5e-3)
        assert found.apart(trapped) < 0.03e-3
        alone = Field(midair.solve(midair.Scene(array, trapped, signature="trap")).drive)
        assert found.softest(trapped) > 0.8 * alone.softest(trapped)
        # Metrics are those of the foci.
        assert solution.metrics.accuracy == pytest.approx(1, abs=5e-3)
        assert solution.metrics.leak == 0


def test_without_pressures_foci_are_as_loud_as_before_and_beads_rest_at_their_points() -> None:
    array = midair.Array(*traps.openmpd(), quantization={})
    names = ["trap", None, "trap"]
    for seed in (20, 21):
        points = scattered(3, BOX, APART, seed)
        scene = midair.Scene(array, points, signature=names)
        equal = midair.solve(scene, pressures=1000.0, aim="max")
        solution = midair.solve(scene)
        found, before = Field(solution.drive), Field(equal.drive)
        assert abs(found.pressure(points[1:2])[0]) == pytest.approx(abs(before.pressure(points[1:2])[0]), rel=2e-3)
        assert found.softest(points[::2]) > 1.05 * before.softest(points[::2])
        assert found.apart(points[::2]) < 0.02e-3 < before.apart(points[::2])


@pytest.mark.filterwarnings("ignore:traps hold:midair.SceneWarning")
def test_traps_without_a_pressure_are_what_the_foci_leave() -> None:
    """By all solvers; pressures above 0 of traps are still those of their foci."""
    array = midair.Array(*traps.openmpd())
    points = scattered(3, BOX, APART, 20)
    scene = midair.Scene(array, points, [0.0, 2000.0, 0.0], signature=["trap", None, "trap"])
    for solver in ("naive", "fast", "gspat"):
        assert Field(midair.solve(scene, solver).drive).softest(points[::2]) > 0
    both = midair.solve(scene, pressures=[1000.0, 2000.0, 1500.0])
    np.testing.assert_allclose(abs(both.pressures), [1000, 2000, 1500], rtol=2e-3)
    with pytest.warns(midair.SceneWarning, match="missed by"):
        loud = midair.solve(scene, pressures=[0.0, 20000.0, 0.0])
    assert loud.status == "missed"
    assert abs(loud.pressures[1]) > 0.99 * scene.reach().alone[1]


@pytest.mark.slow
def test_a_trap_that_moves_beside_a_focus_carries_its_bead() -> None:
    positions, normals = traps.openmpd()
    array = midair.Array(positions, normals, source_pressure=2.3, quantization={})
    points = beads.circle(2, 0.8, 10e3, laps=0.3)
    moved = midair.sequence(array, points, rate=10e3, change=np.pi / 16, signature=["trap", None])
    assert moved.metrics.largest_change <= np.pi / 16 * (1 + 1e-5)
    begin = midair.rest(moved.scene(0), moved.drives[0], points[0][:1]).place
    assert beads.Air(positions, 2.3).stray(moved.drives, points[:, :1], begin, 10e3).max() < 0.3e-3
    levels = [abs(Field(moved.drives[t]).pressure(points[t, 1:])[0]) for t in (0, 400, -1)]
    assert min(levels) > 0.95 * max(levels)
