# SPDX-License-Identifier: Apache-2.0
"""Errors of a simulated activity, surrogate against reference (Marra et al. 2017, Tables 3 and 4)."""

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.evaluation.metrics import error_statistics

#: Columns of a clinical kinematics array: (name, unit shown, factor from SI to that unit).
KINEMATICS: Final = (
    ("flexion", "deg", 180.0 / math.pi),
    ("adduction", "deg", 180.0 / math.pi),
    ("tibial_external_rotation", "deg", 180.0 / math.pi),
    ("anterior_tibial_translation", "mm", 1e3),
    ("distraction", "mm", 1e3),
    ("lateral_tibial_translation", "mm", 1e3),
)


def _row(
    activity: str,
    quantity: str,
    unit: str,
    reference: NDArray[np.float64],
    surrogate: NDArray[np.float64],
) -> dict[str, Any]:
    statistics = error_statistics(reference, surrogate)
    return {
        "activity": activity,
        "quantity": quantity,
        "unit": unit,
        "count": statistics.count,
        "rmse": statistics.rmse,
        "max_error": statistics.max_error,
        "r2": statistics.r2,
    }


def simulation_load_error_table(
    activity: str, reference: NDArray[np.float64], surrogate: NDArray[np.float64]
) -> list[dict[str, Any]]:
    """One row a side and load, from wrenches (n, 2, 6) [N, Nm] at the same n time frames."""
    return [
        _row(activity, f"{side}_{load}", LOAD_UNITS[i], reference[:, s, i], surrogate[:, s, i])
        for s, side in enumerate(SIDES)
        for i, load in enumerate(LOAD_COLUMNS)
    ]


def kinematics_error_table(
    activity: str, reference: NDArray[np.float64], surrogate: NDArray[np.float64]
) -> list[dict[str, Any]]:
    """One row a clinical quantity, from clinical kinematics (n, 6) [rad, m] in the order of KINEMATICS."""
    return [
        _row(activity, name, unit, factor * reference[:, i], factor * surrogate[:, i])
        for i, (name, unit, factor) in enumerate(KINEMATICS)
    ]
