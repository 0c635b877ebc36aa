# SPDX-License-Identifier: Apache-2.0
"""Recorded trials of a body as activities of a study."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import CondyleError
from condyle.study.activity import Outcome
from condyle.study.body import StudyBody
from condyle.study.body_sections import TrialSection
from condyle.study.run_directory import digest_of_file

if TYPE_CHECKING:
    from condyle.contact import ContactModel
    from condyle.fdk import JointContact, TrialSimulation, TrialSimulationSettings

#: Of a trial's time frames: with fewer in equilibrium something is wrong that no table should hide.
_LEAST_CONVERGED: Final = 0.9


@dataclass(frozen=True)
class TrialKnee:
    """The knee of a simulated trial; see :class:`condyle.study.activity.Simulated`."""

    time: NDArray[np.float64]
    poses: NDArray[np.float64]
    wrenches: NDArray[np.float64]
    kinematics: NDArray[np.float64]
    residual: NDArray[np.float64]
    worst_coordinate: NDArray[np.str_]
    status: NDArray[np.str_]
    evaluations: NDArray[np.int64]
    trust: NDArray[np.float64]


@dataclass(frozen=True)
class TrialActivity:
    """A trial: driven coordinates and loads recorded, secondary ones, muscles and contact from equilibrium.

    Attributes:
        name: of the trial.
        section: where it is recorded.
        body: that went through it.
    """

    name: str
    section: TrialSection
    body: StudyBody

    def simulate(self, model: ContactModel, contact: str) -> Outcome:
        """As :class:`condyle.study.activity.Activity`; all results go to ``simulations/NAME_CONTACT/``."""
        from condyle.fdk import (
            TrialSimulationSettings,
            contact_pressures,
            simulate_trial,
            write_trial_simulation,
        )

        body = self.body
        trial = body.read_trial(self.name, self.section)
        contacts = self._contacts(model, contact)
        settings = TrialSimulationSettings()
        start = time.perf_counter()
        found = simulate_trial(
            body.model, trial, [c.contact for c in contacts], body.muscles, settings
        )
        seconds = time.perf_counter() - start
        converged = sum(record.converged for record in found.records)
        if converged < _LEAST_CONVERGED * len(trial):
            raise CondyleError(f"trial '{self.name}' ({contact}): {found.summary}")
        pressures = {
            c.contact.name: contact_pressures(
                c.reference, found.poses[:, i], threads=body.context.threads
            )
            for i, c in enumerate(contacts)
            if c.reference is not None
        }
        files = write_trial_simulation(
            body.context.directory.simulations / f"{self.name}_{contact}",
            body.model,
            trial,
            found,
            contacts,
            body.muscles,
            settings,
            body.input_files(self.name, self.section),
            pressures,
        )
        return Outcome(
            simulated=_knee(found, self._residuals(found, settings)),
            seconds=seconds,
            phases=found.seconds(),
            messages={i: r.message for i, r in enumerate(found.records) if not r.converged},
            files=tuple(files),
        )

    def _contacts(self, model: ContactModel, contact: str) -> list[JointContact]:
        from condyle.fdk import BodyContact, JointContact
        from condyle.fdk.joint_contacts import TIBIOFEMORAL, ContactKind

        body = self.body
        joint = body.joint
        kind: ContactKind = body.context.study.contact.evaluation
        if contact != "reference":
            kind = "hybrid" if contact == "hybrid" else "surrogate"
        knee = JointContact(
            contact=BodyContact.between(
                TIBIOFEMORAL, model, body.surfaces, joint.femur, joint.insert, body.side_of_body
            ),
            kind=kind,
            reference=body.context.reference,
            identity=self._identity(contact),
        )
        return [knee] if body.patella is None else [knee, body.patella]

    def _identity(self, contact: str) -> dict[str, Any]:
        """The knee's contact by content."""
        from condyle.fdk.joint_contacts import TIBIOFEMORAL

        context = self.body.context
        found = {"name": TIBIOFEMORAL, "contact": contact, **context.identity()}
        if contact != "reference":
            file = context.directory.surrogate
            found["surrogate"] = {"name": file.name, "sha256": digest_of_file(file)}
        return found

    def _residuals(
        self, found: TrialSimulation, settings: TrialSimulationSettings
    ) -> NDArray[np.float64]:
        from condyle.fdk.simulation_summary import scaled_residuals

        return scaled_residuals(self.body.model, found, settings)


def _knee(found: TrialSimulation, scaled: NDArray[np.float64]) -> TrialKnee:
    from condyle.fdk.joint_contacts import TIBIOFEMORAL

    knee = found.contact(TIBIOFEMORAL)
    records = found.records
    # In equilibrium is what counts here; what is implausibly deep stands in the trial's own record.
    status = ["converged" if record.converged else record.status for record in records]
    return TrialKnee(
        time=found.times,
        poses=found.poses[:, knee],
        wrenches=found.wrenches[:, knee],
        kinematics=found.kinematics(TIBIOFEMORAL),
        residual=scaled,
        worst_coordinate=np.array([record.worst_coordinate for record in records], dtype=np.str_),
        status=np.array(status, dtype=np.str_),
        evaluations=np.array([record.evaluations for record in records], dtype=np.int64),
        trust=found.trust[:, knee],
    )
