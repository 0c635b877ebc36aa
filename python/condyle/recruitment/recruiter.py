# SPDX-License-Identifier: Apache-2.0
"""Muscle recruitment of time frames, and its derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import recruitment as _recruitment
from condyle.errors import InputDataError

Floats = NDArray[np.float64]
#: The exponent p ≥ 1, or min–max: the largest activity as small as it can be, then the next.
Criterion = float | Literal["min_max"]
_STATES = ("at_minimum", "between", "at_strength", "at_level")


@dataclass(frozen=True)
class Reserves:
    """One actuator a coordinate that helps the muscles at a price: price·|e/strength|^p.

    Attributes:
        strengths: (n,) [Nm, N], or one number for all; 0: no reserve on that coordinate. No bound: only
            the measure of ``e``.
        prices: (n,) [-], or one number for all; a muscle's is its weight.
    """

    strengths: ArrayLike
    prices: ArrayLike = 1.0


@dataclass(frozen=True)
class Recruitment:
    """One time frame: n coordinates, m muscles.

    Attributes:
        forces: (m,) [N]; where infeasible, forces that meet the loads as nearly as bounds allow.
        activities: (m,) force by strength; 0 for a muscle of zero strength.
        reserves: (n,) forces of the reserves [Nm, N].
        multipliers: (n,) d objective / d loads.
        unmet: (n,) loads less what muscles and reserves give [Nm, N].
        status: converged, infeasible or max_iterations.
        message: Where not converged, why, with names of coordinates, and what to do; else empty.
        unmet_coordinates: Names of those whose equation cannot be met, the worst first; empty unless infeasible.
        states: (m,) at_minimum, between, at_strength, or for min–max at_level.
        objective: What was made small; for min–max the first level.
        levels: For min–max the weighted activity of each level, falling; else empty.
        primal, stationarity, complementarity: Residuals of the optimality conditions, scaled to one.
        iterations: Steps taken.
        forces_by_loads: (m, n) d forces / d loads [N/Nm, N/N] where asked for, else None.
    """

    forces: Floats
    activities: Floats
    reserves: Floats
    multipliers: Floats
    unmet: Floats
    status: str
    message: str
    unmet_coordinates: tuple[str, ...]
    states: tuple[str, ...]
    objective: float
    levels: tuple[float, ...]
    primal: float
    stationarity: float
    complementarity: float
    iterations: int
    forces_by_loads: Floats | None = None

    @property
    def converged(self) -> bool:
        """True where forces satisfy the optimality conditions."""
        return self.status == "converged"


@dataclass(frozen=True)
class RecruitmentSeries:
    """t time frames; fields as those of :class:`Recruitment`, with t in front.

    Attributes:
        forces: (t, m) [N].
        activities: (t, m).
        reserves: (t, n) [Nm, N].
        multipliers: (t, n).
        unmet: (t, n) [Nm, N].
        status: (t,) names.
        message: One a time frame, empty where converged.
        objective: (t,).
        kkt: (t, 3) primal, stationarity, complementarity.
        iterations: (t,).
        forces_by_loads: (t, m, n), NaN where not converged; None unless asked for.
    """

    forces: Floats
    activities: Floats
    reserves: Floats
    multipliers: Floats
    unmet: Floats
    status: NDArray[np.str_]
    message: tuple[str, ...]
    objective: Floats
    kkt: Floats
    iterations: NDArray[np.int64]
    forces_by_loads: Floats | None = None

    @property
    def converged(self) -> NDArray[np.bool_]:
        """(t,) True where forces satisfy the optimality conditions."""
        return np.asarray(self.status == "converged")


@dataclass(frozen=True)
class ForceChanges:
    """Along k directions.

    Attributes:
        forces: (k, m) [N].
        reserves: (k, n) [Nm, N].
        regular: False where the muscles between their bounds cannot answer every change of the loads.
    """

    forces: Floats
    reserves: Floats
    regular: bool


class Recruiter:
    """Recruits one set of muscles, time frame after time frame.

    Args:
        n: Number of coordinates.
        m: Number of muscles.
        criterion: Exponent p ≥ 1, or ``"min_max"``.
        upper_bounds: Whether no muscle exceeds its strength.
        weights: (m,) more than 0; all 1 where None.
        reserves: Actuators that help, or None.
        coordinate_names: n, for messages.
        muscle_names: m, for messages.

    Raises:
        InputDataError: A value is out of range; the message names the muscle or coordinate.
    """

    def __init__(
        self,
        n: int,
        m: int,
        *,
        criterion: Criterion = 3.0,
        upper_bounds: bool = True,
        weights: ArrayLike | None = None,
        reserves: Reserves | None = None,
        coordinate_names: Sequence[str] | None = None,
        muscle_names: Sequence[str] | None = None,
    ) -> None:
        setup = _recruitment.RecruitmentSetup()
        setup.coordinates, setup.muscles = n, m
        setup.coordinate_names = list(coordinate_names or [])
        setup.muscle_names = list(muscle_names or [])
        if weights is not None:
            setup.weights = _array("weights", weights, 1)
        if reserves is not None:
            setup.reserve_strengths = _spread("reserves.strengths", reserves.strengths, n)
            setup.reserve_prices = _spread("reserves.prices", reserves.prices, n)
        settings = _recruitment.RecruitmentSettings()
        settings.upper_bounds = upper_bounds
        settings.criterion = _criterion(criterion)
        self._n, self._m = n, m
        self._names = list(coordinate_names or [f"coordinate {j}" for j in range(n)])
        try:
            self._solver = _recruitment.RecruitmentSolver(setup, settings)
        except ValueError as error:
            raise InputDataError(str(error)) from error

    def solve(
        self,
        moment_arms: ArrayLike,
        loads: ArrayLike,
        strengths: ArrayLike,
        *,
        minima: ArrayLike | None = None,
        with_forces_by_loads: bool = False,
    ) -> Recruitment:
        """One time frame.

        Args:
            moment_arms: (n, m) generalised force on a coordinate per newton of a muscle [m, -].
            loads: (n,) [Nm, N].
            strengths: (m,) [N].
            minima: (m,) passive forces that a muscle has anyway [N]; all 0 where None.
            with_forces_by_loads: Whether to give d forces / d loads.

        Raises:
            InputDataError: Shapes do not fit, a value is not finite, a strength is negative, or a minimum
                exceeds the strength that bounds it.
        """
        arms = _array("moment_arms", moment_arms, 2)
        minima_row = None if minima is None else _array("minima", minima, 1)[None]
        found = self._run(
            arms[None],
            _array("loads", loads, 1)[None],
            _array("strengths", strengths, 1)[None],
            minima_row,
            False,
            with_forces_by_loads,
        )
        primal, stationarity, complementarity = (float(v) for v in found.kkt[0])
        return Recruitment(
            found.forces[0],
            found.activities[0],
            found.reserves[0],
            found.multipliers[0],
            found.unmet[0],
            str(found.status[0]),
            found.message[0],
            tuple(self._names[j] for j in self._solver.unmet_coordinates),
            tuple(_STATES[s] for s in self._solver.states),
            float(found.objective[0]),
            tuple(self._solver.levels),
            primal,
            stationarity,
            complementarity,
            int(found.iterations[0]),
            None if found.forces_by_loads is None else found.forces_by_loads[0],
        )

    def solve_series(
        self,
        moment_arms: ArrayLike,
        loads: ArrayLike,
        strengths: ArrayLike,
        *,
        minima: ArrayLike | None = None,
        warm_starts: bool = True,
        with_forces_by_loads: bool = False,
    ) -> RecruitmentSeries:
        """Time frames one after another, each started from the last that converged.

        Args:
            moment_arms: (t, n, m) [m, -].
            loads: (t, n) [Nm, N].
            strengths: (t, m), or (m,) for all time frames [N].
            minima: (t, m), or (m,) for all [N]; all 0 where None.
            warm_starts: Whether to start from the last time frame; results differ by rounding.
            with_forces_by_loads: Whether to give d forces / d loads.

        Raises:
            InputDataError: As :meth:`solve`; the message begins with the time frame.
        """
        rows = None if minima is None else np.atleast_2d(_array("minima", minima, None))
        return self._run(
            _array("moment_arms", moment_arms, 3),
            _array("loads", loads, 2),
            np.atleast_2d(_array("strengths", strengths, None)),
            rows,
            warm_starts,
            with_forces_by_loads,
        )

    def forces_along(
        self,
        loads: ArrayLike | None = None,
        moment_arms: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
    ) -> ForceChanges:
        """Derivatives at the last time frame that was solved, along k directions.

        Where the set of muscles at their bounds changes, forces have a kink: the answer is that of one side.

        Args:
            loads: (k, n) changes of the loads [Nm, N]; none where None. So are all that follow.
            moment_arms: (k, n, m) changes of the moment arms [m, -].
            strengths: (k, m) changes of the strengths [N].

        Raises:
            InputDataError: Nothing is given, shapes do not fit, or the last result did not converge.
        """
        given = [v for v in (loads, moment_arms, strengths) if v is not None]
        if not given:
            raise InputDataError("forces_along: give changes of loads, moment_arms or strengths")
        k = len(np.asarray(given[0]))
        n, m = self._n, self._m
        d_loads = np.zeros((k, n)) if loads is None else _array("loads", loads, 2)
        arms = np.zeros((0, n, m)) if moment_arms is None else _array("moment_arms", moment_arms, 3)
        grown = np.zeros((0, m)) if strengths is None else _array("strengths", strengths, 2)
        if arms.shape[1:] != (n, m) or len(arms) not in (0, k):
            raise InputDataError(
                f"forces_along: moment_arms has shape {arms.shape}; ({k}, {n}, {m}) is needed"
            )
        try:
            forces, reserves = self._solver.forces_along(d_loads, arms, grown)
            return ForceChanges(forces, reserves, self._solver.sensitivity_is_regular())
        except (ValueError, RuntimeError) as error:
            raise InputDataError(str(error)) from error

    def _run(
        self,
        arms: Floats,
        loads: Floats,
        strengths: Floats,
        minima: Floats | None,
        warm_starts: bool,
        with_forces_by_loads: bool,
    ) -> RecruitmentSeries:
        t, n, m = len(loads), self._n, self._m
        if arms.shape != (t, n, m) or loads.shape != (t, n):
            raise InputDataError(
                f"recruitment: moment_arms {arms.shape} and loads {loads.shape}: "
                f"({t}, {n}, {m}) and ({t}, {n}) are needed"
            )
        rows = {"strengths": strengths, "minima": minima}
        for field, values in rows.items():
            if values is not None and values.shape not in ((1, m), (t, m)):
                raise InputDataError(
                    f"recruitment: {field} has shape {values.shape}; ({m},) or ({t}, {m}) is needed"
                )
        none = np.zeros((0, m))
        try:
            found = self._solver.solve(
                arms,
                loads,
                strengths,
                none if minima is None else minima,
                warm_starts,
                with_forces_by_loads,
            )
        except ValueError as error:
            raise InputDataError(str(error)) from error
        by_loads = found.forces_by_loads.reshape(t, m, n) if with_forces_by_loads else None
        return RecruitmentSeries(
            found.forces,
            found.activities,
            found.reserves,
            found.multipliers,
            found.unmet,
            np.array(found.status, dtype=np.str_),
            tuple(found.message),
            found.objective.reshape(t),
            found.kkt,
            found.iterations.astype(np.int64),
            by_loads,
        )


def recruit(
    moment_arms: ArrayLike,
    loads: ArrayLike,
    strengths: ArrayLike,
    *,
    criterion: Criterion = 3.0,
    upper_bounds: bool = True,
    weights: ArrayLike | None = None,
    reserves: Reserves | None = None,
    minima: ArrayLike | None = None,
    coordinate_names: Sequence[str] | None = None,
    muscle_names: Sequence[str] | None = None,
    with_forces_by_loads: bool = False,
) -> Recruitment:
    """Recruits muscles in one time frame; :meth:`Recruiter.solve_series` takes many.

    Args:
        moment_arms: (n, m) generalised force on a coordinate per newton of a muscle [m, -].
        loads: (n,) [Nm, N].
        strengths: (m,) [N].
        criterion: Exponent p ≥ 1, or ``"min_max"``.
        upper_bounds: Whether no muscle exceeds its strength.
        weights: (m,) more than 0; all 1 where None.
        reserves: Actuators that help, or None.
        minima: (m,) passive forces [N]; all 0 where None.
        coordinate_names: n, for messages.
        muscle_names: m, for messages.
        with_forces_by_loads: Whether to give d forces / d loads.

    Raises:
        InputDataError: As :class:`Recruiter` and its ``solve``.
    """
    arms = _array("moment_arms", moment_arms, 2)
    recruiter = Recruiter(
        *arms.shape,
        criterion=criterion,
        upper_bounds=upper_bounds,
        weights=weights,
        reserves=reserves,
        coordinate_names=coordinate_names,
        muscle_names=muscle_names,
    )
    return recruiter.solve(
        arms, loads, strengths, minima=minima, with_forces_by_loads=with_forces_by_loads
    )


def _criterion(criterion: Criterion) -> _recruitment.Criterion:
    asked = _recruitment.Criterion()
    if isinstance(criterion, str):
        if criterion != "min_max":
            raise InputDataError(
                f"recruitment: criterion {criterion!r}: must be 'min_max' or a number"
            )
        asked.min_max = True
    else:
        asked.exponent = float(criterion)
    return asked


def _array(field: str, values: ArrayLike, dimensions: int | None) -> Floats:
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputDataError(f"recruitment: {field} is not an array of numbers: {error}") from error
    if dimensions is not None and array.ndim != dimensions:
        raise InputDataError(
            f"recruitment: {field} has {array.ndim} dimensions; {dimensions} are needed"
        )
    return array


def _spread(field: str, values: ArrayLike, n: int) -> Floats:
    if np.ndim(values) == 0:
        return np.full(n, _array(field, values, None)[0])
    return _array(field, values, 1)
