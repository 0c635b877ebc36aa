# SPDX-License-Identifier: Apache-2.0
"""How far an implant's own shape lets the femur go, by flexion: bounds where no curve says it.

At each flexion the femur settles in the insert (:func:`condyle.fdk.settled_pose`). From there it is
moved in x, z and θy, one at a time, under loads that instrumented knees have measured, y and θx
found from equilibrium each time. A bound is where the first of these ends it:

- an equilibrium under one of the loads is no longer found: the femur would leave the insert, lift a
  side off that is to carry, or sink in too deep;
- the contact resists (or helps on) with more force than the rest of a knee is known to balance: the
  published peaks of shear and torque, under the load of walking;
- the travel of a lax knee is used up: what bounds a flat insert.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle.contact import ContactModel
from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS
from condyle.errors import CondyleError, InputDataError
from condyle.fdk import settled_pose
from condyle.sampling.conformity_settings import ConformitySettings
from condyle.sampling.equilibrium_protocol import (
    CONVERGED,
    Prescribed,
    Solved,
    StaticEquilibriumSolver,
)
from condyle.sampling.lift_off import lift_off_angles

#: Coordinates that are moved, in the order of every array of bounds here.
MOVED: Final = ("x", "z", "theta_y")
#: Load under which the sides' lever arms are measured [N]: both are well in contact, neither deep.
_ARM_LOAD: Final = 100.0
#: Steps to the end of a travel.
_STEPS: Final = 10
#: Highest loads tried, as shares of the one asked for, until the settled femur bears one.
_LOAD_SHARES: Final = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5)


@dataclass(frozen=True)
class ConformityBounds:
    """What an implant bears, at n flexions.

    Attributes:
        settled: (n, 6) where the femur rests, rotations but θz zero [m, rad].
        offsets: (n, 3, 2) lowest and highest offset from there by MOVED [m, m, rad].
        lift_off: (n, 2) θx between which both sides carry a light load [rad].
        arms: (n, 2) Mx over Fy of each side (medial, lateral) when it carries alone [m].
        loads: (n, 4, 2) Fy [N] and Mx [Nm] of the four load patterns: light and walking at the
            middle medial share, highest at the least and at the greatest.
    """

    settled: NDArray[np.float64]
    offsets: NDArray[np.float64]
    lift_off: NDArray[np.float64]
    arms: NDArray[np.float64]
    loads: NDArray[np.float64]

    def to_json(self) -> list[dict[str, Any]]:
        """A row for each flexion, in mm, degrees and N."""
        scale = np.array([1e3, 1e3, 180 / np.pi])
        return [
            {
                "flexion_deg": -float(np.degrees(self.settled[i, 5])),
                "settled_x_mm": 1e3 * float(self.settled[i, 0]),
                "settled_z_mm": 1e3 * float(self.settled[i, 2]),
                "x_mm": (scale[0] * self.offsets[i, 0]).tolist(),
                "z_mm": (scale[1] * self.offsets[i, 1]).tolist(),
                "theta_y_deg": (scale[2] * self.offsets[i, 2]).tolist(),
                "lift_off_deg": np.degrees(self.lift_off[i]).tolist(),
                "arms_mm": (1e3 * self.arms[i]).tolist(),
                "highest_Fy_N": float(self.loads[i, -1, 0]),
            }
            for i in range(len(self.settled))
        ]


def conformity_bounds(
    model: ContactModel, solver: StaticEquilibriumSolver, settings: ConformitySettings
) -> ConformityBounds:
    """Measures the bounds; flexion ends where the femur no longer settles, or not under the loads.

    Args:
        model: Any contact model; where the femur settles.
        solver: Static equilibria on the same model.
        settings: Loads and travels.

    Raises:
        InputDataError: Fewer than two flexions are borne.
    """
    count = 1 + int(np.ceil(settings.max_flexion / settings.flexion_step - 1e-9))
    settled = _settled_poses(model, np.linspace(0.0, settings.max_flexion, count))
    return bounds_about(settled, solver, settings)


def bounds_about(
    settled: NDArray[np.float64], solver: StaticEquilibriumSolver, settings: ConformitySettings
) -> ConformityBounds:
    """As :func:`conformity_bounds`, about poses (n, 6) by rising flexion that are known already."""
    lift_off, arms = _lever_arms(solver, settled)
    loads = _loads_borne(solver, settled, arms, settings)
    # The first flexion that something is missing at ends the range: no gap in it.
    borne = np.isfinite(loads).all(axis=(1, 2))
    last = int(np.argmin(np.append(borne, False)))
    if last < 2:
        raise InputDataError(
            f"conformity: from full extension on, {last} flexions are found where the femur settles, "
            "each side lifts off when tilted, and "
            f"{_LOAD_SHARES[-1] * settings.high_force:.3g} body weights are borne; 2 are needed. "
            "Sample around activities or a table of your own"
        )
    settled, arms, loads = settled[:last], arms[:last], loads[:last]
    offsets = _offsets(solver, settled, loads, settings)
    return ConformityBounds(settled, offsets, lift_off[:last], arms, loads)


def press(
    solver: StaticEquilibriumSolver, poses: NDArray[np.float64], loads: NDArray[np.float64]
) -> Solved:
    """Equilibria at poses (n, 6), whose y and θx do not count, under loads (n, 2) Fy, Mx."""
    columns = dict(zip(POSE_COLUMNS, poses.T, strict=True))
    del columns["y"], columns["theta_x"]
    return solver(Prescribed(Fy=loads[:, 0], Mx=loads[:, 1], **columns))


def _settled_poses(model: ContactModel, flexions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(m, 6) for as many flexions, from the first on, as the femur comes to rest at."""
    poses: list[NDArray[np.float64]] = []
    for flexion in flexions:
        try:
            poses.append(settled_pose(model, float(flexion)))
        except CondyleError:
            break
    return np.array(poses).reshape(-1, 6)


