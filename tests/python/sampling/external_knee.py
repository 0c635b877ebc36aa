# SPDX-License-Identifier: Apache-2.0
"""A knee that Condyle has no model of: two rollers on a plate, as another program would write it.

Each side pushes with F = c·d³ (d the overlap) at its own place under the femur, leaning with x: the
wrench about the femoral origin is (F, r × F). Units and rotations are the file's: mm, deg, N, Nmm.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from condyle.conventions import POSE_COLUMNS, WRENCH_COLUMNS

#: Force a cubed millimetre of overlap [N/mm³]; where the sides touch, z in T of a right knee [mm].
COEFFICIENT = 1300.0
SIDE_Z = (-21.0, 26.0)


def external_table(rows: int, seed: int = 41) -> pd.DataFrame:
    """Poses [mm, deg] and wrenches [N, Nmm] of a right knee, some sides lifted off."""
    rng = np.random.default_rng(seed)
    x, z = rng.uniform(-9.0, 8.0, rows), rng.uniform(-2.0, 2.5, rows)
    tilt, turn = rng.uniform(-1.5, 1.2, rows), rng.uniform(-5.0, 4.0, rows)
    extension = rng.uniform(-95.0, 6.0, rows)
    height = 39.0 + 0.02 * extension + 0.004 * x**2
    y = height - rng.uniform(-0.5, 1.1, rows)
    wrenches = np.zeros((rows, 2, 6))
    for side, side_z in enumerate(SIDE_Z):
        overlap = np.maximum(height - y - side_z * np.radians(tilt), 0.0)
        Fy = COEFFICIENT * overlap**3
        force = np.column_stack([0.03 * x * Fy / 5, Fy, -0.02 * z * Fy])
        arm = np.column_stack([-x, -y, side_z - z])
        wrenches[:, side] = np.hstack([force, np.cross(arm, force)])
    poses = np.column_stack([x, y, z, tilt, turn, extension])
    table = np.hstack([poses, wrenches.reshape(rows, 12)])
    return pd.DataFrame(table, columns=[*POSE_COLUMNS, *WRENCH_COLUMNS])
