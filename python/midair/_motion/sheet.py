"""Sheet: a viscoelastic membrane under pressure that repeats, line by line of its spectrum.

With e^(+j w t), the displacement w of a membrane of mass m for each area, wave speed c and loss factor eta is

    T (laplacian w - s^2 w) = -p,    T = m c^2 (1 + j eta),    s = j w/(c sqrt(1 + j eta)).

A point load F makes w = F K_0(s r)/(2 pi T): waves that go out and fall to 1/e in about 2 c/(eta w), so that
high frequencies stay nearer than low ones. The steady part, 0 Hz, has no answer on an endless sheet.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Mesh, Plane, SceneError

#: Of the integral of K_nu: samples, and its end, where e^(-z cosh t) is nothing for every |z| from 1e-5 on.
SAMPLES, END = 221, 16.0

#: The table of K_0 along one direction of the complex plane: |z| from, to, and how many: to 0.2 % where waves
#: have not fallen to a hundredth.
LEAST, MOST, ENTRIES = 1e-5, 400.0, 6000


#: Corners that are not divided further.
LEAF = 48


@dataclass(frozen=True)
class Sheet:
    """A membrane: wave speed in m/s, loss factor, and mass in kg/m^2."""

    speed: float = 6.0
    loss: float = 0.4
    mass: float = 6.4

    @property
    def tension(self) -> complex:
        """T = m c^2 (1 + j eta), in N/m."""
        return self.mass * self.speed**2 * (1 + 1j * self.loss)

    def decay(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """The s of frequencies in Hz, in 1/m: waves fall as e^(-Re(s) r), and turn by Im(s) r."""
        found: NDArray[np.complex128] = (
            2j * np.pi * np.asarray(frequency) / (self.speed * np.sqrt(1 + 1j * self.loss))
        )
        return found

    def response(self, distance: NDArray[np.float64], frequency: float) -> NDArray[np.complex128]:
        """Displacement in m/N at distances in m from a point load."""
        s = complex(self.decay(frequency))
        sizes, values = _table(round(float(np.angle(s)), 12))
        found = np.interp(np.log(np.maximum(abs(s) * distance, LEAST)), sizes, values)
        return found / (2 * np.pi * self.tension)

    def on_plane(
        self, frequencies: NDArray[np.float64], lines: NDArray[np.complex64], step: float
    ) -> NDArray[np.complex64]:
        """Displacement (L, R, C) in m under pressure lines (L, R, C) in Pa, on squares of side `step` in m.

        The sheet goes on for ever: FFT of twice the size, by the response to a point load, and by its mean
        over a disc of a square's area where the load is.
        """
        shape = lines.shape[1:]
        double = [2 * n for n in shape]
        across, up = (step * np.minimum(np.arange(n), n - np.arange(n)) for n in double)
        squares = np.hypot(across[: shape[0] + 1, None], up[: shape[1] + 1])
        radius = step / np.sqrt(np.pi)
        found = np.empty_like(lines)
        for k, frequency in enumerate(frequencies):
            quarter = self.response(squares, frequency) * step**2
            z = complex(self.decay(frequency)) * radius
            quarter[0, 0] = (1 - z * complex(bessel(1, np.array(z)))) * (radius / z) ** 2 / self.tension
            half = np.concatenate([quarter, quarter[-2:0:-1]])
            kernel = np.concatenate([half, half[:, -2:0:-1]], axis=1).astype(np.complex64)
            spread = np.fft.fft2(lines[k], double) * np.fft.fft2(kernel)
            found[k] = np.fft.ifft2(spread)[: shape[0], : shape[1]]
        return found

    def on_mesh(
        self, frequencies: NDArray[np.float64], lines: NDArray[np.complex64], mesh: Triangles
    ) -> NDArray[np.complex64]:
        """Displacement (L, V) in m under pressure lines (L, V) in Pa at the corners of triangles."""
        from scipy.sparse.linalg import splu

        found, order = np.empty_like(lines), mesh.order
        stiffness, shares = mesh.stiffness[order][:, order].tocsc(), mesh.areas_of_corners.diagonal()[order]
        places = np.arange(len(order) + 1)
        for k, squared in enumerate(self.decay(frequencies) ** 2):
            inertia = type(stiffness)((squared * shares, places[:-1], places), stiffness.shape)
            stiff = (stiffness + inertia).astype(np.complex64)
            # The matrix is symmetric, and its loss keeps every pivot from 0: the order may stay.
            factors = splu(stiff, permc_spec="NATURAL", diag_pivot_thresh=0, options={"SymmetricMode": True})
            load = (lines[k][order] * shares).astype(np.complex64)
            found[k, order] = factors.solve(load) / np.complex64(self.tension)
        return found


def bessel(order: int, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """The modified Bessel function K_0 or K_1 of Re z > 0, by its integral along a path of steepest descent.

    K_nu(z) = integral from 0 to infinity of e^(-z cosh t) cosh(nu t), shifted by -j arg(z) tanh(t).
    """
    t = np.linspace(0.0, END, SAMPLES)
    turn = np.angle(z)[..., None]
    path = t - 1j * turn * np.tanh(t)
    slope = 1 - 1j * turn / np.cosh(t) ** 2
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        values = np.exp(-z[..., None] * np.cosh(path)) * np.cosh(order * path) * slope
    values = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    values[..., 0] /= 2
    summed: NDArray[np.complex128] = values.sum(axis=-1) * (END / (SAMPLES - 1))
    return summed


@lru_cache(maxsize=8)
def _table(turn: float) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Logarithms of |z| and K_0(|z| e^(j turn))."""
    logs = np.linspace(np.log(LEAST), np.log(MOST), ENTRIES)
    return logs, bessel(0, np.exp(logs + 1j * turn))


