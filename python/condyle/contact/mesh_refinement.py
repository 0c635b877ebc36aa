# SPDX-License-Identifier: Apache-2.0
"""The same surface in smaller faces, for a contact integral that must not depend on how a mesh was drawn."""

import numpy as np
from numpy.typing import NDArray

from condyle._core.geometry import Mesh
from condyle.errors import InputDataError

#: 4⁶ faces for one is beyond any use.
_MOST_SPLITS = 6


def mean_edge_length(mesh: Mesh) -> float:
    """Mean length of the faces' sides [m]."""
    corners = np.asarray(mesh.vertices)[np.asarray(mesh.faces)]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())


def refine_mesh(mesh: Mesh, edge_length: float) -> Mesh:
    """Splits every face into four, in its own plane, until sides are shorter on average.

    Args:
        mesh: Any surface; its shape does not change.
        edge_length: Of the mean side afterwards, at most [m].

    Raises:
        InputDataError: ``edge_length`` is not above 0, or more than 64 times shorter than the mesh's.
    """
    if not edge_length > 0.0:
        raise InputDataError(f"refine_mesh: edge_length is {edge_length}: must be above 0 m")
    length, splits = mean_edge_length(mesh), 0
    while length > edge_length:
        length, splits = 0.5 * length, splits + 1
    if splits > _MOST_SPLITS:
        raise InputDataError(
            f"refine_mesh: edge_length is {edge_length} m, {2**splits} times shorter than the mesh's: "
            f"at most {2**_MOST_SPLITS}"
        )
    vertices = np.array(mesh.vertices, dtype=np.float64)
    faces = np.array(mesh.faces, dtype=np.int64)
    for _ in range(splits):
        vertices, faces = _split(vertices, faces)
    return Mesh(np.ascontiguousarray(vertices), np.ascontiguousarray(faces.astype(np.int32)))


def _split(
    vertices: NDArray[np.float64], faces: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Each face into four at the middles of its sides; neighbours share them."""
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, place = np.unique(sides, axis=0, return_inverse=True)
    middles = place.reshape(3, -1) + len(vertices)
    (a, b, c), (ab, bc, ca) = faces.T, middles
    four = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    split = np.concatenate([np.stack(corners, axis=1) for corners in four])
    return np.concatenate([vertices, vertices[unique].mean(axis=1)]), split
