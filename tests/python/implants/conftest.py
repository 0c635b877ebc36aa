# SPDX-License-Identifier: Apache-2.0
"""Shared fixtures: each preset generated once, and ways to measure meshes.

The measurements know nothing of how a mesh was generated.
"""

import numpy as np
import pytest
from numpy.typing import NDArray

from condyle.implants import Implant, SurfaceMesh, generate, preset

FloatArray = NDArray[np.float64]


class Measure:
    """Measurements of meshes and points."""

    @staticmethod
    def section(mesh: SurfaceMesh, axis: int, position: float) -> FloatArray:
        """(k, 2) points where edges cross the plane axis = position, the other axes in order."""
        edges = np.unique(np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
        a, b = mesh.vertices[edges[:, 0]], mesh.vertices[edges[:, 1]]
        da, db = a[:, axis] - position, b[:, axis] - position
        cross = da * db < 0.0
        t = (da[cross] / (da[cross] - db[cross]))[:, None]
        on = np.abs(mesh.vertices[:, axis] - position) < 1e-12
        points = np.concatenate([a[cross] + t * (b[cross] - a[cross]), mesh.vertices[on]])
        return np.delete(points, axis, axis=1)

    @staticmethod
    def circle(points: FloatArray) -> tuple[FloatArray, float, float]:
        """Centre, radius and rms residual of the least-squares circle of (k, 2) points."""
        mean = points.mean(axis=0)
        q = points - mean
        rows = np.column_stack([2.0 * q, np.ones(len(q))])
        solution = np.linalg.lstsq(rows, (q**2).sum(axis=1), rcond=None)[0]
        radius = float(np.sqrt(solution[2] + solution[:2] @ solution[:2]))
        residual = np.linalg.norm(q - solution[:2], axis=1) - radius
        return solution[:2] + mean, radius, float(np.sqrt(np.mean(residual**2)))

    @staticmethod
    def edge_uses(mesh: SurfaceMesh) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """How often each undirected, and each directed, edge is used."""
        directed = mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        undirected = np.unique(np.sort(directed, axis=1), axis=0, return_counts=True)[1]
        return undirected, np.unique(directed, axis=0, return_counts=True)[1]

    @staticmethod
    def turns(mesh: SurfaceMesh) -> tuple[FloatArray, FloatArray]:
        """(k,) angle [rad] between the faces at each inner edge, and its (k, 3) midpoint [m]."""
        edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        owner = np.repeat(np.arange(len(mesh.faces)), 3)
        order = np.lexsort((edges[:, 1], edges[:, 0]))
        edges, owner = edges[order], owner[order]
        pair = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
        normals = mesh.face_normals()
        a, b = normals[owner[pair]], normals[owner[pair + 1]]
        angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
        return angle, mesh.vertices[edges[pair]].mean(axis=1)


@pytest.fixture(scope="session")
def measure() -> type[Measure]:
    return Measure


@pytest.fixture(scope="session")
def flat() -> Implant:
    return generate(preset("flat"))


@pytest.fixture(scope="session")
def curved() -> Implant:
    return generate(preset("curved"))


@pytest.fixture(scope="session", params=["flat", "curved"])
def implant(request: pytest.FixtureRequest) -> Implant:
    return request.getfixturevalue(request.param)  # type: ignore[no-any-return]
