"""Forces on spheres that are not small, compared with the momentum flux through their surface."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import eval_legendre, spherical_jn, spherical_yn

import midair
import traps
from oracle import Complex, Real
from traps import DENSITY, FREQUENCY, SOUND_SPEED, WAVELENGTH

K = 2 * np.pi / WAVELENGTH
BOARD = midair.Array.grid(16, 16, 10.5e-3, directivity="point", source_pressure=4.0)


def flux(sources: Real, drive: Complex, center: Real, radius: float) -> Real:
    """Returns the force (3,) on a fixed rigid sphere: -int n (|p|^2/(4 rho c^2) - |grad p|^2/(4 rho omega^2))
    dS.

    On its surface, the total pressure of a monopole e^{jkr}/r is -1/(k a^2) sum_n (2n + 1) h_n(k
    r_s)/h_n'(ka) P_n(cos gamma), by the Wronskian of j_n and h_n. sphere_series.py defines the symbols.
    """
    x = K * radius
    terms = int(x + 4 * x ** (1 / 3) + 14)
    heights, shares = np.polynomial.legendre.leggauss(terms + 2)
    angles = np.pi * np.arange(2 * terms + 4) / (terms + 2)
    across = np.sqrt(1 - heights**2)[:, None]
    sides = [across * np.cos(angles), across * np.sin(angles), heights[:, None] + 0 * angles]
    normals = np.stack(sides, axis=-1).reshape(-1, 3)
    weights = np.repeat(shares * np.pi / (terms + 2), len(angles)) * radius**2
    ways = sources - center
    r = np.linalg.norm(ways, axis=1)
    ways = ways / r[:, None]
    cosines = normals @ ways.T
    p = np.zeros(cosines.shape, complex)
    slope = np.zeros(cosines.shape, complex)
    before = np.zeros(cosines.shape)
    for n in range(terms):
        h = spherical_jn(n, K * r) + 1j * spherical_yn(n, K * r)
        rise = spherical_jn(n, x, derivative=True) + 1j * spherical_yn(n, x, derivative=True)
        amplitude = -(2 * n + 1) * h / rise / (K * radius**2)
        legendre = eval_legendre(n, cosines)
        p += amplitude * legendre
        # The slope P_n' from (x^2 - 1) P_n' = n (x P_n - P_(n-1)).
        slope += amplitude * n * (cosines * legendre - before) / (cosines**2 - 1)
        before = legendre
    total = p @ drive
    along = np.einsum("ps,sx,s->px", slope, ways, drive)
    along -= np.einsum("px,px->p", along, normals)[:, None] * normals
    gradient = along / radius
    pressed = abs(total) ** 2 / (4 * DENSITY * SOUND_SPEED**2)
    pressed -= (abs(gradient) ** 2).sum(axis=1) / (4 * DENSITY * (2 * np.pi * FREQUENCY) ** 2)
    return -(weights * pressed) @ normals


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radius", "places"),
    [
        (10e-3, 2),
        (2e-3, 3),
        (1e-3, 3),
        (0.3e-3, 3),
        *(pytest.param(*case, marks=pytest.mark.long) for case in ((25e-3, 1), (10e-3, 20))),
    ],
)
def test_the_force_is_the_flux_of_momentum(radius: float, places: int) -> None:
    rng = np.random.default_rng(7)
    points = rng.uniform(-0.03, 0.03, (places, 3)) + np.array([0, 0, 0.09])
    scene = midair.Scene(BOARD, points)
    for j, point in enumerate(points):
        drive = np.exp(2j * np.pi * rng.random(256)) if j % 2 else midair.solve(scene.replace(points=[point])).drive
        drive = drive.astype(np.complex64)
        found = midair.gorkov(scene, drive, [point], bead={"radius": radius, "density": 1e9, "sound_speed": 1e9})
        wanted = flux(BOARD.positions, 4.0 * drive.astype(complex), point, radius)
        # Up to lambda/8 the waves above the quadrupole are left out.
        assert np.linalg.norm(found.force[0] - wanted) < (1e-3 if radius != 1e-3 else 3e-3) * np.linalg.norm(wanted)
        assert np.isnan(found.potential).all() == (radius > WAVELENGTH / 8)


@pytest.mark.parametrize("density", [4.0, 29.0, 1e6])
def test_force_and_stiffness_do_not_jump_where_the_whole_series_begins(density: float) -> None:
    """Compares radii beside lambda/8, in a standing wave and in the travelling wave of one board."""
    positions, normals = traps.openmpd()
    array = midair.Array(positions, normals, directivity="point")
    scene = midair.Scene(array, [[0, 0, 0]], signature="trap")
    place = [[0, 0, WAVELENGTH / 16]]
    drives = [midair.solve(scene).drive, np.where(positions[:, 2] < 0, 1, 0).astype(np.complex64)]
    sizes = np.array([0.1249, 0.1251]) * WAVELENGTH
    for drive in drives:
        small, large = (midair.gorkov(scene, drive, place, bead=midair.Bead(a, density, 1e9)) for a in sizes)
        growth = 1.0016**6
        assert abs(large.force[0, 2] / small.force[0, 2] - 1) < growth - 1 + 3e-3
    standing = [midair.gorkov(scene, drives[0], place, bead=midair.Bead(a, density, 1e9)) for a in sizes]
    assert np.allclose(*(felt.stiffness for felt in standing), rtol=0.015)


def test_what_does_not_fit_is_refused() -> None:
    scene = midair.Scene(BOARD, [[0, 0, 0.02]])
    drive = np.ones(256, np.complex64)
    with pytest.raises(midair.SceneError, match=r"bead\.radius is 0\.03: give at most 2\.55e-2, three wavelengths"):
        midair.gorkov(scene, drive, bead={"radius": 0.03})
    with pytest.raises(midair.SceneError, match=r"points\[0\] .* leave 2\.2e-2 m for the sphere"):
        midair.gorkov(scene, drive, bead={"radius": 0.0219})
