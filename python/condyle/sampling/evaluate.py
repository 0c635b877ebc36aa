# SPDX-License-Identifier: Apache-2.0
"""The static equilibrium solver of :mod:`condyle.fdk`, as sampling asks for it."""

from __future__ import annotations

from condyle.contact import ContactModel, MeshContact
from condyle.errors import InputDataError
from condyle.fdk import StaticEquilibriumSettings, solve_static_equilibria
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

    def solve(prescribed: Prescribed) -> Solved:
        equilibria = solve_static_equilibria(
            model,
            prescribed.x,
            prescribed.z,
            prescribed.theta_y,
            prescribed.theta_z,
            prescribed.Fy,
            prescribed.Mx,
            settings=settings,
            threads=threads,
        )
        return Solved(
            equilibria.poses,
            equilibria.wrenches,
            equilibria.status,
            equilibria.evaluations,
        )

    return solve
