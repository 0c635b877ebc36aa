# SPDX-License-Identifier: Apache-2.0
"""Static equilibria of samples: poses at which the contact carries prescribed loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import fdk as _fdk
from condyle._core.contact import ContactModel
from condyle.errors import InputDataError


@dataclass(frozen=True)
class StaticEquilibria:
    """n static equilibria.

    Attributes:
        poses: (n, 6) [m, rad]; the equilibrium where converged, else the pose last tried.
        wrenches: (n, 2, 6) contact wrench per side there, on the femur at Fo, expressed in T [N, Nm].
        stiffness: (n, 2, 6, 6) d wrench_i / d pose_j there.
        status: (n,) names: converged, no_equilibrium, overclosure, off_insert, not_converged.
        evaluations: (n,) contact evaluations, those of the map of first touches not included.
        iterations: (n,) Newton steps.
        trust: (n,) of the contact model there; 1 for the reference.
        map_evaluations: Contact evaluations that this call spent on the map of first touches.
    """

    poses: NDArray[np.float64]
    wrenches: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    status: NDArray[np.str_]
    evaluations: NDArray[np.int64]
    iterations: NDArray[np.int64]
    trust: NDArray[np.float64]
    map_evaluations: int

    @property
    def converged(self) -> NDArray[np.bool_]:
        """(n,) True where the equilibrium was found."""
        return np.asarray(self.status == "converged")


class StaticEquilibriumSolver:
    """Solves static equilibria on one contact model, call after call.

    It keeps what it has learnt about where the model first touches, some thousand contact
    evaluations, so one solver is cheaper than many calls of :func:`solve_static_equilibria`. Results
    do not depend on it: they are the same bytes for any number of threads and any split of the rows
    into calls.

    Args:
        model: Any contact model.
        settings: Tolerances and limits; the defaults are those of the sampling plan.

    Raises:
        InputDataError: A setting is out of range.
    """

    def __init__(
        self, model: ContactModel, settings: _fdk.StaticEquilibriumSettings | None = None
    ) -> None:
        try:
            self._solver = _fdk.StaticEquilibriumSolver(
                model, settings or _fdk.StaticEquilibriumSettings()
            )
        except ValueError as error:
            raise InputDataError(str(error)) from error

    def solve(
        self,
        x: ArrayLike,
        z: ArrayLike,
        theta_y: ArrayLike,
        theta_z: ArrayLike,
        Fy: ArrayLike,
        Mx: ArrayLike | None = None,
        *,
        theta_x: ArrayLike | None = None,
        start: ArrayLike | None = None,
        threads: int = 0,
    ) -> StaticEquilibria:
        """Solves for {y, θx} with Mx prescribed, or for y with θx prescribed.

        Args:
            x: (n,) or a number [m]; so are all that follow.
            z: [m].
            theta_y: [rad].
            theta_z: [rad].
            Fy: Total contact force on the femur along y_T [N]; compression is positive.
            Mx: Total contact moment on the femur about x_T at Fo [Nm]. Give this or ``theta_x``.
            theta_x: [rad].
            start: (n, 2) first guesses of (y, θx); not needed.
            threads: 0 means all cores.

        Raises:
            InputDataError: Shapes do not fit, a value is not finite (the message names row and
                field), or both or none of ``Mx`` and ``theta_x`` are given.
        """
        if (Mx is None) == (theta_x is None):
            raise InputDataError("solve_static_equilibria: give either Mx or theta_x")
        rows = _rows([x, z, theta_y, theta_z, Fy, theta_x if Mx is None else Mx])
        starts = None if start is None else np.ascontiguousarray(start, dtype=np.float64)
        if starts is not None and starts.shape != (len(rows), 2):
            raise InputDataError(
                f"solve_static_equilibria: start has shape {starts.shape}; "
                f"({len(rows)}, 2) is needed"
            )
        try:
            result = self._solver.solve(rows, Mx is None, starts, threads)
        except ValueError as error:
            raise InputDataError(str(error)) from error
        return StaticEquilibria(
            result.poses,
            result.wrenches,
            result.stiffness,
            np.array([_fdk.EquilibriumStatus(int(s)).text for s in result.status], dtype=np.str_),
            result.evaluations,
            result.iterations,
            result.trust,
            int(result.map_evaluations),
        )


def solve_static_equilibria(
    model: ContactModel,
    x: ArrayLike,
    z: ArrayLike,
    theta_y: ArrayLike,
    theta_z: ArrayLike,
    Fy: ArrayLike,
    Mx: ArrayLike | None = None,
    *,
    theta_x: ArrayLike | None = None,
    start: ArrayLike | None = None,
    settings: _fdk.StaticEquilibriumSettings | None = None,
    threads: int = 0,
) -> StaticEquilibria:
    """As :class:`StaticEquilibriumSolver` and its ``solve``, for a single call.

    Raises:
        InputDataError: As there.
    """
    solver = StaticEquilibriumSolver(model, settings)
    return solver.solve(
        x, z, theta_y, theta_z, Fy, Mx, theta_x=theta_x, start=start, threads=threads
    )


def _rows(values: list[Any]) -> NDArray[np.float64]:
    """(n, len(values)) of vectors (n,) and numbers."""
    try:
        columns = np.broadcast_arrays(
            *[np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in values]
        )
    except ValueError as error:
        shapes = ", ".join(str(np.asarray(v).shape) for v in values)
        raise InputDataError(
            f"solve_static_equilibria: shapes {shapes} do not fit together"
        ) from error
    if columns[0].ndim != 1:
        raise InputDataError(f"solve_static_equilibria: shape {columns[0].shape}; (n,) is needed")
    return np.ascontiguousarray(np.column_stack(columns))
