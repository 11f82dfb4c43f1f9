"""Sheet: a viscoelastic membrane under periodic pressure, solved for each line of the spectrum.

With e^(+j w t), the displacement u of a membrane with mass per area m, wave speed c and loss factor eta obeys

    T (laplacian u - s^2 u) = -p,    T = m c^2 (1 + j eta),    s = j w/(c sqrt(1 + j eta)).

A point force F gives u = F K_0(s r)/(2 pi T). These waves fall to 1/e in about 2 c/(eta w), so that high
frequencies spread less far than low ones. At 0 Hz an infinite membrane has no solution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Mesh, Plane, SceneError, Shifted

#: Integral of K_nu: number of samples, and upper limit, where e^(-z cosh t) is negligible for every |z| from
#: 1e-5 on.
SAMPLES, END = 221, 16.0

#: Table of K_0 along one direction of the complex plane: least and largest |z|, and number of entries. The
#: interpolation error is 0.2 % as long as the waves have fallen by less than a factor of 100.
LEAST, MOST, ENTRIES = 1e-5, 400.0, 6000


#: Mode of SuperLU for symmetric matrices, with pivots on the diagonal.
SYMMETRIC = {"SymmetricMode": True}


@dataclass(frozen=True)
class Sheet:
    """A membrane: wave speed in m/s, loss factor, and mass in kg/m^2."""

    speed: float = 6.0
    loss: float = 0.4
    mass: float = 6.4

    @property
    def tension(self) -> complex:
        """Complex tension T = m c^2 (1 + j eta) of the membrane, in N/m."""
        return self.mass * self.speed**2 * (1 + 1j * self.loss)

    def decay(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Return the complex decay s in 1/m of waves, e^(-s r) at a distance r, for frequencies in Hz."""
        found: NDArray[np.complex128] = (
            2j * np.pi * np.asarray(frequency) / (self.speed * np.sqrt(1 + 1j * self.loss))
        )
        return found

    def response(self, distance: NDArray[np.float64], frequency: float) -> NDArray[np.complex128]:
        """Return the displacement in m/N at distances in m from a point force."""
        s = complex(self.decay(frequency))
        sizes, values = _table(round(float(np.angle(s)), 12))
        found = np.interp(np.log(np.maximum(abs(s) * distance, LEAST)), sizes, values)
        return found / (2 * np.pi * self.tension)

    def on_plane(
        self, frequencies: NDArray[np.float64], lines: NDArray[np.complex64], step: float
    ) -> NDArray[np.complex64]:
        """Return displacements (L, R, C) in m for pressure lines (L, R, C) in Pa on squares of side `step` m.

        The membrane is infinite: the convolution with the response to a point force uses FFTs of twice the
        size. At the force itself, the response is its mean over a disc with the area of a square.
        """
        rows, columns = lines.shape[1:]
        squares = step * np.hypot(np.arange(rows + 1)[:, None], np.arange(columns + 1))
        radius = step / np.sqrt(np.pi)
        z = self.decay(frequencies) * radius
        own = (1 - z * bessel(1, z)) * (radius / z) ** 2 / self.tension
        found = np.empty_like(lines)
        for k, frequency in enumerate(frequencies):
            quarter = (self.response(squares, frequency) * step**2).astype(np.complex64)
            quarter[0, 0] = own[k]
            spread = np.fft.fft2(lines[k], (2 * rows, 2 * columns)) * _even_spectrum(quarter)
            # The padding is cut off: only these rows and columns are the skin.
            found[k] = np.fft.ifft(np.fft.ifft(spread, axis=0)[:rows], axis=1)[:, :columns]
        return found

    def on_mesh(
        self, frequencies: NDArray[np.float64], lines: NDArray[np.complex64], mesh: Triangles
    ) -> NDArray[np.complex64]:
        """Return displacements (L, V) in m for pressure lines (L, V) in Pa at the corners of triangles."""
        order = mesh.order
        loads = (lines[:, order] * mesh.shares[order]).astype(np.complex64)
        solved = mesh.systems.solve(self.decay(frequencies) ** 2, loads.ravel())
        found = np.empty_like(lines)
        found[:, order] = solved.reshape(lines.shape) / np.complex64(self.tension)
        return found


def _even_spectrum(quarter: NDArray[np.complex64]) -> NDArray[np.complex64]:
    """Return the spectrum (2 R, 2 C) of an even function from its quarter (R + 1, C + 1)."""
    found: NDArray[Any] = quarter
    for axis in (0, 1):
        found = np.fft.fft(_mirrored(found, axis), axis=axis).take(range(found.shape[axis]), axis)
    return _mirrored(_mirrored(found, 0), 1)


