"""Membrane: viscoelastic skin on a triangle mesh, solved for each line of the spectrum.

core/src/touch/membrane.rs has the equation of the membrane, and solves it on a plane.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._midair import REACH, SKIN, Membrane, Mesh, Shifted
from .._support.arguments import needs, number, warn

#: Mode of SuperLU for symmetric matrices, with pivots on the diagonal.
SYMMETRIC = {"SymmetricMode": True}

#: Largest plausible `reach` in m.
WIDEST = 0.02

#: Default wave speed in m/s, loss factor, and mass in kg/m^2.
SPEED: float
LOSS: float
MASS: float
SPEED, LOSS, MASS = SKIN


def model_of(
    speed: Any = SPEED, loss: Any = LOSS, mass: Any = MASS, reach: Any = REACH, tau: Any = 0.0
) -> tuple[Membrane, float, float]:
    """Check the arguments of the model; return the membrane, `reach` in m and `tau` in s."""
    membrane = Membrane(
        number("speed", speed, above=0), number("loss", loss, least=0.1), number("mass", mass, above=0)
    )
    width = number("reach", reach, above=0)
    if width > WIDEST:
        warn(f"reach is {width:g} m, wider than a finger: give {width * 1e-3:g} if mm are meant")
    return membrane, width, number("tau", tau, least=0)


def on_mesh(
    membrane: Membrane, frequencies: NDArray[np.float64], lines: NDArray[np.complex64], mesh: Triangles
) -> NDArray[np.complex64]:
    """Return displacements (L, V) in m for pressure lines (L, V) in Pa at the corners of triangles."""
    order = mesh.order
    loads = (lines[:, order] * mesh.shares[order]).astype(np.complex64)
    solved = mesh.systems.solve(membrane.decay(frequencies) ** 2, loads.ravel())
    found = np.empty_like(lines)
    found[:, order] = solved.reshape(lines.shape) / np.complex64(membrane.tension)
    return found


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
        with needs("skin of a Mesh needs SciPy", "mesh"):
            from scipy.sparse import csr_array, diags_array
            from scipy.sparse.linalg import splu
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
