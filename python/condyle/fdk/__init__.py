# SPDX-License-Identifier: Apache-2.0
"""Equilibrium of a knee replacement on any contact model: single samples and the knee simulator.

:func:`solve_static_equilibria` finds, for prescribed {x, z, θy, θz} and contact loads {Fy, Mx}, the
pose that carries them: what sampling needs. :func:`simulate_knee` runs a load case through the knee
simulator: flexion driven, the five other coordinates found from equilibrium at each time frame.

:func:`solve_given_loads` is for simulators of one's own: loads, moment arms and strengths in, secondary
kinematics, muscle, ligament and contact forces out. :func:`seated_pose` and :func:`first_touch` say where
contact begins. All take any contact model (reference, surrogate, hybrid) and assume it frictionless and
quasi-static. Numerics that do not work out are a status, never an exception.
"""

from condyle._core.fdk import (
    EquilibriumStatus,
    FrameStatus,
    GivenLoadsSettings,
    JacobianMethod,
    KneeSimulatorSettings,
    Ligament,
    NewtonSettings,
    RestraintSprings,
    SeatingSettings,
    SettleSettings,
    StaticEquilibriumSettings,
    TouchSearch,
)
from condyle.fdk.given_loads import GivenLoadsSimulation, solve_given_loads
from condyle.fdk.knee_simulator import KneeSimulation, settled_pose, simulate_knee
from condyle.fdk.ligaments import default_ligaments
from condyle.fdk.seating import Seat, first_touch, load_seated, seated_pose
from condyle.fdk.static_equilibrium import (
    StaticEquilibria,
    StaticEquilibriumSolver,
    solve_static_equilibria,
)

__all__ = [
    "EquilibriumStatus",
    "FrameStatus",
    "GivenLoadsSettings",
    "GivenLoadsSimulation",
    "JacobianMethod",
    "KneeSimulation",
    "KneeSimulatorSettings",
    "Ligament",
    "NewtonSettings",
    "RestraintSprings",
    "Seat",
    "SeatingSettings",
    "SettleSettings",
    "StaticEquilibria",
    "StaticEquilibriumSettings",
    "StaticEquilibriumSolver",
    "TouchSearch",
    "default_ligaments",
    "first_touch",
    "load_seated",
    "seated_pose",
    "settled_pose",
    "simulate_knee",
    "solve_given_loads",
    "solve_static_equilibria",
]
