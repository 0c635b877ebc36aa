# SPDX-License-Identifier: Apache-2.0
"""Training of the potential surrogate, side by side, by Levenberg-Marquardt.

1. *level*: N is fitted to (Fy/Fy_max)^(1/(p−1)), its value if y were all that mattered, as a
   quadratic and a network for the rest; on lifted samples it need only be negative. That puts the
   sign of N right, without which the next step would have samples whose prediction is zero and
   stays zero.
2. *wrench*: U's gradient is fitted to all six loads, first on a few thousand samples, then on more,
   in the end on all: an epoch costs as much as the loaded samples in it, and the first hundred
   need no more than a rough answer.

Seeded, resumable after a kill with the identical result, and quiet: what happens is told to a
callback.
"""

from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import ArrayLike
from torch import Tensor

from condyle.conventions import SIDES
from condyle.training.checkpoint import Checkpoint
from condyle.training.generalised_force import generalised_force
from condyle.training.input_data import FY, check_samples, data_hash
from condyle.training.levenberg_marquardt import (
    LevenbergMarquardt,
    LevenbergMarquardtSettings,
    LevenbergMarquardtState,
)
from condyle.training.mlp_least_squares import MlpLeastSquares
from condyle.training.networks import MinMaxMap, TanhMlp
from condyle.training.potential import PotentialSurrogate, SideEnergy
from condyle.training.potential_least_squares import PotentialLeastSquares
from condyle.training.potential_network import PotentialNetwork, quadratic_terms
from condyle.training.record import NetRecord, TrainingRecord, versions
from condyle.training.settings import TrainingSettings
from condyle.training.train import ProgressCallback, thread_count

#: α, with β = 1, where they are not re-estimated: next to nothing beside thousands of samples.
_WEIGHT_DECAY: Final = 1e-4
#: Samples of the level fit: it only has to get signs right.
_LEVEL_ROWS: Final = 4000


@dataclass(frozen=True)
class _Stage:
    """One run of the optimiser.

    Attributes:
        name: Of the stage.
        rows: Samples taking part, at most.
        epochs: Share of ``max_epochs``.
        time: Share of the net's time budget.
        bayesian: Whether α and β are re-estimated. Not before the last stage: while the fit is still
            rough the evidence takes its errors for noise, and α grows until nothing is learned.
    """

    name: str
    rows: int
    epochs: float
    time: float
    bayesian: bool = False


_LEVEL: Final = _Stage("level", _LEVEL_ROWS, 0.25, 0.02)
_WRENCH: Final = (
    _Stage("wrench on 4 000", 4_000, 0.5, 0.06),
    _Stage("wrench on 16 000", 16_000, 0.5, 0.22),
    _Stage("wrench", 1 << 62, 1.0, 0.7, bayesian=True),
)


def _stages(samples: int) -> list[_Stage]:
    """The wrench stages that differ for so many samples."""
    *first, last = _WRENCH
    kept = [
        s
        for s, before in zip(first, [None, *first], strict=False)
        if not before or before.rows < samples
    ]
    return [*kept, last]


def train_potential(
    poses: ArrayLike,
    wrenches: ArrayLike,
    settings: TrainingSettings | None = None,
    *,
    progress: ProgressCallback | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
) -> tuple[PotentialSurrogate, TrainingRecord]:
    """Trains a potential surrogate on samples of an elastic, frictionless contact model.

    Args:
        poses: (n, 6) [m, rad], each once.
        wrenches: (n, 2, 6) [N, Nm], zero on lifted sides.
        settings: See :class:`~condyle.training.settings.TrainingSettings`; the budgets are a side's.
        progress: See :class:`~condyle.training.train.ProgressCallback`.
        checkpoint: As for :func:`~condyle.training.train.train_two_stage`.

    Returns:
        The surrogate and the record of its training, one entry a side and stage.

    Raises:
        InputDataError: Samples unfit for training, or a checkpoint of another training.
    """
    settings = settings or TrainingSettings()
    poses, wrenches = check_samples(poses, wrenches, settings.min_loaded_rows)
    key = {
        "architecture": "potential",
        "data_hash": data_hash(poses, wrenches),
        **settings.to_dict(),
    }
    store = Checkpoint(None if checkpoint is None else Path(checkpoint), key)
    sides: list[SideEnergy] = []
    records: list[NetRecord] = []
    times: dict[str, float] = {}
    pose = torch.from_numpy(poses)
    with thread_count(settings.threads):
        for index, name in enumerate(SIDES):
            force = generalised_force(pose, torch.from_numpy(wrenches[:, index]))
            trainer = _SideTrainer(
                name, pose, force, dataclasses.replace(settings, seed=settings.seed + index)
            )
            sides.append(trainer.train(store, progress))
            records += trainer.records
            times[name] = trainer.seconds
    n_medial, n_lateral = (wrenches[:, :, FY] > 0).sum(axis=0)
    record = TrainingRecord(
        settings=settings.to_dict(),
        n_samples=len(poses),
        n_loaded=(int(n_medial), int(n_lateral)),
        data_hash=key["data_hash"],
        versions=versions(),
        nets=tuple(records),
        wall_times_s=times,
    )
    return PotentialSurrogate((sides[0], sides[1])), record


