# SPDX-License-Identifier: Apache-2.0
"""Inverse dynamics, paths, ligaments and recruitment over a trial whose every coordinate is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from condyle._core import fdk as _fdk
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel
from condyle.model.trial import Trial

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MuscleSettings:
    """How muscles share load.

    Attributes:
        criterion: p of min Σ(f/N)^p, or ``"min_max"``.
        strength: ``"hill"`` (force–length–velocity, rigid tendon) or ``"constant"``.
        upper_bounds: whether a muscle carries its strength at most.
        reserve_moment: strength of a reserve actuator on every rotation that muscles balance [Nm]; 0: none.
        reserve_force: likewise on translations [N].
        reserve_price: weight of (e/strength)^p.
    """

    criterion: float | Literal["min_max"] = 3.0
    strength: Literal["hill", "constant"] = "hill"
    upper_bounds: bool = True
    reserve_moment: float = 0.0
    reserve_force: float = 0.0
    reserve_price: float = 1.0

    def core(self) -> _fdk.MuscleSettings:
        """As the C++ core has them.

        Raises:
            InputDataError: a criterion or strength model that there is not.
        """
        if self.strength not in ("hill", "constant"):
            raise InputDataError(f"strength is {self.strength!r}; it must be 'hill' or 'constant'")
        if isinstance(self.criterion, str) and self.criterion != "min_max":
            raise InputDataError(
                f"criterion is {self.criterion!r}; it must be a power or 'min_max'"
            )
        min_max = self.criterion == "min_max"
        models = _fdk.StrengthModel
        return _fdk.MuscleSettings(
            strength=models.HILL if self.strength == "hill" else models.CONSTANT,
            min_max=min_max,
            exponent=3.0 if isinstance(self.criterion, str) else float(self.criterion),
            upper_bounds=self.upper_bounds,
            reserve_moment=self.reserve_moment,
            reserve_force=self.reserve_force,
            reserve_price=self.reserve_price,
        )


@dataclass(frozen=True)
class TrialAnalysis:
    """Results, one row a time frame; arrays of what was not asked for have no rows.

    T time frames, n coordinates, b bodies, m muscles, s ligaments, k coordinates that muscles balance.

    Attributes:
        times: (T,) [s].
        rotations: (T, b, 3, 3) of the bodies: components in the body to components in ground.
        positions: (T, b, 3) of the bodies' origins in ground [m].
        generalised_forces: (T, n) of inverse dynamics, muscles and ligaments excluded [Nm, N].
        muscle_lengths: (T, m) [m].
        muscle_velocities: (T, m) lengthening positive [m/s].
        moment_arms: (T, n, m) −∂L/∂q [m, -].
        muscle_strengths: (T, m) at full activation, without the passive part [N].
        passive_forces: (T, m) [N].
        ligament_lengths: (T, s) [m].
        ligament_strains: (T, s).
        ligament_forces: (T, s) [N].
        ligament_loads: (T, n) their generalised forces [Nm, N].
        spring_loads: (T, n) those of coordinate springs [Nm, N].
        muscle_forces: (T, m) active and passive [N].
        activities: (T, m) active force over strength.
        reserves: (T, k) [Nm, N].
        residuals: (T, n) what muscles, ligaments and springs do not give of the generalised forces [Nm, N].
        balanced: (k,) names of the coordinates that muscles balance.
        status: (T,) of recruitment: ``converged``, ``infeasible``, ``max_iterations``.
        messages: (T,) the same in words, with names.
        kkt: (T,) largest scaled residual of the optimality conditions.
        wraps_ignored: Wrapping surfaces that paths passed by, in words: not computed, and not in the snapshots.
    """

    times: Array
    rotations: Array
    positions: Array
    generalised_forces: Array
    muscle_lengths: Array
    muscle_velocities: Array
    moment_arms: Array
    muscle_strengths: Array
    passive_forces: Array
    ligament_lengths: Array
    ligament_strains: Array
    ligament_forces: Array
    ligament_loads: Array
    spring_loads: Array
    muscle_forces: Array
    activities: Array
    reserves: Array
    residuals: Array
    balanced: tuple[str, ...]
    status: tuple[str, ...]
    messages: tuple[str, ...]
    kkt: Array
    wraps_ignored: tuple[str, ...]


def analyse_trial(
    model: MusculoskeletalModel,
    trial: Trial,
    settings: MuscleSettings | None = None,
    *,
    recruitment: bool = True,
    muscles: bool = True,
    ligaments: bool = True,
    dynamics: bool = True,
    threads: int = 0,
) -> TrialAnalysis:
    """Analyses all time frames; the same bytes for any number of threads.

    Args:
        model: of the trial.
        trial: its motion and loads.
        settings: of the muscles.
        recruitment: share loads over muscles; needs the three below.
        muscles: lengths, moment arms, strengths.
        ligaments: tensions and their loads, and coordinate springs'.
        dynamics: inverse dynamics.
        threads: 0 for all cores.

    Raises:
        ValueError: shapes that do not fit, values that are not finite, settings beyond their limits.
    """
    parts = _fdk.TrialParts(
        dynamics=dynamics, muscles=muscles, ligaments=ligaments, recruitment=recruitment
    )
    found = _fdk.analyse_trial(
        model.core,
        trial.q,
        trial.qd,
        trial.qdd,
        trial.loads,
        list(trial.load_bodies),
        trial.snapshots,
        list(trial.snapshot_rows),
        (settings or MuscleSettings()).core(),
        parts,
        threads,
    )
    poses = found.segment_poses.reshape(len(trial), -1, 12)
    # Without muscles the size says nothing about the rows.
    shape = (len(found.moment_arms), len(model.coordinate_names), len(model.muscle_names))
    arms = found.moment_arms.reshape(shape)
    balanced = _fdk.balanced_coordinates(model.core)
    return TrialAnalysis(
        times=trial.times,
        rotations=poses[:, :, :9].reshape(len(trial), -1, 3, 3),
        positions=poses[:, :, 9:],
        generalised_forces=found.generalised_forces,
        muscle_lengths=found.muscle_lengths,
        muscle_velocities=found.muscle_velocities,
        moment_arms=arms,
        muscle_strengths=found.muscle_strengths,
        passive_forces=found.passive_forces,
        ligament_lengths=found.ligament_lengths,
        ligament_strains=found.ligament_strains,
        ligament_forces=found.ligament_forces,
        ligament_loads=found.ligament_loads,
        spring_loads=found.spring_loads,
        muscle_forces=found.muscle_forces,
        activities=found.activities,
        reserves=found.reserves,
        residuals=found.residuals,
        balanced=tuple(model.coordinate_names[c] for c in balanced),
        status=tuple(found.status),
        messages=tuple(found.messages),
        kkt=np.asarray(found.kkt),
        wraps_ignored=wraps_passed_by(model, trial),
    )


def wraps_passed_by(model: MusculoskeletalModel, trial: Trial) -> tuple[str, ...]:
    """Wrapping surfaces that paths go straight past, in words: not computed, and not in the trial's snapshots."""
    held = set() if trial.snapshots is None else set(trial.snapshots.paths)
    return tuple(
        text
        for text in _fdk.wraps_ignored(model.core)
        if not any(f"'{name}':" in text for name in held)
    )
