# SPDX-License-Identifier: Apache-2.0
"""The paper's search for the number of hidden layers and neurons (Marra et al. 2017).

Start with two hidden layers of ten neurons and train for a fixed time; accept if the performance
fell below 0.001; otherwise add ten neurons to each layer, up to forty, and then a layer. After
adding a layer the neurons start again from ten: the paper does not say so, but its outcome, 3 × 30
after 2 × 40 had failed, cannot be reached otherwise.

Performance is the mean squared error with inputs and outputs mapped to [-1, 1], regularisation
excluded.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from numpy.typing import ArrayLike

from condyle.errors import InputDataError
from condyle.training.checkpoint import Checkpoint
from condyle.training.input_data import check_samples, data_hash
from condyle.training.settings import TrainingSettings
from condyle.training.train import ProgressCallback, first_stage_problem, thread_count, train_net


@dataclass(frozen=True)
class ArchitectureSearchSettings:
    """The search's own settings; the defaults are the paper's.

    Attributes:
        start_layers: Hidden layers of the first trial.
        max_layers: Hidden layers of the last.
        start_neurons: Neurons a layer of the first trial with a number of layers.
        neuron_step: Added to each layer from trial to trial.
        max_neurons: Neurons a layer at most.
        performance: Mean squared error below which a trial is accepted.
        trial_time_s: Time of a trial [s].
    """

    start_layers: int = 2
    max_layers: int = 4
    start_neurons: int = 10
    neuron_step: int = 10
    max_neurons: int = 40
    performance: float = 1e-3
    trial_time_s: float = 3600.0

    def __post_init__(self) -> None:
        """Refuses values that leave nothing to try."""
        for name in ("start_layers", "start_neurons", "neuron_step", "performance", "trial_time_s"):
            if not getattr(self, name) > 0:
                raise InputDataError(
                    f"architecture search setting {name} is {getattr(self, name)!r}; it must be > 0"
                )
        for low, high in (("start_layers", "max_layers"), ("start_neurons", "max_neurons")):
            if getattr(self, high) < getattr(self, low):
                raise InputDataError(
                    f"architecture search setting {high} is {getattr(self, high)!r}; "
                    f"it must be >= {low} = {getattr(self, low)!r}"
                )


@dataclass(frozen=True)
class ArchitectureTrial:
    """One trial.

    Attributes:
        hidden_layers: Number of hidden layers.
        neurons: Neurons in each.
        performance: Mean squared error reached.
        epochs: Epochs it took.
        stop_reason: Why it ended ("goal": accepted).
        accepted: Whether the performance fell below the limit.
    """

    hidden_layers: int
    neurons: int
    performance: float
    epochs: int
    stop_reason: str
    accepted: bool


def candidate_architectures(search: ArchitectureSearchSettings) -> Iterator[tuple[int, int]]:
    """(hidden layers, neurons) in the order in which they are tried."""
    for layers in range(search.start_layers, search.max_layers + 1):
        for neurons in range(search.start_neurons, search.max_neurons + 1, search.neuron_step):
            yield layers, neurons


def search_architecture(
    poses: ArrayLike,
    wrenches: ArrayLike,
    settings: TrainingSettings,
    search: ArchitectureSearchSettings | None = None,
    *,
    progress: ProgressCallback | None = None,
    on_trial: Callable[[ArchitectureTrial], None] | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
) -> tuple[TrainingSettings, tuple[ArchitectureTrial, ...]]:
    """Finds the first architecture of net I that reaches the performance in the time of a trial.

    Args:
        poses: (n, 6) [m, rad].
        wrenches: (n, 2, 6) [N, Nm].
        settings: All but layers, neurons and time budget is used as it is.
        search: See :class:`ArchitectureSearchSettings`.
        progress: Told of every epoch; the net's name is e.g. "I 2x10".
        on_trial: Told of every finished trial.
        checkpoint: File written after every epoch. If it exists, finished trials are taken from it
            and the one that was killed goes on.

    Returns:
        ``settings`` with the accepted layers and neurons (where none was, those of the best trial),
        and all trials.

    Raises:
        InputDataError: Samples unfit for training, or a checkpoint of another search.
    """
    search = search or ArchitectureSearchSettings()
    poses, wrenches = check_samples(poses, wrenches, settings.min_loaded_rows)
    problem = first_stage_problem(poses, wrenches, settings)
    key = {
        "architecture_search": dataclasses.asdict(search),
        "data_hash": data_hash(poses, wrenches),
        **settings.to_dict(),
    }
    store = Checkpoint(None if checkpoint is None else Path(checkpoint), key)
    trials: list[ArchitectureTrial] = []
    with thread_count(settings.threads):
        for layers, neurons in candidate_architectures(search):
            trial_settings = dataclasses.replace(
                settings, hidden_layers=layers, neurons=neurons, time_budget_s=search.trial_time_s
            )
            name = f"I {layers}x{neurons}"
            _, state = train_net(
                name,
                problem,
                trial_settings,
                settings.seed,
                progress,
                store.state(name),
                store.update,
                goal=search.performance,
            )
            assert state.stop_reason is not None
            performance = state.history["loss"][-1]
            trial = ArchitectureTrial(
                layers,
                neurons,
                performance,
                state.epoch,
                state.stop_reason.value,
                performance < search.performance,
            )
            trials.append(trial)
            if on_trial is not None:
                on_trial(trial)
            if trial.accepted:
                break
    best = next((t for t in trials if t.accepted), min(trials, key=lambda t: t.performance))
    accepted = dataclasses.replace(settings, hidden_layers=best.hidden_layers, neurons=best.neurons)
    return accepted, tuple(trials)
