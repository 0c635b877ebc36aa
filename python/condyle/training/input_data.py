# SPDX-License-Identifier: Apache-2.0
"""Checks on samples before anything is trained on them."""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES
from condyle.errors import InputDataError

#: Index of Fy and Mx in a wrench.
FY, MX = LOAD_COLUMNS.index("Fy"), LOAD_COLUMNS.index("Mx")


def as_poses(values: ArrayLike, name: str = "poses") -> NDArray[np.float64]:
    """``values`` as finite poses (n, 6) float64 [m, rad].

    Raises:
        InputDataError: Wrong shape, or a value that is not finite (row and column are named).
    """
    poses = _as_float64(values, name)
    if poses.ndim != 2 or poses.shape[1] != len(POSE_COLUMNS):
        raise InputDataError(f"{name} has shape {poses.shape}; it must be (n, {len(POSE_COLUMNS)})")
    bad = np.argwhere(~np.isfinite(poses))
    if len(bad):
        row, column = bad[0]
        raise InputDataError(
            f"{name} row {row} column {POSE_COLUMNS[column]} is {poses[row, column]}; "
            "it must be finite"
        )
    return poses


def as_wrenches(values: ArrayLike, n: int, name: str = "wrenches") -> NDArray[np.float64]:
    """``values`` as finite wrenches (n, 2, 6) float64 [N, Nm].

    Raises:
        InputDataError: Wrong shape, or a value that is not finite (row, side and load are named).
    """
    wrenches = _as_float64(values, name)
    expected = (n, len(SIDES), len(LOAD_COLUMNS))
    if wrenches.shape != expected:
        raise InputDataError(f"{name} has shape {wrenches.shape}; it must be {expected}")
    bad = np.argwhere(~np.isfinite(wrenches))
    if len(bad):
        row, side, load = bad[0]
        raise InputDataError(
            f"{name} row {row} {SIDES[side]} {LOAD_COLUMNS[load]} is {wrenches[row, side, load]}; "
            "it must be finite"
        )
    return wrenches


def check_samples(
    poses: ArrayLike, wrenches: ArrayLike, min_loaded_rows: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Samples fit for training.

    Args:
        poses: (n, 6) [m, rad].
        wrenches: (n, 2, 6) [N, Nm].
        min_loaded_rows: Fewest rows with Fy > 0 on each side.

    Returns:
        poses (n, 6) and wrenches (n, 2, 6), float64.

    Raises:
        InputDataError: Wrong shapes, values that are not finite, a pose twice, too few
            loaded rows.
    """
    poses = as_poses(poses)
    wrenches = as_wrenches(wrenches, len(poses))
    _, first, counts = np.unique(poses, axis=0, return_index=True, return_counts=True)
    if len(first) != len(poses):
        pose = poses[first[counts > 1].min()]
        rows = np.flatnonzero((poses == pose).all(axis=1))
        raise InputDataError(
            f"poses rows {rows[0]} and {rows[1]} are the same pose {pose.tolist()}; "
            f"each pose must occur once ({len(poses) - len(first)} repeated)"
        )
    for index, side in enumerate(SIDES):
        fy = wrenches[:, index, FY]
        loaded = int((fy > 0).sum())
        if loaded < min_loaded_rows:
            raise InputDataError(
                f"the {side} side is loaded in {loaded} of {len(poses)} samples; "
                f"at least {min_loaded_rows} are needed"
            )
    return poses, wrenches


def data_hash(poses: NDArray[np.float64], wrenches: NDArray[np.float64]) -> str:
    """SHA-256 of the samples' bytes, in their order."""
    digest = hashlib.sha256()
    for array in (poses, wrenches):
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _as_float64(values: ArrayLike, name: str) -> NDArray[np.float64]:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputDataError(f"{name} is not an array of numbers: {error}") from error