class _SideTrainer:
    """One side's training.

    Args:
        side: medial or lateral.
        pose: (n, 6).
        force: Q (n, 6).
        settings: With the side's own seed.
    """

    def __init__(self, side: str, pose: Tensor, force: Tensor, settings: TrainingSettings) -> None:
        self.records: list[NetRecord] = []
        self.seconds = 0.0
        self._side, self._settings = side, settings
        self._pose, self._force = pose, force
        # A side that pulls (an implausible pose, caught under the insert's rim) counts as lifted.
        self._loaded = force[:, FY] > 0
        self._max_fy = float(force[:, FY].max())
        # Poses far from contact must not stretch the map: their N need only be negative.
        self._input_map = MinMaxMap.from_data(pose[self._loaded])
        order = np.random.default_rng(settings.seed).permutation(len(pose))
        self._order = torch.from_numpy(order)

    def train(self, store: Checkpoint, progress: ProgressCallback | None) -> SideEnergy:
        """All stages."""
        energy = self._fit_level(store, progress)
        for stage in _stages(len(self._pose)):
            rows = self._order[: stage.rows]
            problem = PotentialLeastSquares(
                energy.network,
                self._pose[rows],
                self._force[rows],
                # One unit for all loads: their spread over the loaded samples.
                weights=1.0 / self._force[self._loaded].std(dim=0),
                scale=energy.scale,
                power=energy.power,
                precision=self._settings.precision,
                chunk_rows=self._settings.chunk_rows,
            )
            optimiser = LevenbergMarquardt(
                problem,
                energy.network.parameters,
                self._budget(stage),
                state=store.state(f"{self._side} {stage.name}"),
            )
            final = self._run(stage.name, optimiser, len(rows), store, progress)
            network = PotentialNetwork(
                self._input_map, energy.network.hidden, final.parameters.clone()
            )
            energy = SideEnergy(network, energy.scale, energy.power)
        return energy

    def _fit_level(self, store: Checkpoint, progress: ProgressCallback | None) -> SideEnergy:
        """The energy whose N fits Fy alone."""
        power = self._settings.power
        rows = self._order[: _LEVEL.rows]
        loaded = self._loaded[rows]
        inputs = self._input_map(self._pose[rows])
        level = (self._force[rows, FY].clamp(min=0) / self._max_fy) ** (1 / (power - 1))
        terms = quadratic_terms(inputs)
        terms = torch.cat([terms, torch.ones_like(terms[:, :1])], dim=1)
        # Normal equations, since LAPACK's own least squares round differently from call to call; the
        # ridge is for a coordinate that never moves.
        seen = terms[loaded]
        gram = seen.T @ seen
        gram.diagonal().add_(1e-9 * len(seen))
        right = seen.T @ level[loaded, None]
        quadratic = torch.cholesky_solve(right, torch.linalg.cholesky(gram))[:, 0]
        rest = (level - terms @ quadratic)[:, None]
        # A lifted sample is bounded from above, and far ones lie far above all bounds.
        output_map = MinMaxMap.from_data(rest[loaded])
        mlp = TanhMlp(self._input_map, output_map, self._settings.hidden)
        mlp.initialise(self._settings.seed)
        problem = MlpLeastSquares(
            mlp.widths,
            inputs,
            output_map(rest),
            one_sided=~loaded[:, None],
            chunk_rows=self._settings.chunk_rows,
        )
        name = _LEVEL.name
        optimiser = LevenbergMarquardt(
            problem,
            mlp.get_parameters(),
            self._budget(_LEVEL),
            state=store.state(f"{self._side} {name}"),
        )
        final = self._run(name, optimiser, len(rows), store, progress)
        mlp.set_parameters(final.parameters)
        network = PotentialNetwork.from_mlp(mlp, quadratic[:-1].clone(), float(quadratic[-1]))
        _, gradient, _ = network.second_order(self._pose[rows][loaded])
        steepness = float((-gradient[:, FY]).median())
        return SideEnergy(network, self._max_fy / (power * steepness), power)

    def _budget(self, stage: _Stage) -> LevenbergMarquardtSettings:
        settings = self._settings
        return LevenbergMarquardtSettings(
            max_epochs=max(1, round(stage.epochs * settings.max_epochs)),
            min_grad=settings.min_grad,
            time_s=stage.time * settings.time_budget_s,
            patience=settings.patience,
            min_relative_improvement=settings.min_relative_improvement,
            bayesian=stage.bayesian,
            alpha=_WEIGHT_DECAY,
        )

    def _run(
        self,
        stage: str,
        optimiser: LevenbergMarquardt,
        rows: int,
        store: Checkpoint,
        progress: ProgressCallback | None,
    ) -> LevenbergMarquardtState:
        name = f"{self._side} {stage}"
        limits = optimiser.settings

        def after_epoch(state: LevenbergMarquardtState) -> None:
            store.update(name, state)
            if progress is not None:
                left = 0.0
                if state.stop_reason is None:
                    pace = state.elapsed_s / max(state.epoch, 1)
                    left = pace * (limits.max_epochs - state.epoch)
                    left = min(left, limits.time_s - state.elapsed_s)
                loss, gamma = state.history["loss"][-1], state.gamma
                progress(name, state.epoch, loss, gamma, state.elapsed_s, left)

        final = optimiser.run(after_epoch)
        self.seconds += final.elapsed_s
        widths = (len(self._input_map.centre), *self._settings.hidden, 1)
        self.records.append(NetRecord.of(name, self._settings.seed, widths, rows, final))
        return final
