# SPDX-License-Identifier: Apache-2.0
"""The static equilibrium solver of :mod:`condyle.fdk`, as sampling asks for it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from condyle.contact import ContactModel, Derivatives, MeshContact
from condyle.errors import InputDataError
from condyle.fdk import StaticEquilibriumSettings
from condyle.fdk import StaticEquilibriumSolver as EquilibriumSolver
from condyle.sampling.equilibrium_protocol import Prescribed, Solved
from condyle.sampling.same_results import environment_of
from condyle.sampling.sent_solver import SentSolver, packed


class ContactSolver:
    """Static equilibria on a contact model; pickled it becomes a :class:`SentSolver`.

    Args:
        model: Any contact model.
        settings: Tolerances and limits; the defaults are those of the sampling plan.
        threads: 0 means all cores.
    """

    def __init__(
        self,
        model: ContactModel,
        *,
        settings: StaticEquilibriumSettings | None = None,
        threads: int = 0,
    ) -> None:
        self._model = model
        self._settings = settings
        self._threads = threads
        # One for the whole run: its map of first touches is as dear as several hundred samples.
        self._solver = EquilibriumSolver(model, settings)

    def __call__(self, prescribed: Prescribed) -> Solved:
        """Solves, or only evaluates where the whole pose is prescribed."""
        if prescribed.pose_given:
            return _evaluated(self._model, prescribed, self._threads)
        tilted = prescribed.theta_x_given
        equilibria = self._solver.solve(
            prescribed.x,
            prescribed.z,
            prescribed.theta_y,
            prescribed.theta_z,
            prescribed.Fy,
            None if tilted else prescribed.Mx,
            theta_x=prescribed.theta_x if tilted else None,
            threads=self._threads,
        )
        return Solved(
            equilibria.poses,
            equilibria.wrenches,
            equilibria.status,
            equilibria.evaluations,
        )

    @cached_property
    def _sent(self) -> SentSolver:
        return SentSolver(packed(self._model, self._settings), environment_of(self))

    def __reduce__(self) -> tuple[Any, ...]:
        """What another process gets."""
        return SentSolver, (self._sent.content, self._sent.environment)


def equilibrium_solver(
    model: ContactModel,
    *,
    max_depth: float,
    settings: StaticEquilibriumSettings | None = None,
    threads: int = 0,
) -> ContactSolver:
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

    return ContactSolver(model, settings=settings, threads=threads)


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
