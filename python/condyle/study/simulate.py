# SPDX-License-Identifier: Apache-2.0
"""Load cases of the knee simulator as activities of a study."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from condyle.errors import CondyleError
from condyle.study.activity import Outcome
from condyle.study.context import StudyContext

if TYPE_CHECKING:
    from condyle.activities import LoadCase
    from condyle.contact import ContactModel
    from condyle.fdk import KneeSimulation


@dataclass(frozen=True)
class LoadCaseActivity:
    """A load case: flexion and loads over time, all else from equilibrium.

    Attributes:
        load_case: what is simulated.
        context: the study, with its reference contact and its simulator.
    """

    load_case: LoadCase
    context: StudyContext

    @property
    def name(self) -> str:
        """Of the load case."""
        return self.load_case.name

    def simulate(self, model: ContactModel, contact: str) -> Outcome:
        """As :class:`condyle.study.activity.Activity`."""
        start = time.perf_counter()
        simulation = simulate(model, self.load_case, self.context)
        seconds = time.perf_counter() - start
        require_converged(
            self.name if contact == "reference" else f"{self.name} ({contact})", simulation
        )
        return Outcome(simulation, seconds)


def simulate(model: ContactModel, load_case: LoadCase, context: StudyContext) -> KneeSimulation:
    """The knee simulator over a load case, set up the same for every contact model of the study.

    Start and reference of the restraint springs are where the femur settles on the reference contact.
    """
    from condyle.fdk import (
        KneeSimulatorSettings,
        RestraintSprings,
        default_ligaments,
        settled_pose,
        simulate_knee,
    )

    section = context.study.simulator
    extended = settled_pose(context.reference, 0.0)
    springs = RestraintSprings()
    springs.ap_stiffness = 1e3 * section.ap_stiffness_N_per_mm
    springs.ie_stiffness = math.degrees(section.ie_stiffness_Nm_per_deg)  # per rad
    springs.ml_stiffness = 1e3 * section.ml_stiffness_N_per_mm
    springs.reference_x, springs.reference_z, springs.reference_theta_y = extended[[0, 2, 4]]
    settings = KneeSimulatorSettings()
    settings.insert_width = context.reference.insert_width
    settings.restraint = springs
    if section.ligaments:
        settings.ligaments = default_ligaments(context.study.implant.side_of_body, extended)
    settings.initial_pose = settled_pose(context.reference, float(load_case.flexion[0]))
    return simulate_knee(model, load_case, settings)


def require_converged(activity: str, simulation: KneeSimulation) -> None:
    """Raises CondyleError naming the first time frame that did not converge, its residual and worst coordinate."""
    for i, status in enumerate(simulation.status):
        if status != "converged":
            raise CondyleError(
                f"activity '{activity}': time frame {i} ({simulation.time[i]:.4g} s) is {status}: scaled residual "
                f"{simulation.residual[i]:.3g} (1 is the tolerance), worst in {simulation.worst_coordinate[i]}"
            )
