# SPDX-License-Identifier: Apache-2.0
"""Errors and times of simulated activities beside those that the paper printed (its Tables 3, 4 and 5).

The printed figures are of the paper's own subject, implant and activities: beside any other they are
a yardstick, not a comparison of like with like. An activity stands beside one of the paper's
where its name says that it is of the same kind.

Source: Marra et al. (2017), "Evaluation of a surrogate contact model in force-dependent kinematic
simulations of total knee replacement", J. Biomech. Eng. 139(8), doi:10.1115/1.4036605.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from condyle.conventions import LOAD_COLUMNS, SIDES

Rows = Sequence[Mapping[str, Any]]
#: RMSE and largest error as printed; None where the text at hand is not legible.
Printed = tuple[float, float | None]


@dataclass(frozen=True)
class PaperTimes:
    """A row of Table 5, as printed.

    Attributes:
        time_frames: of the trial.
        duration_s: of the trial.
        reference_min: simulation with the reference contact model, in minutes.
        surrogate_min: simulation with the surrogate, in minutes.
        speed_improvement: the first over the second.
    """

    time_frames: int
    duration_s: float
    reference_min: float
    surrogate_min: float
    speed_improvement: float

    @property
    def reference_real_time(self) -> float:
        """Times faster than real time with the reference: duration over simulation time (not printed)."""
        return self.duration_s / (60.0 * self.reference_min)

    @property
    def surrogate_real_time(self) -> float:
        """Times faster than real time with the surrogate: duration over simulation time (not printed)."""
        return self.duration_s / (60.0 * self.surrogate_min)


#: Table 3. Activity and side: Fx, Fy, Fz [N], Mx, My, Mz [Nm].
PAPER_LOADS: Final[Mapping[tuple[str, str], tuple[Printed, ...]]] = {
    ("normal gait", "medial"): (
        (0.50, 2.2), (4.2, 14), (1.1, 11), (0.17, 1.4), (0.02, 0.09), (0.04, 0.17),
    ),
    # My reads "0.02 (80.0)" in the text at hand, against a largest error of 1.4 Nm over all moments.
    ("normal gait", "lateral"): (
        (0.50, 2.0), (4.4, 17), (0.43, 2.7), (0.12, 0.54), (0.02, None), (0.01, 0.05),
    ),
    ("right-turn", "medial"): (
        (0.49, 3.0), (4.3, 24), (2.2, 11), (0.14, 0.65), (0.04, 0.18), (0.04, 0.16),
    ),
    ("right-turn", "lateral"): (
        (0.95, 4.8), (9.9, 47), (2.2, 21), (0.26, 1.2), (0.03, 0.17), (0.10, 0.6),
    ),
    ("rising from a chair", "medial"): (
        (0.85, 2.7), (5.6, 13), (0.51, 1.5), (0.11, 0.28), (0.01, 0.04), (0.06, 0.14),
    ),
    ("rising from a chair", "lateral"): (
        (0.57, 2.0), (5.7, 13), (0.66, 2.1), (0.11, 0.30), (0.02, 0.07), (0.06, 0.16),
    ),
    ("squat", "medial"): (
        (0.34, 1.1), (4.2, 10), (0.51, 2.0), (0.10, 0.23), (0.01, 0.02), (0.06, 0.15),
    ),
    ("squat", "lateral"): (
        (0.29, 0.96), (3.7, 11), (0.55, 2.2), (0.10, 0.23), (0.01, 0.04), (0.04, 0.13),
    ),
}  # fmt: skip

#: Columns of Table 4, in its order [mm, deg], by their names in the error rows.
PAPER_KINEMATICS_COLUMNS: Final = (
    "anterior_tibial_translation",
    "distraction",
    "lateral_tibial_translation",
    "flexion",
    "adduction",
    "tibial_external_rotation",
)
#: Table 4.
PAPER_KINEMATICS: Final[Mapping[str, tuple[Printed, ...]]] = {
    "normal gait": (
        (0.06, 0.34), (0.01, 0.06), (0.07, 0.15), (0.00, 0.00), (0.01, 0.06), (0.04, 0.30),
    ),
    "right-turn": (
        (0.12, 0.90), (0.10, 0.62), (0.13, 0.84), (0.09, 0.43), (0.14, 0.72), (0.17, 1.27),
    ),
    "rising from a chair": (
        (0.03, 0.16), (0.01, 0.03), (0.01, 0.08), (0.01, 0.02), (0.01, 0.06), (0.03, 0.14),
    ),
    "squat": (
        (0.02, 0.10), (0.00, 0.01), (0.00, 0.03), (0.00, 0.02), (0.01, 0.02), (0.03, 0.10),
    ),
}  # fmt: skip

#: Table 5.
PAPER_TIMES: Final[Mapping[str, PaperTimes]] = {
    "normal gait": PaperTimes(146, 1.2, 13.6, 4.5, 3.0),
    "right-turn": PaperTimes(187, 1.5, 22.7, 7.3, 3.1),
    "rising from a chair": PaperTimes(1066, 8.8, 70.3, 27.2, 2.6),
    "squat": PaperTimes(1074, 8.9, 96.4, 38.5, 2.5),
}

#: What a printed 0.00 stands for: the value was below half of the last digit.
_PRINTED_ZERO: Final = 0.005
#: Words of an activity's name, the telling ones first: a turn in gait is a turn, a crouched gait is nearest to the
#: squat.
_WORDS: Final = (
    (r"(?<!re)turn", "right-turn"),
    (r"chair", "rising from a chair"),
    (r"squat|crouch", "squat"),
    (r"gait", "normal gait"),
)


def paper_activity(name: str) -> str | None:
    """The paper's activity of the same kind as one of this name, or None where the name does not say."""
    for words, activity in _WORDS:
        if re.search(words, name.lower()):
            return activity
    return None


