# SPDX-License-Identifier: Apache-2.0
"""Wrench and generalised force, Q = Gᵀ·wrench and back, in torch and with derivatives.

The convention is common/pose.hpp's: Q is conjugate to the pose, Qx, Qy, Qz = Fx, Fy, Fz and, with
s, c = sin θx, cos θx,

    Qθx = −Mx,   Qθy = −c·My + s·Mz,   Qθz = sin θy·Mx − cos θy·(s·My + c·Mz).

Solved for the moments, with r = (Qθz + sin θy·Qθx)/cos θy:

    Mx = −Qθx,   My = −c·Qθy − s·r,   Mz = s·Qθy − c·r,

which is singular at θy = ±90° only.
"""

from __future__ import annotations

import torch
from torch import Tensor


def generalised_force(pose: Tensor, wrench: Tensor) -> Tensor:
    """Q (n, 6) [N, Nm] of a wrench (n, 6) on the femur at Fo in T, at poses (n, 6)."""
    sine, cosine = torch.sin(pose[:, 3]), torch.cos(pose[:, 3])
    Mx, My, Mz = wrench[:, 3], wrench[:, 4], wrench[:, 5]
    about_z = torch.sin(pose[:, 4]) * Mx - torch.cos(pose[:, 4]) * (sine * My + cosine * Mz)
    moments = torch.stack([-Mx, -cosine * My + sine * Mz, about_z], dim=1)
    return torch.cat([wrench[:, :3], moments], dim=1)


def wrench_of(pose: Tensor, force: Tensor) -> Tensor:
    """Inverse of :func:`generalised_force`."""
    return torch.cat([force[:, :3], _moments(pose, force[:, :, None])[:, :, 0]], dim=1)


def wrench_and_stiffness_of(
    pose: Tensor, force: Tensor, force_derivative: Tensor
) -> tuple[Tensor, Tensor]:
    """The wrench (n, 6) and ∂wrench/∂pose (n, 6, 6), from Q (n, 6) and ∂Q/∂pose (n, 6, 6)."""
    wrench = wrench_of(pose, force)
    moments = _moments(pose, force_derivative)
    sine, cosine = torch.sin(pose[:, 3]), torch.cos(pose[:, 3])
    # What the angles themselves change: the moments turn with θx, and r grows with θy.
    moments[:, 1, 3] += wrench[:, 5]
    moments[:, 2, 3] -= wrench[:, 4]
    growth = (force[:, 3] + torch.sin(pose[:, 4]) * force[:, 5]) / torch.cos(pose[:, 4]) ** 2
    moments[:, 1, 4] -= sine * growth
    moments[:, 2, 4] -= cosine * growth
    return wrench, torch.cat([force_derivative[:, :3], moments], dim=1)


def _moments(pose: Tensor, force: Tensor) -> Tensor:
    """Rows of force (n, 6, m) made moments (n, 3, m) at fixed angles."""
    sine, cosine = torch.sin(pose[:, 3])[:, None], torch.cos(pose[:, 3])[:, None]
    tilt, level = torch.sin(pose[:, 4])[:, None], torch.cos(pose[:, 4])[:, None]
    rest = (force[:, 5] + tilt * force[:, 3]) / level
    return torch.stack(
        [-force[:, 3], -cosine * force[:, 4] - sine * rest, sine * force[:, 4] - cosine * rest],
        dim=1,
    )
