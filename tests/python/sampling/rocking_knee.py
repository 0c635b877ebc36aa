# SPDX-License-Identifier: Apache-2.0
"""A real contact that is quick to sample: a cylinder (the femur) on two flat compartments of a right knee."""

import numpy as np

from condyle.contact import Mesh, MeshContact
from condyle.sampling import DomainTarget, ReferenceCurve, ReferenceCurves, SamplingPlan

RADIUS = 0.0221
HEIGHT = 0.0113  # of the compartments [m]
#: All six domains, in chunks small enough for several workers.
SIX_DOMAINS = SamplingPlan(
    (
        DomainTarget(1, 20, 0),
        DomainTarget(2, 30, 5),
        DomainTarget(3, 17, 3),
        DomainTarget(4, 17, 3),
        DomainTarget(5, 80, 12),
        DomainTarget(6, 8, 2),
    ),
    seed=5,
    pilot=32,
    chunk_rows=16,
)


def grid(points: np.ndarray) -> Mesh:
    """A surface of points (rows, columns, 3), normals along d/d(column) × d/d(row)."""
    rows, columns = points.shape[:2]
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([a, a + 1, a + columns + 1], 1),
            np.stack([a, a + columns + 1, a + columns], 1),
        ]
    )
    return Mesh(points.reshape(-1, 3), np.ascontiguousarray(faces.astype(np.int32)))


def rocking_contact(**settings: object) -> MeshContact:
    """With settings of MeshContact."""

    def compartment(z: float) -> Mesh:
        x, dz = np.meshgrid(np.linspace(-0.017, 0.017, 25), np.linspace(-0.009, 0.009, 13))
        return grid(np.stack([x, np.full_like(x, HEIGHT), z + dz], -1).transpose(1, 0, 2))

    angle, z = np.meshgrid(np.linspace(-2.8, 2.8, 90), np.linspace(-0.041, 0.041, 5))
    # Below the axis at angle 0; seen from outside, the angle runs with x and z to the right.
    femur = np.stack([RADIUS * np.sin(angle), -RADIUS * np.cos(angle), z], -1)
    return MeshContact(grid(femur), compartment(-0.0213), compartment(0.0213), "right", **settings)


def rocking_curves() -> ReferenceCurves:
    """One activity that moves all six variables."""
    t = np.linspace(0, 1, 60)
    w = 2 * np.pi * t
    fy = 330 + 150 * np.sin(w) + 60 * np.cos(3 * w)
    columns = [
        0.002 * np.cos(w + 0.7),
        np.full_like(t, HEIGHT + RADIUS),
        0.0007 * np.sin(w - 1.1) + 0.0003 * np.cos(4 * w),
        0.002 * np.sin(w),
        0.03 * np.cos(2 * w - 0.4),
        -0.4 + 0.3 * np.sin(w + 2.0),
        fy,
        0.006 * fy * np.sin(2 * w + 0.3),
    ]
    return ReferenceCurves((ReferenceCurve("rocking", t, np.column_stack(columns)),))
