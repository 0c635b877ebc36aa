# SPDX-License-Identifier: Apache-2.0
"""A right knee of planes: what it carries is known in closed form."""

import numpy as np

from condyle.contact import Mesh


def patch(height: float, z: float, half: float, cells: int, *, up: bool) -> Mesh:
    """A square plane patch at y = height about (x, z) = (0.003, z)."""
    steps = np.linspace(-half, half, cells + 1)
    x, dz = np.meshgrid(0.003 + steps, steps, indexing="ij")
    vertices = np.stack([x, np.full_like(x, height), z + dz], axis=-1).reshape(-1, 3)
    corner = np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)
    a, b = corner.ravel(), corner.ravel() + cells + 1
    faces = np.concatenate([np.stack([a, a + 1, b + 1], 1), np.stack([a, b + 1, b], 1)])
    return Mesh(vertices, np.ascontiguousarray((faces if up else faces[:, ::-1]).astype(np.int32)))


def box(half: tuple[float, float, float], shift: tuple[float, float, float]) -> Mesh:
    """A closed box about `shift`, normals out."""
    vertices = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    faces = [[0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5], [0, 1, 5], [0, 5, 4]]
    faces += [[2, 6, 7], [2, 7, 3], [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6]]
    return Mesh(vertices * half + np.array(shift), np.array(faces, np.int32))


def inserts() -> tuple[Mesh, Mesh]:
    """The compartments of a right knee: planes at y = 7.3 mm, 12 mm wide."""
    medial, lateral = (patch(0.0073, z, 0.006, 12, up=True) for z in (-0.021, 0.021))
    return medial, lateral


def femur() -> Mesh:
    """A box wide enough to cover both compartments; its lowest face at y = -11 mm."""
    return box((0.02, 0.011, 0.04), (0.0, 0.0, 0.0))
