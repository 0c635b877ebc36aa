# SPDX-License-Identifier: Apache-2.0
"""A knee whose static equilibrium is a closed form: two springs under a tilted plateau.

    d_i = h(x, θz) − (y − z_i θx)   (overlap of side i, z_i = ± SPACING)
    F_i = STIFFNESS · d_i⁺,  Fy = Σ F_i,  Mx = −Σ z_i F_i   (small θx; right knee: medial z < 0)

so F_lateral = (Fy − Mx / SPACING) / 2: no equilibrium where |Mx| > SPACING · Fy.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from condyle.sampling import Prescribed, ReferenceCurve, ReferenceCurves, Solved

STIFFNESS = 1.7e6  # N/m
SPACING = 0.023  # m
HEIGHT = 0.031  # m
MAX_DEPTH = 0.65e-3  # m: so that some equilibria are too deep
EDGE = 0.0128  # m: |x| beyond is off the insert
SIDE_Z = np.array([-SPACING, SPACING])


def loads(poses: np.ndarray) -> np.ndarray:
    """Wrenches (n, 2, 6) of poses (n, 6)."""
    x, y, z, theta_x, _, theta_z = poses.T
    height = HEIGHT + 0.4 * x**2 / SPACING + 1e-3 * np.cos(theta_z)
    overlap = height[:, None] - (y[:, None] - SIDE_Z * theta_x[:, None])
    force = STIFFNESS * np.maximum(overlap, 0)
    wrenches = np.zeros((len(poses), 2, 6))
    wrenches[:, :, 0] = -0.8 * x[:, None] / SPACING * force
    wrenches[:, :, 1] = force
    wrenches[:, :, 2] = 0.05 * z[:, None] / SPACING * force
    wrenches[:, :, 3] = -SIDE_Z * force
    return wrenches


@dataclass
class SpringSolver:
    """Static equilibria of the springs.

    ``pause`` [s] a call; ``stop_after`` calls it raises, as an interrupted run does.
    """

    pause: float = 0.0
    stop_after: int | None = None
    calls: int = 0

    def __call__(self, prescribed: Prescribed) -> Solved:
        if self.stop_after is not None and self.calls >= self.stop_after:
            raise KeyboardInterrupt
        self.calls += 1
        time.sleep(self.pause)
        if prescribed.pose_given:
            return self._evaluate(prescribed.to_poses())
        height = HEIGHT + 0.4 * prescribed.x**2 / SPACING + 1e-3 * np.cos(prescribed.theta_z)
        if prescribed.theta_x_given:
            return self._press(prescribed, height)
        force = 0.5 * (prescribed.Fy[:, None] - prescribed.Mx[:, None] / SIDE_Z)
        depth = force / STIFFNESS
        theta_x = (depth[:, 1] - depth[:, 0]) / (2 * SPACING)
        y = height - depth.mean(axis=1)
        poses = np.column_stack(
            [prescribed.x, y, prescribed.z, theta_x, prescribed.theta_y, prescribed.theta_z]
        )
        status = np.full(len(prescribed), "converged", dtype="<U16")
        status[depth.max(axis=1) > MAX_DEPTH] = "overclosure"
        status[np.abs(prescribed.x) > EDGE] = "off_insert"
        status[force.min(axis=1) < 0] = "no_equilibrium"
        evaluations = np.where(status == "no_equilibrium", 2, 6)
        return Solved(poses, loads(poses), status, evaluations, depth.max(axis=1))

    def _evaluate(self, poses: np.ndarray) -> Solved:
        wrenches = loads(poses)
        depth = wrenches[:, :, 1].max(axis=1) / STIFFNESS
        status = np.where(depth > MAX_DEPTH, "overclosure", "converged")
        return Solved(poses, wrenches, status, np.ones(len(poses), dtype=np.int64), depth)

    def _press(self, prescribed: Prescribed, height: np.ndarray) -> Solved:
        """θx given: one spring alone carries Fy unless the other one's gap closes before."""
        tilt, load = prescribed.theta_x, prescribed.Fy / STIFFNESS
        gap = 2 * SPACING * np.abs(tilt)
        lower = np.where(load > gap, (load + gap) / 2, load)  # depth of the side that touches first
        poses = np.column_stack(
            [
                prescribed.x,
                height + SPACING * np.abs(tilt) - lower,
                prescribed.z,
                tilt,
                prescribed.theta_y,
                prescribed.theta_z,
            ]
        )
        status = np.where(lower > MAX_DEPTH, "overclosure", "converged").astype("<U16")
        status[np.abs(prescribed.x) > EDGE] = "off_insert"
        return Solved(poses, loads(poses), status, np.full(len(prescribed), 4), lower)


def spring_curves(frames: int = 90) -> ReferenceCurves:
    """Two activities of a general shape: no variable constant, none a multiple of another."""

    def activity(name: str, phase: float, flexion: float, force: float) -> ReferenceCurve:
        t = np.linspace(0.1, 1.2, frames)
        w = 2 * np.pi * t / 1.1 + phase
        fy = force * (1.05 + np.sin(w) + 0.3 * np.sin(3 * w))
        mx = 0.3 * SPACING * fy * np.sin(2 * w + 0.3)
        x = -0.004 + 0.006 * np.cos(w + 0.7)
        z = 0.0007 * np.sin(w - 1.1) + 0.0002 * np.cos(4 * w)
        theta_y = 0.05 * np.cos(2 * w - 0.4) - 0.03
        theta_z = -flexion * (0.5 + 0.5 * np.sin(w + 2.0)) - 0.05
        y, theta_x = HEIGHT + 0.001 * np.cos(w), 0.01 * np.sin(w)
        return ReferenceCurve(
            name, t, np.column_stack([x, y, z, theta_x, theta_y, theta_z, fy, mx])
        )

    return ReferenceCurves((activity("walk", 0.2, 1.1, 900.0), activity("squat", 1.9, 1.9, 700.0)))