def _mirrored(half: NDArray[np.complex64], axis: int) -> NDArray[np.complex64]:
    """Return a half of n + 1 values along an axis, followed by its mirror image: 2 n values."""
    inner = half.take(range(half.shape[axis] - 2, 0, -1), axis)
    return np.concatenate([half, inner], axis=axis)


def bessel(order: int, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return the modified Bessel function K_0 or K_1 of z, Re z > 0, by the path of steepest descent.

    K_nu(z) = integral from 0 to infinity of e^(-z cosh t) cosh(nu t) dt. The path is shifted by -j arg(z)
    tanh(t).
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
    """Return log |z| and K_0(|z| e^(j turn))."""
    logs = np.linspace(np.log(LEAST), np.log(MOST), ENTRIES)
    return logs, bessel(0, np.exp(logs + 1j * turn))


class Triangles:
    """A surface of triangles with linear finite elements, as SciPy's sparse matrices.

    Parameters
    ----------
    stiffness
        (V, V): integrals of the products of the elements' gradients.
    shares
        (V,) in m^2: a third of the area of the triangles around each corner.
    order
        (V,): order of the corners in which the factors of such matrices are sparse.
    systems
        Systems (stiffness + s^2 shares) x = load of the corners in this order, for any s.
    """

    def __init__(self, vertices: NDArray[np.float64], faces: NDArray[Any]) -> None:
        try:
            from scipy.sparse import csr_array, diags_array
            from scipy.sparse.linalg import splu
        except ImportError as error:
            raise SceneError('skin of a Mesh needs SciPy: pip install "midair[mesh]"') from error
        corners = vertices[faces]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        twice = np.linalg.norm(cross, axis=1)
        self._faces, self._areas, count = faces, twice / 2, len(vertices)
        normals = cross / twice[:, None]
        # Gradient of a corner's hat function: the opposite edge, rotated by 90 degrees, divided by twice the
        # area.
        edges = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        hats = np.cross(normals[:, None], edges) / twice[:, None, None]
        rows = np.repeat(np.arange(len(faces)), 3)
        self._gradients = [
            csr_array((hats[..., axis].ravel(), (rows, faces.ravel())), shape=(len(faces), count))
            for axis in range(3)
        ]
        weights = diags_array(self._areas)
        self.stiffness = sum(g.T @ weights @ g for g in self._gradients)
        self.shares = np.bincount(faces.ravel(), np.repeat(self._areas / 3, 3), count)
        # This matrix is positive definite and has the pattern of the matrices of all frequencies, so its
        # order of corners suits all of them.
        first = splu(
            (self.stiffness + diags_array(self.shares)).tocsc(), "MMD_AT_PLUS_A", 0, options=SYMMETRIC
        )
        self.order = order = np.argsort(first.perm_c)
        ordered = self.stiffness[order][:, order].tocsc()
        ordered.sort_indices()
        self.systems = Shifted(ordered.indptr, ordered.indices, ordered.data, self.shares[order])
        outward = np.zeros((count, 3))
        np.add.at(outward, faces, cross[:, None])
        self.normals = outward / np.linalg.norm(outward, axis=1, keepdims=True)

    def slopes(self, lines: NDArray[np.complex64]) -> Iterator[NDArray[np.float64]]:
        """Yield |gradient|^2 (V,) of each line (L, V), averaged over the triangles around each corner."""
        for line in lines:
            squares = sum(np.abs(g @ line) ** 2 for g in self._gradients) * self._areas / 3
            yield np.bincount(self._faces.ravel(), np.repeat(squares, 3), len(line)) / self.shares


@lru_cache(maxsize=2)
def triangles(hand: Mesh) -> Triangles:
    """Return the triangles of a hand's mesh."""
    return Triangles(hand.vertices, hand.faces)


def squares(plane: Plane) -> NDArray[np.float64]:
    """Return the places (pixels^2, 3) of a plane, row after row upwards."""
    axes = [plane.along(name) for name in "xyz"]
    across, up = (axis for axis in axes if axis is not None)
    first, second = (values.ravel() for values in np.meshgrid(across, up))
    columns = iter((first, second))
    return np.stack(
        [np.full(len(first), plane.at) if axis is None else next(columns) for axis in axes], axis=1
    )
