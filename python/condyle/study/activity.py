# SPDX-License-Identifier: Apache-2.0
"""An activity of a study: something that is simulated with any contact model, and compared."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from condyle.contact import ContactModel


class Simulated(Protocol):
    """What a simulation says of the knee over n time frames; ``condyle.fdk.KneeSimulation`` is one.

    Attributes:
        time: (n,) [s].
        poses: (n, 6) of the femoral frame in the tibial one [m, rad].
        wrenches: (n, 2, 6) medial, lateral: on the femur, at Fo, in T [N, Nm].
        kinematics: (n, 6) clinical [rad, m].
        residual: (n,) the largest, in units of its tolerance.
        worst_coordinate: (n,) where it is.
        status: (n,) ``converged``, or what else.
        evaluations: (n,) of the contact.
        trust: (n,) of the contact model.
    """

    @property
    def time(self) -> NDArray[np.float64]: ...  # noqa: D102
    @property
    def poses(self) -> NDArray[np.float64]: ...  # noqa: D102
    @property
    def wrenches(self) -> NDArray[np.float64]: ...  # noqa: D102
    @property
    def kinematics(self) -> NDArray[np.float64]: ...  # noqa: D102
    @property
    def residual(self) -> NDArray[np.float64]: ...  # noqa: D102
    @property
    def worst_coordinate(self) -> NDArray[np.str_]: ...  # noqa: D102
    @property
    def status(self) -> NDArray[np.str_]: ...  # noqa: D102
    @property
    def evaluations(self) -> NDArray[np.int64]: ...  # noqa: D102
    @property
    def trust(self) -> NDArray[np.float64]: ...  # noqa: D102


@dataclass(frozen=True)
class Outcome:
    """A simulated activity, and what there is to tell beside it.

    Attributes:
        simulated: the knee.
        seconds: wall time of the simulation alone.
        phases: seconds by phase; empty where they are not measured.
        messages: by index of a time frame that is not in equilibrium, what happened.
        files: written beside the one table of every activity.
    """

    simulated: Simulated
    seconds: float
    phases: dict[str, float] = field(default_factory=dict)
    messages: dict[int, str] = field(default_factory=dict)
    files: tuple[Path, ...] = ()

    def unconverged(self, activity: str, contact: str) -> list[dict[str, str | float]]:
        """Rows of the table ``unconverged``, one a time frame that is not in equilibrium."""
        knee = self.simulated
        return [
            {
                "activity": activity,
                "contact": contact,
                "time_s": float(knee.time[i]),
                "status": str(knee.status[i]),
                "worst_coordinate": str(knee.worst_coordinate[i]),
                "message": message,
            }
            for i, message in self.messages.items()
        ]


class Activity(Protocol):
    """A load case of the knee simulator, or a trial of a body."""

    @property
    def name(self) -> str:
        """Unique within the study."""

    def simulate(self, model: ContactModel, contact: str) -> Outcome:
        """Simulates it.

        Args:
            model: the knee's contact.
            contact: its name in files: ``reference``, ``surrogate``, ``hybrid``.

        Raises:
            CondyleError: a load case does not converge; of a trial, hardly a time frame does.
        """