def printed_error(activity: str | None, quantity: str) -> Printed | None:
    """RMSE and largest error that the paper printed for a quantity.

    Args:
        activity: as PAPER_TIMES names it; None has no printed error.
        quantity: as in the error rows, such as ``medial_Fy`` or ``distraction``.
    """
    if activity is None:
        return None
    if quantity in PAPER_KINEMATICS_COLUMNS:
        return PAPER_KINEMATICS[activity][PAPER_KINEMATICS_COLUMNS.index(quantity)]
    side, _, load = quantity.partition("_")
    if side in SIDES and load in LOAD_COLUMNS:
        return PAPER_LOADS[activity, side][LOAD_COLUMNS.index(load)]
    return None


def activity_comparison(rows: Rows) -> list[dict[str, Any]]:
    """Each error that the paper printed too, beside it. Rows without a single time frame are passed over.

    Args:
        rows: of :func:`condyle.evaluation.simulation_load_error_table` or ``kinematics_error_table``, with ``contact``
            (``surrogate`` where it is missing).

    Returns:
        Rows with ``activity``, ``contact``, ``quantity``, ``unit``, ``measure`` (rmse or max_error), ``value``,
        ``paper_activity``, ``paper`` (as printed) and ``above``: above the printed figure, or not below 0.005
        where 0.00 was printed.
    """
    found = []
    for row in rows:
        known = paper_activity(row["activity"])
        printed = printed_error(known, row["quantity"])
        if printed is None or row["count"] == 0:
            continue
        for measure, paper in zip(("rmse", "max_error"), printed, strict=True):
            if paper is not None:
                cell = {key: row[key] for key in ("activity", "quantity", "unit")}
                cell |= {"contact": row.get("contact", "surrogate"), "measure": measure}
                cell |= {"value": row[measure], "paper_activity": known, "paper": paper}
                found.append(cell | {"above": _above(row[measure], paper)})
    return found


def _above(value: float, paper: float) -> bool:
    # What is not a number is not below anything.
    return not (value <= paper if paper > 0 else value < _PRINTED_ZERO)
