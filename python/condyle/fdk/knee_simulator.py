# SPDX-License-Identifier: Apache-2.0
"""The knee simulator: a load case in, kinematics and contact loads out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle._core import fdk as _fdk
from condyle._core.contact import ContactModel
from condyle.activities import LoadCase
from condyle.conventions import POSE_COLUMNS
from condyle.errors import CondyleError, InputDataError


@dataclass(frozen=True)
class KneeSimulation:
    """A simulated load case over n time frames.

    Attributes:
        name: Of the load case.
        time: (n,) [s].
        poses: (n, 6) [m, rad].
        wrenches: (n, 2, 6) contact wrench per side, on the femur at Fo, expressed in T [N, Nm].
        kinematics: (n, 6) clinical: flexion, adduction, tibial external rotation [rad], anterior tibial translation,
            distraction, lateral tibial translation [m].
        residuals: (n, 5) net generalised force on x, y, z, theta_x, theta_y [N, Nm].
        residual: (n,) the largest of them in units of its tolerance; at most 1 where converged.
        worst_coordinate: (n,) which one it is.
        status: (n,) names: converged, not_converged, implausible_depth (in equilibrium, but too deep).
        iterations: (n,) Newton steps.
        evaluations: (n,) contact evaluations.
        substeps: (n,) of continuation; 1 where the time frame was solved straight away.
        trust: (n,) of the contact model; below 0.5 do not use.
        restraint: The springs as used, references filled in.
        axial_offset: Of the axial line, medial of To [m].
        summary: One line for people.
    """

    name: str
    time: NDArray[np.float64]
    poses: NDArray[np.float64]
    wrenches: NDArray[np.float64]
    kinematics: NDArray[np.float64]
    residuals: NDArray[np.float64]
    residual: NDArray[np.float64]
    worst_coordinate: NDArray[np.str_]
    status: NDArray[np.str_]
    iterations: NDArray[np.int64]
    evaluations: NDArray[np.int64]
    substeps: NDArray[np.int64]
    trust: NDArray[np.float64]
    restraint: _fdk.RestraintSprings
    axial_offset: float
    summary: str

    @property
    def converged(self) -> bool:
        """True if every time frame is in equilibrium."""
        return not bool(np.any(self.status == "not_converged"))


def simulate_knee(
    model: ContactModel,
    load_case: LoadCase,
    settings: _fdk.KneeSimulatorSettings | None = None,
) -> KneeSimulation:
    """Simulates a load case.

    Args:
        model: Any contact model with stiffness.
        load_case: From :func:`condyle.activities.load_case`, or made by hand.
        settings: The defaults are an ISO-like simulator with restraint springs; set ``insert_width`` to the implant's.

    Raises:
        InputDataError: The load case or a setting is out of range. A time frame that does not converge is a status.
    """
    settings = settings or _fdk.KneeSimulatorSettings()
    try:
        result = _fdk.simulate_knee(
            model,
            load_case.time,
            load_case.flexion,
            load_case.axial_force,
            load_case.ap_force,
            load_case.ie_torque,
            settings,
        )
    except ValueError as error:
        raise InputDataError(f"activity '{load_case.name}': {error}") from error
    force, moment = settings.newton.force_tolerance, settings.newton.moment_tolerance
    residuals = result.residuals
    return KneeSimulation(
        name=load_case.name,
        time=load_case.time,
        poses=result.poses,
        wrenches=result.wrenches,
        kinematics=result.kinematics,
        residuals=residuals,
        residual=np.max(np.abs(residuals) / [force, force, force, moment, moment], axis=1),
        worst_coordinate=np.array(
            [POSE_COLUMNS[i] for i in result.worst_coordinate], dtype=np.str_
        ),
        status=np.array([_fdk.FrameStatus(int(s)).text for s in result.status], dtype=np.str_),
        iterations=result.iterations,
        evaluations=result.evaluations,
        substeps=result.substeps,
        trust=result.trust,
        restraint=result.restraint,
        axial_offset=float(result.axial_offset),
        summary=result.summary,
    )


def settled_pose(
    model: ContactModel, flexion: float = 0.0, settings: _fdk.SettleSettings | None = None
) -> NDArray[np.float64]:
    """Where the femur rests at a flexion [rad], rotations zero, under a light axial force.

    Returns:
        The pose (6,) [m, rad].

    Raises:
        InputDataError: ``flexion`` is not finite, or a setting is out of range.
        CondyleError: No contact was found below, or the femur does not come to rest on it.
    """
    try:
        settled = _fdk.settled_pose(model, flexion, settings or _fdk.SettleSettings())
    except ValueError as error:
        raise InputDataError(str(error)) from error
    if not settled.converged:
        what = (
            "does not come to rest on the insert"
            if settled.touched
            else "touches the insert nowhere"
        )
        raise CondyleError(f"settled pose at {flexion:.4g} rad of flexion: the femur {what}")
    return np.asarray(settled.pose)