class Triangles:
    """A surface of triangles by linear elements, of SciPy's sparse matrices.

    Parameters
    ----------
    stiffness
        (V, V), the integral of the product of gradients.
    areas_of_corners
        (V, V), a third of the triangles around each corner, on the diagonal.
    order
        (V,), of corners, in which factors of such matrices stay sparse.
    """

    def __init__(self, vertices: NDArray[np.float64], faces: NDArray[Any]) -> None:
        try:
            from scipy.sparse import csr_array, diags_array
        except ImportError as error:
            raise SceneError('skin of a Mesh needs SciPy: pip install "midair[mesh]"') from error
        corners = vertices[faces]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        twice = np.linalg.norm(cross, axis=1)
        self._faces, self._areas, count = faces, twice / 2, len(vertices)
        normals = cross / twice[:, None]
        # The gradient of a corner's hat: the opposite edge, turned by a right angle, over twice the area.
        edges = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        hats = np.cross(normals[:, None], edges) / twice[:, None, None]
        rows = np.repeat(np.arange(len(faces)), 3)
        self._gradients = [
            csr_array((hats[..., axis].ravel(), (rows, faces.ravel())), shape=(len(faces), count))
            for axis in range(3)
        ]
        weights = diags_array(self._areas)
        self.stiffness = sum(g.T @ weights @ g for g in self._gradients)
        shares = np.bincount(faces.ravel(), np.repeat(self._areas / 3, 3), count)
        self.areas_of_corners = diags_array(shares)
        self.order = np.array(_dissected(np.arange(count), vertices, self.stiffness.tocsr()))
        outward = np.zeros((count, 3))
        np.add.at(outward, faces, cross[:, None])
        self.normals = outward / np.linalg.norm(outward, axis=1, keepdims=True)
        self._shares = shares

    def slopes(self, lines: NDArray[np.complex64]) -> Iterator[NDArray[np.float64]]:
        """|gradient|^2 (V,) of each of some lines (L, V): the mean over the triangles around a corner."""
        for line in lines:
            squares = sum(np.abs(g @ line) ** 2 for g in self._gradients) * self._areas / 3
            yield np.bincount(self._faces.ravel(), np.repeat(squares, 3), len(line)) / self._shares


def _dissected(corners: NDArray[np.int64], vertices: NDArray[np.float64], graph: Any) -> list[int]:
    """Nested dissection (George 1973): one half, the other, and last those of it that touch the first."""
    if len(corners) <= LEAF:
        return list(corners)
    along = vertices[corners, int(np.ptp(vertices[corners], axis=0).argmax())]
    first, second = corners[along < np.median(along)], corners[along >= np.median(along)]
    touches = np.diff(graph[second][:, first].indptr) > 0
    if not len(first) or touches.all():
        return list(corners)
    halves = (_dissected(half, vertices, graph) for half in (first, second[~touches]))
    return [*next(halves), *next(halves), *second[touches]]


@lru_cache(maxsize=2)
def triangles(hand: Mesh) -> Triangles:
    """The triangles of a hand's mesh."""
    return Triangles(hand.vertices, hand.faces)


def squares(plane: Plane) -> NDArray[np.float64]:
    """Places (pixels^2, 3) of a plane, row after row upwards."""
    axes = [plane.along(name) for name in "xyz"]
    across, up = (axis for axis in axes if axis is not None)
    first, second = (values.ravel() for values in np.meshgrid(across, up))
    columns = iter((first, second))
    return np.stack(
        [np.full(len(first), plane.at) if axis is None else next(columns) for axis in axes], axis=1
    )
