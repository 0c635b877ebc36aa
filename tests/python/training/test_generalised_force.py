# SPDX-License-Identifier: Apache-2.0
"""The torch version of Q = Gᵀ·wrench agrees with the core's, and differentiates as written."""

import numpy as np
import torch

from condyle.training.generalised_force import (
    generalised_force,
    wrench_and_stiffness_of,
    wrench_of,
)

POSES = np.random.default_rng(71).uniform(-0.6, 0.6, (50, 6))
WRENCHES = np.random.default_rng(72).normal(size=(50, 6)) * 100


def test_virtual_work_is_the_same_in_both():
    """Q·dp = F·dFo + M·dω for a small motion, from the rotation matrices alone."""
    pose, wrench = torch.from_numpy(POSES), torch.from_numpy(WRENCHES)
    Q = generalised_force(pose, wrench).numpy()
    step = 1e-6
    for k in range(3, 6):
        before, after = POSES.copy(), POSES.copy()
        before[:, k] -= step
        after[:, k] += step
        turn = _rotations(after) @ _rotations(before).transpose(0, 2, 1)
        skew = (turn - turn.transpose(0, 2, 1)) / 2
        omega = np.column_stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]]) / (2 * step)
        work = (WRENCHES[:, 3:] * omega).sum(axis=1)
        # Central differences: h² ~ 1e-12 of the second derivative, eps/h ~ 1e-10 of the load.
        np.testing.assert_allclose(Q[:, k], work, atol=1e-6)
    np.testing.assert_array_equal(Q[:, :3], WRENCHES[:, :3])


def _rotations(poses):
    (cx, cy, cz), (sx, sy, sz) = np.cos(poses[:, 3:].T), np.sin(poses[:, 3:].T)
    zero, one = np.zeros_like(cx), np.ones_like(cx)
    about_x = np.array([[one, zero, zero], [zero, cx, sx], [zero, -sx, cx]])
    about_y = np.array([[cy, zero, -sy], [zero, one, zero], [sy, zero, cy]])
    about_z = np.array([[cz, sz, zero], [-sz, cz, zero], [zero, zero, one]])
    return np.einsum("ijn,jkn,kln->nil", about_x, about_y, about_z)


def test_there_and_back_is_the_identity():
    pose, wrench = torch.from_numpy(POSES), torch.from_numpy(WRENCHES)
    back = wrench_of(pose, generalised_force(pose, wrench)).numpy()
    np.testing.assert_allclose(back, WRENCHES, rtol=1e-12, atol=1e-11)


def test_stiffness_is_the_derivative_of_the_wrench():
    generator = torch.Generator().manual_seed(73)
    linear = torch.randn(6, 6, dtype=torch.float64, generator=generator) * 50
    constant = torch.randn(6, dtype=torch.float64, generator=generator) * 100

    def wrench(pose):
        return wrench_of(pose[None], (pose @ linear + constant)[None])[0]

    pose = torch.from_numpy(POSES)
    force, derivative = pose @ linear + constant, linear.T.expand(len(pose), 6, 6)
    found, stiffness = wrench_and_stiffness_of(pose, force, derivative)
    expected = torch.stack([torch.func.jacrev(wrench)(row) for row in pose])
    np.testing.assert_allclose(stiffness, expected, rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(found, torch.stack([wrench(row) for row in pose]), rtol=1e-12)
