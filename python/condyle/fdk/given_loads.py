# SPDX-License-Identifier: Apache-2.0
"""Force-dependent kinematics on the loads, moment arms and strengths of a simulator of one's own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import common as _common
from condyle._core import fdk as _fdk
from condyle._core import recruitment as _recruitment
from condyle._core.contact import ContactModel
from condyle.conventions import POSE_COLUMNS, SideOfBody
from condyle.errors import InputDataError
from condyle.recruitment import Criterion, Reserves

Floats = NDArray[np.float64]
#: The secondary coordinates, in the order of every axis of five.
SECONDARY_COLUMNS = POSE_COLUMNS[:5]


@dataclass(frozen=True)
class GivenLoadsSimulation:
    """Equilibria under given loads: t time frames, n balanced coordinates, m muscles, k ligaments.

    Attributes:
        poses: (t, 6) [m, rad]; the last iterate where not converged.
        wrenches: (t, 2, 6) contact wrench per side, on the femur at Fo, expressed in T [N, Nm].
        kinematics: (t, 6) clinical: flexion, adduction, tibial external rotation [rad], anterior tibial translation,
            distraction, lateral tibial translation [m].
        muscle_forces: (t, m) [N].
        activities: (t, m) force by strength.
        reserves: (t, n) forces of the reserves [Nm, N].
        unmet: (t, n) loads less all that acts on the balanced coordinates [Nm, N].
        ligament_tensions: (t, k) [N].
        residuals: (t, 5) net generalised force on x, y, z, theta_x, theta_y [N, Nm].
        residual: (t,) the largest of them in units of its tolerance; at most 1 where in equilibrium.
        worst_coordinate: (t,) which one it is.
        status: (t,) names: converged, not_converged, infeasible (muscles cannot balance the loads),
            implausible_depth (in equilibrium, but too deep).
        messages: One a time frame: what went wrong, with names; empty where converged.
        iterations: (t,) Newton steps.
        evaluations: (t,) contact evaluations.
        substeps: (t,) of continuation; 1 where the time frame was solved straight away.
        trust: (t,) of the contact model; below 0.5 do not use.
        summary: One line for people.
    """

    poses: Floats
    wrenches: Floats
    kinematics: Floats
    muscle_forces: Floats
    activities: Floats
    reserves: Floats
    unmet: Floats
    ligament_tensions: Floats
    residuals: Floats
    residual: Floats
    worst_coordinate: NDArray[np.str_]
    status: NDArray[np.str_]
    messages: tuple[str, ...]
    iterations: NDArray[np.int64]
    evaluations: NDArray[np.int64]
    substeps: NDArray[np.int64]
    trust: Floats
    summary: str

    @property
    def converged(self) -> bool:
        """True if every time frame is in equilibrium, with muscles that can."""
        return not bool(np.any((self.status == "not_converged") | (self.status == "infeasible")))


def solve_given_loads(
    contact: ContactModel,
    side_of_body: SideOfBody,
    *,
    flexion: ArrayLike,
    loads: ArrayLike,
    moment_arms: ArrayLike,
    strengths: ArrayLike,
    secondary_arms: ArrayLike,
    secondary_loads: ArrayLike | None = None,
    wrench: ArrayLike | None = None,
    knee_coordinate: int | str | None = None,
    knee_counts_flexion: bool = True,
    ligaments: Sequence[_fdk.Ligament] = (),
    restraint: _fdk.RestraintSprings | None = None,
    minima: ArrayLike | None = None,
    arms_by_pose: ArrayLike | None = None,
    arms_at: ArrayLike | None = None,
    criterion: Criterion = 3.0,
    upper_bounds: bool = True,
    weights: ArrayLike | None = None,
    reserves: Reserves | None = None,
    coordinate_names: Sequence[str] = (),
    muscle_names: Sequence[str] = (),
    settings: _fdk.GivenLoadsSettings | None = None,
) -> GivenLoadsSimulation:
    """Finds secondary knee coordinates, muscle and contact forces in equilibrium with given loads.

    Time frames are solved one after another, each from the one before; the first from the seated pose.
    On the n coordinates muscles balance the loads (less what contact and ligaments give on knee flexion); on x, y,
    z, theta_x, theta_y of the knee, muscles, ligaments and contact together give the secondary loads.
    Moment arms are generalised forces per newton, r = -dL/dq, the other coordinates held.
    What inputs mean: docs/fdk_library.md.

    Args:
        contact: Any contact model with stiffness.
        side_of_body: Of the loads; the contact model's must be the same.
        flexion: (t,) knee flexion, -theta_z [rad].
        loads: (t, n) what inverse dynamics asks of the n coordinates [Nm, N].
        moment_arms: (t, n, m) about them [m, -].
        strengths: (t, m), or (m,) for all time frames [N].
        secondary_arms: (t, 5, m) about x, y, z, theta_x, theta_y [-, m].
        secondary_loads: (t, 5) what inverse dynamics asks of them, muscles, ligaments and contact not taken
            off [N, Nm].
        wrench: (t, 6) the same as a wrench on the femur at Fo, in T; what both are given is added.
        knee_coordinate: Which of the n is knee flexion, by position or name; None: none is.
        knee_counts_flexion: Whether that coordinate is flexion, or extension (theta_z).
        ligaments: Bundles between femur and tibia.
        restraint: Springs on x, z and theta_y for soft tissue that the ligaments leave out; references that are not
            set count as 0.
        minima: (t, m) or (m,) passive muscle forces [N]; all 0 where None.
        arms_by_pose: (t, 5, n + 5, m) d arms / d (x, y, z, theta_x, theta_y), rows the n and then the five;
            None: arms are constant over the secondary motion.
        arms_at: (t, 5) the secondary coordinates at which arms hold; needed with ``arms_by_pose``.
        criterion: Of recruitment: exponent p >= 1, or ``"min_max"``.
        upper_bounds: Whether no muscle exceeds its strength.
        weights: (m,) more than 0; all 1 where None.
        reserves: Actuators that help on the n coordinates, or None.
        coordinate_names: n, for messages.
        muscle_names: m, for messages.
        settings: Newton's, seating, continuation; its ``recruitment`` is overruled by what is given here.

    Raises:
        InputDataError: Shapes do not fit, a value is not finite, or the contact model is of the other knee. A time
            frame that does not converge is a status.
    """
    arms = _array("moment_arms", moment_arms, 3)
    t, n, m = arms.shape
    if t == 0:
        raise InputDataError("given loads: there are no time frames")
    names = list(coordinate_names)
    setup = _setup(n, m, names, list(muscle_names), weights, reserves)
    if (arms_by_pose is None) != (arms_at is None):
        raise InputDataError("given loads: give arms_by_pose and arms_at, or neither")
    settings = settings or _fdk.GivenLoadsSettings()
    settings.recruitment = _recruitment_settings(criterion, upper_bounds)
    derivatives = np.zeros((0, 5, n + 5, m)) if arms_by_pose is None else arms_by_pose
    by_pose = _array("arms_by_pose", derivatives, 4)
    try:
        given = _fdk.GivenLoads(
            _array("flexion", flexion, 1),
            _array("loads", loads, 2),
            _array_or("secondary_loads", secondary_loads, (t, 5)),
            _array_or("wrench", wrench, (t, 6)),
            arms,
            _array("secondary_arms", secondary_arms, 3),
            _rows("strengths", strengths, t, m),
            _rows("minima", np.zeros((0, m)) if minima is None else minima, t, m),
            by_pose.reshape(len(by_pose), by_pose.shape[1] * by_pose.shape[2], by_pose.shape[3]),
            _array_or("arms_at", arms_at, (t, 5)),
        )
        found = _fdk.solve_given_loads(
            contact,
            _common.side_of_body(side_of_body),
            setup,
            _position(knee_coordinate, names, n),
            knee_counts_flexion,
            list(ligaments),
            restraint,
            given,
            settings,
        )
    except ValueError as error:
        raise InputDataError(str(error)) from error
    return _simulation(found, settings.newton)


def _simulation(
    found: _fdk.GivenLoadsSimulation, newton: _fdk.NewtonSettings
) -> GivenLoadsSimulation:
    force, moment = newton.force_tolerance, newton.moment_tolerance
    residuals = found.residuals
    worst = [POSE_COLUMNS[i] for i in found.worst_coordinate]
    return GivenLoadsSimulation(
        poses=found.poses,
        wrenches=found.wrenches.reshape(-1, 2, 6),
        kinematics=found.kinematics,
        muscle_forces=found.muscle_forces,
        activities=found.activities,
        reserves=found.reserves,
        unmet=found.unmet,
        ligament_tensions=found.ligament_tensions,
        residuals=residuals,
        residual=np.max(np.abs(residuals) / [force, force, force, moment, moment], axis=1),
        worst_coordinate=np.array(worst, dtype=np.str_),
        status=np.array(found.status, dtype=np.str_),
        messages=tuple(found.messages),
        iterations=found.iterations,
        evaluations=found.evaluations,
        substeps=found.substeps,
        trust=found.trust,
        summary=found.summary,
    )


def _setup(
    n: int,
    m: int,
    coordinate_names: list[str],
    muscle_names: list[str],
    weights: ArrayLike | None,
    reserves: Reserves | None,
) -> _recruitment.RecruitmentSetup:
    setup = _recruitment.RecruitmentSetup()
    setup.coordinates, setup.muscles = n, m
    setup.coordinate_names, setup.muscle_names = coordinate_names, muscle_names
    if weights is not None:
        setup.weights = _array("weights", weights, 1)
    if reserves is not None:
        setup.reserve_strengths = _one_each("reserves.strengths", reserves.strengths, n)
        setup.reserve_prices = _one_each("reserves.prices", reserves.prices, n)
    return setup


def _recruitment_settings(
    criterion: Criterion, upper_bounds: bool
) -> _recruitment.RecruitmentSettings:
    settings, asked = _recruitment.RecruitmentSettings(), _recruitment.Criterion()
    if isinstance(criterion, str):
        if criterion != "min_max":
            raise InputDataError(
                f"given loads: criterion {criterion!r}: must be 'min_max' or a number"
            )
        asked.min_max = True
    else:
        asked.exponent = float(criterion)
    settings.criterion = asked
    settings.upper_bounds = upper_bounds
    return settings


def _position(coordinate: int | str | None, names: list[str], n: int) -> int:
    if coordinate is None:
        return -1
    if isinstance(coordinate, str):
        if coordinate not in names:
            raise InputDataError(
                f"given loads: knee_coordinate '{coordinate}' is not among coordinate_names {names}"
            )
        return names.index(coordinate)
    if not 0 <= coordinate < n:
        raise InputDataError(
            f"given loads: knee_coordinate is {coordinate}: must be 0 to {n - 1}, or None"
        )
    return coordinate


def _array(field: str, values: ArrayLike, dimensions: int) -> Floats:
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputDataError(f"given loads: {field} is not an array of numbers: {error}") from error
    if array.ndim != dimensions:
        raise InputDataError(
            f"given loads: {field} has shape {array.shape}; {dimensions} dimensions are needed"
        )
    return array


def _array_or(field: str, values: ArrayLike | None, shape: tuple[int, int]) -> Floats:
    return np.zeros(shape) if values is None else _array(field, values, 2)


def _rows(field: str, values: ArrayLike, t: int, m: int) -> Floats:
    array = np.asarray(values, dtype=np.float64)
    if array.shape == (m,):
        array = np.tile(array, (t, 1))
    return _array(field, array, 2)


def _one_each(field: str, values: ArrayLike, n: int) -> Floats:
    return np.full(n, float(values)) if np.ndim(values) == 0 else _array(field, values, 1)  # type: ignore[arg-type]
