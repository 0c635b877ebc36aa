# SPDX-License-Identifier: Apache-2.0
"""Training of the two-stage surrogate: net I, then nets II and III, each by Levenberg-Marquardt.

Seeded, resumable after a kill with the identical result, and quiet: what happens is told to a
callback.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from condyle.conventions import SIDES
from condyle.training.checkpoint import Checkpoint
from condyle.training.input_data import FY, check_samples, data_hash
from condyle.training.levenberg_marquardt import (
    LevenbergMarquardt,
    LevenbergMarquardtSettings,
    LevenbergMarquardtState,
)
from condyle.training.mlp_least_squares import MlpLeastSquares
from condyle.training.networks import MinMaxMap, TanhMlp
from condyle.training.record import NetRecord, TrainingRecord, versions
from condyle.training.settings import TrainingSettings
from condyle.training.two_stage import (
    FIRST_STAGE_LOADS,
    NET_NAMES,
    SECOND_STAGE_LOADS,
    TwoStageSurrogate,
)


class ProgressCallback(Protocol):
    """Told of every epoch. Raising from it ends the training; a checkpoint then holds the state."""

    def __call__(
        self, net: str, epoch: int, loss: float, gamma: float, seconds: float, time_left: float, /
    ) -> None:
        """Net, epochs done, mean squared error (mapped), γ, seconds spent, at most left."""
        ...


@dataclass(frozen=True)
class NetProblem:
    """What one network is to learn.

    Attributes:
        inputs: (n, d_in) SI.
        targets: (n, d_out) SI.
        weights: (n, d_out) ≥ 0, or None for ones.
        one_sided: (n, d_out) bool, target is an upper bound; or None.
        known: (n,) bool, rows that the input map is made of; or None for all.
    """

    inputs: Tensor
    targets: Tensor
    weights: Tensor | None = None
    one_sided: Tensor | None = None
    known: Tensor | None = None


def train_two_stage(
    poses: ArrayLike,
    wrenches: ArrayLike,
    settings: TrainingSettings | None = None,
    *,
    progress: ProgressCallback | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
) -> tuple[TwoStageSurrogate, TrainingRecord]:
    """Trains a two-stage surrogate on samples of a contact model.

    Args:
        poses: (n, 6) [m, rad], each once.
        wrenches: (n, 2, 6) [N, Nm], zero on lifted sides.
        settings: See :class:`~condyle.training.settings.TrainingSettings`.
        progress: See :class:`ProgressCallback`.
        checkpoint: File written after every epoch (whole or not at all). If it exists, training
            goes on from it, with the same result as without the interruption as long as no time
            budget ends it.

    Returns:
        The surrogate and the record of its training.

    Raises:
        InputDataError: Samples unfit for training, or a checkpoint of another training.
    """
    settings = settings or TrainingSettings()
    poses, wrenches = check_samples(poses, wrenches, settings.min_loaded_rows)
    key = {"data_hash": data_hash(poses, wrenches), **settings.to_dict()}
    store = Checkpoint(None if checkpoint is None else Path(checkpoint), key)
    nets: list[TanhMlp] = []
    records: list[NetRecord] = []
    times: dict[str, float] = {}
    with thread_count(settings.threads):
        for index, name in enumerate(NET_NAMES):
            if index == 0:
                problem = first_stage_problem(poses, wrenches, settings)
            else:
                problem = second_stage_problem(poses, wrenches, index - 1, settings, nets[0])
            seed = settings.seed + index
            net, state = train_net(
                name, problem, settings, seed, progress, store.state(name), store.update
            )
            nets.append(net)
            records.append(NetRecord.of(name, seed, net.widths, len(problem.inputs), state))
            times[name] = state.elapsed_s
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
    return TwoStageSurrogate(nets[0], (nets[1], nets[2])), record


def first_stage_problem(
    poses: NDArray[np.float64], wrenches: NDArray[np.float64], settings: TrainingSettings
) -> NetProblem:
    """Net I: pose → (Fy, Mx) of both sides. See ``TrainingSettings.lift_off`` for lifted sides."""
    targets = torch.from_numpy(
        np.ascontiguousarray(wrenches[:, :, FIRST_STAGE_LOADS].reshape(len(poses), -1))
    )
    inputs = torch.from_numpy(poses)
    if settings.lift_off == "zero":
        return NetProblem(inputs, targets)
    # A side that pulls (an implausible pose, caught under the insert's rim) is gated as if lifted.
    lifted = torch.from_numpy(wrenches[:, :, FY] <= 0)
    targets[:, ::2] = targets[:, ::2].clamp(min=0.0)
    # Poses far out of contact must not stretch the map that the near ones share.
    known = ~lifted.all(dim=1)
    never = torch.zeros_like(lifted)
    one_sided = torch.stack([lifted, never], dim=2).flatten(1)
    weights = 1.0 - torch.stack([never, lifted], dim=2).flatten(1).to(torch.float64)
    return NetProblem(inputs, targets, weights, one_sided, known)


def second_stage_problem(
    poses: NDArray[np.float64],
    wrenches: NDArray[np.float64],
    side: int,
    settings: TrainingSettings,
    first: TanhMlp,
) -> NetProblem:
    """Net II (side 0) or III (side 1): pose, Fy, Mx → (Fx, Fz, My, Mz), of loaded rows."""
    pose = torch.from_numpy(poses)
    wrench = torch.from_numpy(wrenches[:, side])
    sensitive = wrench[:, list(FIRST_STAGE_LOADS)]
    loaded = sensitive[:, 0] > 0
    if settings.second_stage_inputs == "predicted":
        with torch.no_grad():
            sensitive = first(pose).view(-1, len(SIDES), 2)[:, side]
        loaded &= sensitive[:, 0] > 0
    inputs = torch.cat([pose, sensitive], dim=1)
    return NetProblem(inputs[loaded], wrench[:, list(SECOND_STAGE_LOADS)][loaded])


def train_net(
    name: str,
    problem: NetProblem,
    settings: TrainingSettings,
    seed: int,
    progress: ProgressCallback | None = None,
    state: LevenbergMarquardtState | None = None,
    save: Callable[[str, LevenbergMarquardtState], None] | None = None,
    goal: float = 0.0,
) -> tuple[TanhMlp, LevenbergMarquardtState]:
    """Trains one network.

    Args:
        name: For ``progress`` and ``save``.
        problem: What to learn.
        settings: Layers, epochs, time budget, precision.
        seed: Of the initial weights.
        progress: See :class:`ProgressCallback`.
        state: To resume from.
        save: Called with the name and state after every epoch.
        goal: Mean squared error (mapped) at which to stop.

    Returns:
        The network and the optimiser's final state.
    """
    known = problem.inputs if problem.known is None else problem.inputs[problem.known]
    net = TanhMlp(MinMaxMap.from_data(known), MinMaxMap.from_data(problem.targets), settings.hidden)
    net.initialise(seed)
    errors = MlpLeastSquares(
        net.widths,
        net.input_map(problem.inputs),
        net.output_map(problem.targets),
        weights=problem.weights,
        one_sided=problem.one_sided,
        precision=settings.precision,
        chunk_rows=settings.chunk_rows,
    )
    optimiser = LevenbergMarquardt(
        errors, net.get_parameters(), _optimiser_settings(settings, goal), state=state
    )

    def after_epoch(current: LevenbergMarquardtState) -> None:
        if save is not None:
            save(name, current)
        if progress is not None:
            left = _time_left(current, settings)
            progress(
                name,
                current.epoch,
                current.history["loss"][-1],
                current.gamma,
                current.elapsed_s,
                left,
            )

    final = optimiser.run(after_epoch)
    net.set_parameters(final.parameters)
    return net, final


def _optimiser_settings(settings: TrainingSettings, goal: float) -> LevenbergMarquardtSettings:
    return LevenbergMarquardtSettings(
        max_epochs=settings.max_epochs,
        goal=goal,
        min_grad=settings.min_grad,
        time_s=settings.time_budget_s,
        patience=settings.patience,
        min_relative_improvement=settings.min_relative_improvement,
    )


def _time_left(state: LevenbergMarquardtState, settings: TrainingSettings) -> float:
    """Upper bound on a net's remaining time [s] from its pace so far; 0 when it has stopped."""
    if state.stop_reason is not None:
        return 0.0
    pace = state.elapsed_s / max(state.epoch, 1)
    return min(pace * (settings.max_epochs - state.epoch), settings.time_budget_s - state.elapsed_s)


@contextmanager
def thread_count(count: int) -> Iterator[None]:
    """Sets torch's thread count, which is global to the process, and puts it back."""
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)
