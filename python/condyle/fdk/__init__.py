# SPDX-License-Identifier: Apache-2.0
"""Equilibrium of a knee replacement on any contact model: single samples and the knee simulator.

:func:`solve_static_equilibria` finds, for prescribed {x, z, θy, θz} and contact loads {Fy, Mx}, the
pose that carries them: what sampling needs. :func:`simulate_knee` runs a load case through the knee
simulator: flexion driven, the five other coordinates found from equilibrium at each time frame.

:func:`simulate_trial` puts contact into a musculoskeletal model: from a recorded motion to secondary kinematics,
muscle, ligament and contact forces; :func:`tibiofemoral_contact` and :func:`patellofemoral_contact` make its
contacts, :func:`write_trial_simulation` its files, :func:`simulate_alignments` runs it for many alignments of the
implant. :func:`solve_given_loads` is for simulators of one's own: loads, moment arms and strengths in, secondary
kinematics, muscle, ligament and contact forces out. :func:`seated_pose` and :func:`first_touch` say where contact
begins. All take any contact model (reference, surrogate, hybrid) and assume it frictionless and quasi-static.
Numerics that do not work out are a status, never an exception.
"""

from condyle._core.fdk import (
    EquilibriumStatus,
    ForceDependentSettings,
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
    TrialSimulationSettings,
)
from condyle.fdk.alignment import Alignment, aligned_contacts, alignment_grid
from condyle.fdk.alignments import AlignedSimulation, simulate_alignments
from condyle.fdk.body_contact import BodyContact
from condyle.fdk.contact_pressures import ContactPressures, contact_pressures
from condyle.fdk.given_loads import GivenLoadsSimulation, solve_given_loads
from condyle.fdk.joint_contacts import (
    JointContact,
    ReferenceSettings,
    patellofemoral_contact,
    tibiofemoral_contact,
)
from condyle.fdk.knee_simulator import KneeSimulation, settled_pose, simulate_knee
from condyle.fdk.ligaments import default_ligaments
from condyle.fdk.seating import Seat, first_touch, load_seated, seated_pose
from condyle.fdk.simulation_files import write_trial_simulation
from condyle.fdk.static_equilibrium import (
    StaticEquilibria,
    StaticEquilibriumSolver,
    solve_static_equilibria,
)
from condyle.fdk.trial_simulation import TimeFrameRecord, TrialSimulation, simulate_trial

__all__ = [
    "AlignedSimulation",
    "Alignment",
    "BodyContact",
    "ContactPressures",
    "EquilibriumStatus",
    "ForceDependentSettings",
    "FrameStatus",
    "GivenLoadsSettings",
    "GivenLoadsSimulation",
    "JacobianMethod",
    "JointContact",
    "KneeSimulation",
    "KneeSimulatorSettings",
    "Ligament",
    "NewtonSettings",
    "ReferenceSettings",
    "RestraintSprings",
    "Seat",
    "SeatingSettings",
    "SettleSettings",
    "StaticEquilibria",
    "StaticEquilibriumSettings",
    "StaticEquilibriumSolver",
    "TimeFrameRecord",
    "TouchSearch",
    "TrialSimulation",
    "TrialSimulationSettings",
    "aligned_contacts",
    "alignment_grid",
    "contact_pressures",
    "default_ligaments",
    "first_touch",
    "load_seated",
    "patellofemoral_contact",
    "seated_pose",
    "settled_pose",
    "simulate_alignments",
    "simulate_knee",
    "simulate_trial",
    "solve_given_loads",
    "solve_static_equilibria",
    "tibiofemoral_contact",
    "write_trial_simulation",
]
