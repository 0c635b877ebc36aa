# SPDX-License-Identifier: Apache-2.0
"""What sampling asks of a static equilibrium solver, and what it gets back.

Sampling knows no contact model: it hands over prescribed values and takes poses and wrenches. So
any solver can stand here, the reference contact's (:mod:`condyle.sampling.evaluate`) or a closed
form in a test.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import POSE_COLUMNS
from condyle.errors import CondyleError, InputDataError

#: The six sampled variables, in the paper's order: the pose in the non-sensitive directions, the
#: loads in the sensitive ones (y → Fy, θx → Mx).
PRESCRIBED_COLUMNS: Final = ("x", "Fy", "z", "Mx", "theta_y", "theta_z")

#: Prescribed instead of Fy and Mx where the sensitive directions' pose is known.
SENSITIVE_COLUMNS: Final = ("y", "theta_x")
GIVEN_COLUMNS: Final = (*PRESCRIBED_COLUMNS, *SENSITIVE_COLUMNS)

#: A solver's answers. All but the first reject the candidate.
CONVERGED: Final = "converged"
SOLVER_STATUSES: Final = (CONVERGED, "no_equilibrium", "overclosure", "off_insert", "not_converged")


def _not_given() -> NDArray[np.float64]:
    return np.full(1, np.nan)


@dataclass(frozen=True)
class Prescribed:
    """Static equilibria to solve, n of them; each field is (n,).

    x, z [m] and θy, θz [rad] of the pose; Fy [N] and Mx [Nm] of the contact wrench on the femur,
    summed over the sides. Instead of Mx a tilt θx [rad] may be prescribed, and then instead of Fy a
    height y [m] as well (nothing is left to solve); what is not prescribed is NaN, in all rows
    alike.
    """

    x: NDArray[np.float64]
    Fy: NDArray[np.float64]
    z: NDArray[np.float64]
    Mx: NDArray[np.float64]
    theta_y: NDArray[np.float64]
    theta_z: NDArray[np.float64]
    y: NDArray[np.float64] = field(default_factory=_not_given)
    theta_x: NDArray[np.float64] = field(default_factory=_not_given)

    def __post_init__(self) -> None:
        """Every field becomes a contiguous float64 vector of one length.

        Raises:
            InputDataError: Lengths differ, or rows differ in what is prescribed.
        """
        count = len(np.atleast_1d(self.x))
        for item in fields(self):
            vector = np.ascontiguousarray(getattr(self, item.name), dtype=np.float64)
            if item.name in SENSITIVE_COLUMNS and vector.shape == (1,) and np.isnan(vector[0]):
                vector = np.full(count, np.nan)
            if vector.ndim != 1 or len(vector) != count:
                raise InputDataError(
                    f"prescribed {item.name} has shape {vector.shape}; "
                    f"({np.size(self.x)},) is needed, as x has"
                )
            object.__setattr__(self, item.name, vector)
        for name in SENSITIVE_COLUMNS:
            missing = np.isnan(getattr(self, name))
            if missing.any() and not missing.all():
                row = int(np.argmax(missing))
                raise InputDataError(
                    f"prescribed {name} is NaN in row {row} and not in all; "
                    "prescribe it in every row or in none"
                )
        if self.pose_given and not self.theta_x_given:
            raise InputDataError("prescribed y is given and theta_x is not; y needs theta_x")

    def __len__(self) -> int:
        """How many."""
        return len(self.x)

    @property
    def theta_x_given(self) -> bool:
        """Whether θx is prescribed, not Mx."""
        return len(self) > 0 and not np.isnan(self.theta_x[0])

    @property
    def pose_given(self) -> bool:
        """Whether the whole pose is prescribed, and no load."""
        return len(self) > 0 and not np.isnan(self.y[0])

    @classmethod
    def from_array(cls, values: NDArray[np.float64]) -> Prescribed:
        """From (n, 6) in the order of PRESCRIBED_COLUMNS."""
        return cls.from_columns(values, PRESCRIBED_COLUMNS)

    @classmethod
    def from_columns(cls, values: NDArray[np.float64], columns: Sequence[str]) -> Prescribed:
        """From (n, d) in the order of ``columns``, out of GIVEN_COLUMNS; the rest is not prescribed."""
        given = dict(zip(columns, values.T, strict=True))
        nothing = np.full(len(values), np.nan)
        return cls(**{name: given.get(name, nothing) for name in GIVEN_COLUMNS})

    @classmethod
    def from_poses(cls, poses: NDArray[np.float64]) -> Prescribed:
        """Poses (n, 6) to evaluate."""
        columns = dict(zip(POSE_COLUMNS, poses.T, strict=True))
        nothing = np.full(len(poses), np.nan)
        return cls(**{name: columns.get(name, nothing) for name in GIVEN_COLUMNS})

    def to_array(self) -> NDArray[np.float64]:
        """(n, 6) in the order of PRESCRIBED_COLUMNS."""
        return np.column_stack([getattr(self, name) for name in PRESCRIBED_COLUMNS])

    def to_poses(self) -> NDArray[np.float64]:
        """(n, 6) poses; NaN where a coordinate is solved for."""
        return np.column_stack([getattr(self, name) for name in POSE_COLUMNS])

    def select(self, rows: NDArray[np.bool_] | slice) -> Prescribed:
        """The chosen rows."""
        return Prescribed(**{name: getattr(self, name)[rows] for name in GIVEN_COLUMNS})


@dataclass(frozen=True)
class Solved:
    """A solver's answer to n prescribed equilibria.

    Attributes:
        poses: (n, 6) [m, rad].
        wrenches: (n, 2, 6) on the femur at Fo, expressed in T, sides (medial, lateral) [N, Nm].
        status: (n,) names out of SOLVER_STATUSES; poses and wrenches mean something where it is
            ``converged``.
        evaluations: (n,) contact evaluations spent.
        max_depth: (n,) greatest penetration [m], where the solver knows it.
    """

    poses: NDArray[np.float64]
    wrenches: NDArray[np.float64]
    status: NDArray[np.str_]
    evaluations: NDArray[np.int64]
    max_depth: NDArray[np.float64] | None = None


StaticEquilibriumSolver = Callable[[Prescribed], Solved]


def check_solved(solved: Solved, count: int) -> None:
    """Refuse an answer that does not have the promised shapes and status names.

    Raises:
        CondyleError: The solver does not keep to the protocol; the message names the field.
    """
    shapes = {
        "poses": (count, 6),
        "wrenches": (count, 2, 6),
        "status": (count,),
        "evaluations": (count,),
    }
    if solved.max_depth is not None:
        shapes["max_depth"] = (count,)
    for name, shape in shapes.items():
        got = np.shape(getattr(solved, name))
        if got != shape:
            raise CondyleError(
                f"the static equilibrium solver returned {name} of shape {got}; "
                f"{shape} was expected"
            )
    unknown = sorted(set(np.asarray(solved.status).tolist()) - set(SOLVER_STATUSES))
    if unknown:
        raise CondyleError(
            f"the static equilibrium solver returned status {unknown[0]!r}; "
            f"known are {', '.join(SOLVER_STATUSES)}"
        )
