# SPDX-License-Identifier: Apache-2.0
"""Force-dependent kinematics of a trial: secondary knee kinematics, muscle, ligament and contact forces at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle._core import common as _common
from condyle._core import fdk as _fdk
from condyle.errors import InputDataError
from condyle.fdk.body_contact import BodyContact
from condyle.model import MuscleSettings, MusculoskeletalModel, Trial

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TimeFrameRecord:
    """What became of a time frame.

    Attributes:
        status: ``converged``, ``not_converged``, ``recruitment_failed`` (muscles cannot carry the loads) or
            ``implausible_depth`` (in equilibrium, but too deep).
        message: the same in words, with coordinate, residual and what to do.
        approach: which way led there: ``start``, ``substeps``, ``softer_contact``, ``uncoupled``, ``from_other_side``.
        worst_coordinate: of the largest residual in units of its tolerance.
        residual: (a,) net generalised force on the force-dependent coordinates [N, Nm].
        history: largest residual in units of its tolerance, before each Newton step and at the end.
        iterations: Newton steps, of all attempts.
        evaluations: of the equilibrium, and so of every contact.
        substeps: of continuation in time.
        remaining: (m, rad) largest Newton step that is left.
        attainable: (N, Nm) what rounding alone leaves: no tolerance below can be met.
        least_trust: of the contact models.
        sharing_settled: false: the last change of how muscles share still moved the residual.
        seconds: by phase; differs from run to run.
    """

    status: str
    message: str
    approach: str
    worst_coordinate: str
    residual: Array
    history: tuple[float, ...]
    iterations: int
    evaluations: int
    substeps: int
    remaining: tuple[float, float]
    attainable: tuple[float, float]
    least_trust: float
    sharing_settled: bool
    seconds: dict[str, float]

    @property
    def converged(self) -> bool:
        """In equilibrium, with muscles that carry the loads."""
        return self.status in ("converged", "implausible_depth")


@dataclass(frozen=True)
class TrialSimulation:
    """Results, one row a time frame.

    T time frames, n coordinates, a force-dependent ones, b bodies, c contacts, m muscles, s ligaments, k coordinates
    that muscles balance.

    Attributes:
        times: (T,) [s].
        force_dependent: (a,) names of the coordinates that were solved for.
        contacts: the c contacts, as given.
        q: (T, n) with the force-dependent coordinates as solved [rad, m].
        rotations: (T, b, 3, 3) of the bodies: components in the body to components in ground.
        positions: (T, b, 3) of the bodies' origins in ground [m].
        poses: (T, c, 6) of F in T [m, rad].
        wrenches: (T, c, 2, 6) medial, lateral: on F, at Fo, in T [N, Nm].
        errors: (T, c, 2, 6) the models' 95 % bounds [N, Nm].
        trust: (T, c).
        contact_loads: (T, n) generalised forces of all contacts [Nm, N].
        generalised_forces: (T, n) of inverse dynamics [Nm, N].
        ligament_loads: (T, n) generalised forces of the ligaments [Nm, N].
        spring_loads: (T, n) those of coordinate springs [Nm, N].
        residuals: (T, n) what nothing gives of the generalised forces: near 0 where solved for [Nm, N].
        muscle_lengths: (T, m) [m].
        muscle_strengths: (T, m) [N].
        passive_forces: (T, m) [N].
        muscle_forces: (T, m) active and passive [N].
        activities: (T, m) active force over strength.
        reserves: (T, k) [Nm, N].
        balanced: (k,) names of the coordinates that muscles balance.
        ligament_lengths: (T, s) [m].
        ligament_strains: (T, s).
        ligament_forces: (T, s) [N].
        records: T of them.
        not_converged: how many time frames are not in equilibrium.
        implausible: how many overlap deeper than plausible.
        untrusted: in how many a contact model does not trust itself.
        summary: one line for people.
    """

    times: Array
    force_dependent: tuple[str, ...]
    contacts: tuple[BodyContact, ...]
    q: Array
    rotations: Array
    positions: Array
    poses: Array
    wrenches: Array
    errors: Array
    trust: Array
    contact_loads: Array
    generalised_forces: Array
    ligament_loads: Array
    spring_loads: Array
    residuals: Array
    muscle_lengths: Array
    muscle_strengths: Array
    passive_forces: Array
    muscle_forces: Array
    activities: Array
    reserves: Array
    balanced: tuple[str, ...]
    ligament_lengths: Array
    ligament_strains: Array
    ligament_forces: Array
    records: tuple[TimeFrameRecord, ...]
    not_converged: int
    implausible: int
    untrusted: int
    summary: str

    @property
    def converged(self) -> bool:
        """Every time frame is in equilibrium."""
        return self.not_converged == 0

    def contact(self, name: str) -> int:
        """Index of a contact.

        Raises:
            InputDataError: there is none of that name.
        """
        names = [contact.name for contact in self.contacts]
        if name not in names:
            raise InputDataError(f"no contact {name!r}; there are {names}")
        return names.index(name)

    def kinematics(self, contact: str) -> Array:
        """(T, 6) clinical kinematics of a contact's F in T (Grood and Suntay 1983).

        Returns:
            Flexion, adduction, tibial external rotation [rad], anterior tibial translation, distraction, lateral tibial
            translation [m].
        """
        c = self.contact(contact)
        side = _common.side_of_body(self.contacts[c].side_of_body)
        return np.asarray(_common.clinical_kinematics(np.ascontiguousarray(self.poses[:, c]), side))

    def seconds(self) -> dict[str, float]:
        """Seconds by phase, of all time frames."""
        total: dict[str, float] = {}
        for record in self.records:
            for phase, seconds in record.seconds.items():
                total[phase] = total.get(phase, 0.0) + seconds
        return total


def simulate_trial(
    model: MusculoskeletalModel,
    trial: Trial,
    contacts: Sequence[BodyContact],
    muscles: MuscleSettings | None = None,
    settings: _fdk.TrialSimulationSettings | None = None,
    *,
    starts: Array | None = None,
) -> TrialSimulation:
    """Finds the force-dependent coordinates of every time frame, with all forces in equilibrium.

    Time frames are solved forward with warm starts. One that does not converge is kept with its residual and its worst
    coordinate, and counted. The same bytes for any number of threads.

    Args:
        model: with force-dependent coordinates.
        trial: its motion and loads; the force-dependent coordinates of ``trial.q`` serve as starts only.
        contacts: what touches what.
        muscles: how muscles share load; cubed activities if not given.
        settings: tolerances, steps, continuation, chunks, threads; ``settings.muscles`` is overruled by ``muscles``.
        starts: (1 or T, a) where to begin: of the first time frame, or of each. None: the first contact is seated.

    Raises:
        ValueError: Inputs that do not fit, by name and value; a contact model of the other side of the body.
            Numerics that do not work out are a status.
    """
    settings = settings or _fdk.TrialSimulationSettings()
    settings.muscles = (muscles or MuscleSettings()).core()
    given = np.zeros((0, 0)) if starts is None else np.atleast_2d(starts)
    found = _fdk.simulate_trial(
        model.core,
        trial.q,
        trial.qd,
        trial.qdd,
        trial.loads,
        list(trial.load_bodies),
        trial.snapshots,
        list(trial.snapshot_rows),
        [contact.core() for contact in contacts],
        np.ascontiguousarray(given, dtype=np.float64),
        settings,
    )
    t, c = len(trial), len(contacts)
    segments = found.segment_poses.reshape(t, -1, 12)
    return TrialSimulation(
        times=trial.times,
        force_dependent=tuple(model.coordinate_names[i] for i in found.force_dependent),
        contacts=tuple(contacts),
        q=found.q,
        rotations=segments[:, :, :9].reshape(t, -1, 3, 3),
        positions=segments[:, :, 9:],
        poses=found.contact_poses.reshape(t, c, 6),
        wrenches=found.contact_wrenches.reshape(t, c, 2, 6),
        errors=found.contact_errors.reshape(t, c, 2, 6),
        trust=found.contact_trust,
        contact_loads=found.contact_loads,
        generalised_forces=found.generalised_forces,
        ligament_loads=found.ligament_loads,
        spring_loads=found.spring_loads,
        residuals=found.residuals,
        muscle_lengths=found.muscle_lengths,
        muscle_strengths=found.muscle_strengths,
        passive_forces=found.passive_forces,
        muscle_forces=found.muscle_forces,
        activities=found.activities,
        reserves=found.reserves,
        balanced=model.balanced_by_muscles,
        ligament_lengths=found.ligament_lengths,
        ligament_strains=found.ligament_strains,
        ligament_forces=found.ligament_forces,
        records=tuple(_record(record) for record in found.records),
        not_converged=found.not_converged,
        implausible=found.implausible,
        untrusted=found.untrusted,
        summary=found.summary,
    )


def _record(record: _fdk.ForceDependentRecord) -> TimeFrameRecord:
    return TimeFrameRecord(
        status=record.status,
        message=record.message,
        approach=record.approach,
        worst_coordinate=record.worst_coordinate,
        residual=record.residual,
        history=tuple(record.history),
        iterations=record.iterations,
        evaluations=record.evaluations,
        substeps=record.substeps,
        remaining=(record.remaining_m, record.remaining_rad),
        attainable=(record.attainable_force, record.attainable_moment),
        least_trust=record.least_trust,
        sharing_settled=record.sharing_settled,
        seconds=dict(record.seconds),
    )
