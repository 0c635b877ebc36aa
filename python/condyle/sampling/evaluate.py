# SPDX-License-Identifier: Apache-2.0
"""The static equilibrium solver of :mod:`condyle.fdk`, as sampling asks for it."""

from __future__ import annotations

import numpy as np

from condyle.contact import ContactModel, Derivatives, MeshContact
from condyle.errors import InputDataError
from condyle.fdk import StaticEquilibriumSettings
from condyle.fdk import StaticEquilibriumSolver as EquilibriumSolver
from condyle.sampling.equilibrium_protocol import Prescribed, Solved, StaticEquilibriumSolver


def equilibrium_solver(
    model: ContactModel,
    *,
    max_depth: float,
    settings: StaticEquilibriumSettings | None = None,
    threads: int = 0,
) -> StaticEquilibriumSolver:
    """A solver for :func:`condyle.sampling.sample`, which gives the same bytes for any ``threads``.

    Args:
        model: Any contact model. It flags overlaps that are too deep, so its own limit is the one in
            force.
        max_depth: The sampling plan's [m], to be sure that it is the model's.
        settings: Tolerances and limits; the defaults are those of the sampling plan.
        threads: 0 means all cores.

    Raises:
        InputDataError: The model's plausible depth is not ``max_depth``.
    """
    if isinstance(model, MeshContact) and model.settings.plausible_depth != max_depth:
        raise InputDataError(
            f"the contact model's plausible_depth is {model.settings.plausible_depth:.6g} m, the "
            f"sampling plan's max_depth {max_depth:.6g} m; they must be the same"
        )

    # One for the whole run: its map of first touches is as dear as several hundred samples.
    solver = EquilibriumSolver(model, settings)

    def solve(prescribed: Prescribed) -> Solved:
        if prescribed.pose_given:
            return _evaluated(model, prescribed, threads)
        tilted = prescribed.theta_x_given
        equilibria = solver.solve(
            prescribed.x,
            prescribed.z,
            prescribed.theta_y,
            prescribed.theta_z,
            prescribed.Fy,
            None if tilted else prescribed.Mx,
            theta_x=prescribed.theta_x if tilted else None,
            threads=threads,
        )
        return Solved(
            equilibria.poses,
            equilibria.wrenches,
            equilibria.status,
            equilibria.evaluations,
        )

    return solve


def _evaluated(model: ContactModel, prescribed: Prescribed, threads: int) -> Solved:
    """Poses to evaluate once; nothing is to be solved for."""
    poses = prescribed.to_poses()
    loads = model.evaluate(poses, Derivatives.none, threads)
    deep = np.asarray(loads.implausible_depth, dtype=bool)
    return Solved(
        poses,
        np.asarray(loads.wrench),
        np.where(deep, "overclosure", "converged"),
        np.ones(len(poses), dtype=np.int64),
    )
