# SPDX-License-Identifier: Apache-2.0
"""A small elastic contact with a closed form, to train on where the mesh contact is not wanted.

Each side of the femur is three spheres (centre c_k in F, radius r_k, from distal to posterior),
each pressed on a dished surface y = s(x, z) of the insert. With the depth d = s(c_x, c_z) + r − c_y
of a sphere and the energy U = k d³/3 (an elastic foundation under a sphere), the force on the femur
acts through the sphere's centre:

    F = −∂U/∂c = k d² (−s_x, 1, −s_z),   M about Fo = (c − o) × F.

Right knee: medial is z < 0.
"""

import numpy as np
from numpy.typing import NDArray

STIFFNESS = 1.6e9  # N/m²: about 2 kN a side at 1.2 mm
DISH_RADII = (0.055, 0.095)  # m, sagittal and frontal radius of the insert's dishes
CENTRE_Z = {"medial": -0.0235, "lateral": 0.0225}  # m
#: x, y in F and radius of the spheres, m
SPHERES = {
    "medial": ((0.004, -0.006, 0.0292), (-0.0085, -0.0035, 0.0254), (-0.0121, 0.0049, 0.0213)),
    "lateral": ((0.005, -0.0055, 0.0287), (-0.0079, -0.0031, 0.0251), (-0.0117, 0.0052, 0.0207)),
}


def rotations_tf(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """R_TF (n, 3, 3) = Rx(−θx)·Ry(−θy)·Rz(−θz) of poses (n, 6)."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(poses[:, 3:].T), -np.sin(poses[:, 3:].T)
    zero, one = np.zeros_like(cx), np.ones_like(cx)
    shape = (3, 3, len(poses))
    r_x = np.array([one, zero, zero, zero, cx, -sx, zero, sx, cx]).reshape(shape)
    r_y = np.array([cy, zero, sy, zero, one, zero, -sy, zero, cy]).reshape(shape)
    r_z = np.array([cz, -sz, zero, sz, cz, zero, zero, zero, one]).reshape(shape)
    return np.einsum("ijn,jkn,kln->nil", r_x, r_y, r_z)


def _depths(
    poses: NDArray[np.float64], side: str
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Depth (n, 3), upward direction (n, 3, 3) and arm c − o (n, 3, 3) of a side's spheres."""
    spheres = np.array(SPHERES[side])
    centres_f = np.column_stack([spheres[:, :2], np.full(3, CENTRE_Z[side])])
    arms = np.einsum("nij,kj->nki", rotations_tf(poses), centres_f)
    centres = arms + poses[:, None, :3]
    x, z = centres[..., 0], centres[..., 2] - CENTRE_Z[side]
    dish = x**2 / (2 * DISH_RADII[0]) + z**2 / (2 * DISH_RADII[1])
    up = np.stack([-x / DISH_RADII[0], np.ones_like(x), -z / DISH_RADII[1]], axis=-1)
    return dish + spheres[:, 2] - centres[..., 1], up, arms


def wrench(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Wrench (n, 2, 6) on the femur at Fo in T, medial first."""
    sides = []
    for side in ("medial", "lateral"):
        depth, up, arms = _depths(poses, side)
        forces = STIFFNESS * np.maximum(depth, 0)[..., None] ** 2 * up
        sides.append(np.concatenate([forces.sum(1), np.cross(arms, forces).sum(1)], axis=-1))
    return np.stack(sides, axis=1)


def sample(n: int, seed: int, max_depth: float = 1.3e-3) -> NDArray[np.float64]:
    """Poses (n, 6) over 0-70 degrees of flexion whose deepest sphere is −0.4 mm to ``max_depth``
    deep."""
    generator = np.random.default_rng(seed)
    unit = generator.random((n, 6))
    poses = np.empty((n, 6))
    poses[:, 0] = 0.012 * (unit[:, 0] - 0.5)
    poses[:, 2] = 0.005 * (unit[:, 1] - 0.5)
    poses[:, 3] = 0.05 * (unit[:, 2] - 0.5)
    poses[:, 4] = 0.25 * (unit[:, 3] - 0.5)
    poses[:, 5] = -np.deg2rad(70) * unit[:, 4]
    poses[:, 1] = 0.0
    # A depth falls by exactly as much as y rises, so y follows from the depth wanted.
    deepest = np.maximum(_depths(poses, "medial")[0].max(1), _depths(poses, "lateral")[0].max(1))
    poses[:, 1] = deepest - (-4e-4 + (max_depth + 4e-4) * unit[:, 5])
    return poses
