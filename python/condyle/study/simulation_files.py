# SPDX-License-Identifier: Apache-2.0
"""Simulated activities as CSV files in the run directory."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import KINEMATICS_COLUMNS, POSE_COLUMNS, WRENCH_COLUMNS
from condyle.whole_files import write_whole

if TYPE_CHECKING:
    from condyle.study.activity import Simulated

_NUMBERS = ("time_s", *POSE_COLUMNS, *KINEMATICS_COLUMNS, *WRENCH_COLUMNS, "residual", "trust")


def write_simulation(file: Path, simulation: Simulated) -> None:
    """Writes time, pose, clinical kinematics, loads, scaled residual, trust and status of every time frame."""
    table = np.column_stack(
        [
            simulation.time,
            simulation.poses,
            simulation.kinematics,
            simulation.wrenches.reshape(len(simulation.time), 12),
            simulation.residual,
            simulation.trust,
        ]
    )
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*_NUMBERS, "status"])
    for row, status in zip(table.tolist(), simulation.status, strict=True):
        writer.writerow([*map(repr, row), status])
    write_whole(file, text.getvalue())


def read_simulation(file: Path) -> dict[str, NDArray[Any]]:
    """Reads what write_simulation wrote.

    Returns:
        time (n,), poses (n, 6), kinematics (n, 6), wrenches (n, 2, 6), trust (n,), converged (n,).
    """
    numbers = np.loadtxt(
        file, delimiter=",", skiprows=1, usecols=range(len(_NUMBERS)), dtype=np.float64, ndmin=2
    )
    status = np.loadtxt(
        file, delimiter=",", skiprows=1, usecols=len(_NUMBERS), dtype=np.str_, ndmin=1
    )
    return {
        "converged": status == "converged",
        "time": numbers[:, 0],
        "poses": numbers[:, 1:7],
        "kinematics": numbers[:, 7:13],
        "wrenches": numbers[:, 13:25].reshape(-1, 2, 6),
        "trust": numbers[:, 26],
    }
