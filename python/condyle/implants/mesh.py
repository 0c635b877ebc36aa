# SPDX-License-Identifier: Apache-2.0
"""Triangle surfaces as plain arrays, and how structured grids become them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """An oriented triangle surface; a face's corners run counter-clockwise seen from outside.

    Attributes:
        vertices: (n, 3) float64 positions [m].
        faces: (m, 3) int32 vertex indices.

    Raises:
        InputDataError: an array has the wrong shape, or a face names a vertex that is not there.
    """

    vertices: FloatArray
    faces: IndexArray

    def __post_init__(self) -> None:
        """Refuses arrays that are not a triangle surface."""
        for name in ("vertices", "faces"):
            shape = getattr(self, name).shape
            if len(shape) != 2 or shape[1] != 3:
                raise InputDataError(f"mesh {name} of shape {shape}: must be (n, 3)")
        if self.faces.size and not 0 <= self.faces.min() <= self.faces.max() < len(self.vertices):
            raise InputDataError(
                f"mesh faces use vertices {self.faces.min()} to {self.faces.max()}: "
                f"must lie in [0, {len(self.vertices) - 1}]"
            )

    def area_vectors(self) -> FloatArray:
        """(m, 3) outward normal times area of each face [m²]."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        vectors: FloatArray = 0.5 * np.cross(b - a, c - a)
        return vectors

    def face_normals(self) -> FloatArray:
        """(m, 3) outward unit normals."""
        vectors = self.area_vectors()
        normals: FloatArray = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
        return normals

    def centroids(self) -> FloatArray:
        """(m, 3) face centroids [m]."""
        centroids: FloatArray = self.vertices[self.faces].mean(axis=1)
        return centroids

    def mirrored(self) -> "SurfaceMesh":
        """The mirror image in z, faces flipped so that normals stay outward."""
        return SurfaceMesh(
            self.vertices * np.array([1.0, 1.0, -1.0]), np.ascontiguousarray(self.faces[:, ::-1])
        )

    def part(self, selected: NDArray[np.bool_]) -> "SurfaceMesh":
        """The surface made of the selected (m,) faces, without the vertices they do not use."""
        used, faces = np.unique(self.faces[selected], return_inverse=True)
        return SurfaceMesh(self.vertices[used], faces.reshape(-1, 3).astype(np.int32))

    def border_vertices(self) -> IndexArray:
        """Sorted indices of the vertices on the open border."""
        edges = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        unique, count = np.unique(edges, axis=0, return_counts=True)
        return np.unique(unique[count == 1]).astype(np.int32)


def symmetric_mesh(half: FloatArray, welded_rows: NDArray[np.bool_]) -> SurfaceMesh:
    """Triangulates a structured half surface and joins it to its mirror image in z.

    Args:
        half: (rows, columns, 3) points with z >= 0 [m]; column 0 faces the mirror plane. Normals
            come out along (column direction) x (row direction).
        welded_rows: (rows,) where column 0 lies on the mirror plane and is shared by both halves.
    """
    rows, columns = half.shape[:2]
    right = np.arange(rows * columns).reshape(rows, columns)
    left = right + rows * columns
    left[welded_rows, 0] = right[welded_rows, 0]
    vertices = np.concatenate([half.reshape(-1, 3), half.reshape(-1, 3) * [1.0, 1.0, -1.0]])
    vertices[right[welded_rows, 0], 2] = 0.0
    faces = np.concatenate([_grid_faces(right), _grid_faces(left)[:, ::-1]])
    used, compact = np.unique(faces, return_inverse=True)
    return SurfaceMesh(
        np.ascontiguousarray(vertices[used]), compact.reshape(-1, 3).astype(np.int32)
    )


def _grid_faces(index: NDArray[np.intp]) -> NDArray[np.intp]:
    """(2 (r-1)(c-1), 3) triangles of an (r, c) grid of vertex indices, diagonals alternating.

    Alternating diagonals leave no preferred direction: a one-way diagonal would make the
    discretised contact force slightly skew.
    """
    a, b = index[:-1, :-1], index[:-1, 1:]
    c, d = index[1:, :-1], index[1:, 1:]
    even = (np.add.outer(np.arange(a.shape[0]), np.arange(a.shape[1])) % 2 == 0)[..., None]
    first = np.where(even, np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(even, np.stack([b, d, c], -1), np.stack([a, d, c], -1))
    return np.stack([first, second], axis=2).reshape(-1, 3)