def _lever_arms(
    solver: StaticEquilibriumSolver, settled: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lift-off angles (n, 2) and each side's arm (n, 2) there; NaN where a side does not lift off."""
    x, _, z, _, theta_y, theta_z = settled.T
    light = np.full(len(settled), _ARM_LOAD)
    held = Prescribed(x=x, Fy=light, z=z, Mx=0 * light, theta_y=theta_y, theta_z=theta_z)
    angles = lift_off_angles(solver, held)
    arms = np.full((len(settled), 2), np.nan)
    fy, mx = LOAD_COLUMNS.index("Fy"), LOAD_COLUMNS.index("Mx")
    for column in range(2):
        rows = np.flatnonzero(~np.isnan(angles[:, column]))
        if not len(rows):
            continue
        tilted = Prescribed(
            x=x[rows],
            Fy=light[rows],
            z=z[rows],
            Mx=np.full(len(rows), np.nan),
            theta_y=theta_y[rows],
            theta_z=theta_z[rows],
            theta_x=angles[rows, column],
        )
        wrenches = np.asarray(solver(tilted).wrenches)
        carrier = np.argmax(wrenches[:, :, fy], axis=1)
        total = wrenches.sum(axis=1)
        arms[rows, carrier] = total[:, mx] / total[:, fy]
    return angles, arms


def _loads_borne(
    solver: StaticEquilibriumSolver,
    settled: NDArray[np.float64],
    arms: NDArray[np.float64],
    settings: ConformitySettings,
) -> NDArray[np.float64]:
    """(n, 4, 2) load patterns; NaN where the settled femur bears them at no share of the highest."""
    loads = np.full((len(settled), 4, 2), np.nan)
    for share in _LOAD_SHARES:
        rows = np.flatnonzero(np.isnan(loads[:, 0, 0]) & np.isfinite(arms).all(axis=1))
        if not len(rows):
            break
        tried = _patterns(arms[rows], share, settings)
        solved = press(solver, np.repeat(settled[rows], 4, axis=0), tried.reshape(-1, 2))
        good = (np.asarray(solved.status) == CONVERGED).reshape(-1, 4).all(axis=1)
        loads[rows[good]] = tried[good]
    return loads


def _patterns(
    arms: NDArray[np.float64], share: float, settings: ConformitySettings
) -> NDArray[np.float64]:
    """(n, 4, 2): what the attribute ``loads`` is, the highest load times ``share``."""
    low, high = settings.medial_share
    highest = settings.high_force * share
    forces = [
        min(force, highest)
        for force in (settings.low_force, settings.walking_force, highest, highest)
    ]
    medial = np.array([(low + high) / 2, (low + high) / 2, low, high])
    Fy = settings.body_weight * np.array(forces)
    Mx = Fy * (medial * arms[:, :1] + (1 - medial) * arms[:, 1:])
    return np.stack([np.broadcast_to(Fy, Mx.shape), Mx], axis=-1)


def _offsets(
    solver: StaticEquilibriumSolver,
    settled: NDArray[np.float64],
    loads: NDArray[np.float64],
    settings: ConformitySettings,
) -> NDArray[np.float64]:
    """(n, 3, 2) see ConformityBounds."""
    count = len(settled)
    offsets = np.zeros((count, len(MOVED), 2))
    shares = np.arange(_STEPS + 1) / _STEPS
    for i, name in enumerate(MOVED):
        for end, sign in enumerate((-1.0, 1.0)):
            # Rows: flexion, then step, then load pattern.
            poses = np.repeat(settled, (_STEPS + 1) * 4, axis=0)
            moves = sign * settings.travels[i] * shares
            poses[:, POSE_COLUMNS.index(name)] += np.tile(np.repeat(moves, 4), count)
            solved = press(solver, poses, np.repeat(loads, _STEPS + 1, axis=0).reshape(-1, 2))
            found = (np.asarray(solved.status) == CONVERGED).reshape(count, -1, 4).all(axis=2)
            force = _generalised(solved, name).reshape(count, -1, 4)[:, :, 1]
            change = np.abs(force - force[:, :1])
            for row in range(count):
                reached = _reach(found[row], change[row], settings.resistances[i])
                offsets[row, i, end] = sign * settings.travels[i] * reached
    return offsets


def _reach(found: NDArray[np.bool_], change: NDArray[np.float64], limit: float) -> float:
    """Share of the travel up to which equilibria are found and the resistance is within its limit."""
    for step in range(1, _STEPS + 1):
        if not found[step]:
            return (step - 1) / _STEPS
        if change[step] > limit:
            part = (limit - change[step - 1]) / (change[step] - change[step - 1])
            return float(step - 1 + part) / _STEPS
    return 1.0


def _generalised(solved: Solved, name: str) -> NDArray[np.float64]:
    """The force conjugate to a moved coordinate (n,) [N, Nm]."""
    total = np.asarray(solved.wrenches).sum(axis=1)
    if name != "theta_y":
        return np.asarray(total[:, LOAD_COLUMNS.index(f"F{name}")])
    theta_x = np.asarray(solved.poses)[:, POSE_COLUMNS.index("theta_x")]
    My, Mz = total[:, LOAD_COLUMNS.index("My")], total[:, LOAD_COLUMNS.index("Mz")]
    return np.asarray(-np.cos(theta_x) * My + np.sin(theta_x) * Mz)
