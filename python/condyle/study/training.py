# SPDX-License-Identifier: Apache-2.0
"""From ``[training]`` to a trained surrogate: the settings, the architecture's trainer, what the screen says."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from condyle.study.reporter import Reporter
from condyle.study.training_section import TrainingSection

if TYPE_CHECKING:
    from condyle.training.architecture_search import ArchitectureSearchSettings
    from condyle.training.potential import PotentialSurrogate
    from condyle.training.record import TrainingRecord
    from condyle.training.settings import TrainingSettings
    from condyle.training.train import ProgressCallback
    from condyle.training.two_stage import TwoStageSurrogate

Array = NDArray[np.float64]
_MINUTE, _HOUR = 60.0, 3600.0


class Trainer(Protocol):
    """``train_two_stage`` and ``train_potential``."""

    def __call__(
        self,
        poses: Array,
        wrenches: Array,
        settings: TrainingSettings | None = None,
        *,
        progress: ProgressCallback | None = None,
        checkpoint: Path | None = None,
    ) -> tuple[TwoStageSurrogate | PotentialSurrogate, TrainingRecord]:
        """Trains on samples; resumes from the checkpoint if there is one."""
        ...


def trainer(section: TrainingSection) -> Trainer:
    """What trains the section's architecture."""
    if section.architecture == "potential":
        from condyle.training.train_potential import train_potential

        return train_potential
    from condyle.training.train import train_two_stage

    return train_two_stage


def training_settings(section: TrainingSection) -> TrainingSettings:
    """The section as the settings of a training."""
    from condyle.training.settings import TrainingSettings

    return TrainingSettings(
        hidden_layers=section.hidden_layers,
        neurons=section.neurons,
        max_epochs=section.max_epochs,
        time_budget_s=math.inf if section.time_budget_s is None else section.time_budget_s,
        patience=section.patience,
        precision=section.precision,
        power=section.power,
        seed=section.seed,
        threads=section.threads,
    )


def searched_settings(
    section: TrainingSection,
    poses: Array,
    wrenches: Array,
    checkpoint: Path,
    reporter: Reporter,
) -> tuple[TrainingSettings, dict[str, Any] | None]:
    """The section's settings, with layers and neurons as the search found them if there is one.

    Args:
        section: Of the study.
        poses: (n, 6) training poses.
        wrenches: (n, 2, 6) their wrenches.
        checkpoint: Of the search; a killed one goes on from there.
        reporter: Told of progress.

    Returns:
        The settings, and the search's record as JSON data; None without a search.
    """
    from condyle.training.architecture_search import search_architecture

    settings = training_settings(section)
    if not section.search.enabled:
        return settings, None
    search = _search_settings(section)
    settings, trials = search_architecture(
        poses,
        wrenches,
        settings,
        search,
        progress=TrainingProgress(reporter, "two_stage"),
        checkpoint=checkpoint,
    )
    return settings, {
        "performance": search.performance,
        "trial_time_s": search.trial_time_s,
        "trials": [dataclasses.asdict(trial) for trial in trials],
    }


def _search_settings(section: TrainingSection) -> ArchitectureSearchSettings:
    from condyle.training.architecture_search import ArchitectureSearchSettings

    return ArchitectureSearchSettings(
        max_layers=section.search.max_layers,
        max_neurons=section.search.max_neurons,
        performance=section.search.performance,
        trial_time_s=section.search.trial_time_s,
    )


class TrainingProgress:
    """Tells a reporter of a training's epochs: loss, γ, and the time left at most.

    Args:
        reporter: Told.
        architecture: ``two_stage`` trains three nets alike, so what the whole will take is known from the first.
        before: Of the text: what is being trained, if there are several.
    """

    _TWO_STAGE_NETS = ("I", "II", "III")

    def __init__(self, reporter: Reporter, architecture: str, before: str = "") -> None:
        self._reporter, self._before = reporter, before
        self._nets = self._TWO_STAGE_NETS if architecture == "two_stage" else ()

    def __call__(
        self, net: str, epoch: int, loss: float, gamma: float, seconds: float, left: float, /
    ) -> None:
        """See :class:`condyle.training.train.ProgressCallback`."""
        share = seconds / (seconds + left) if seconds + left > 0 else 1.0
        time_left = f"at most {duration(left)} left"
        if net in self._nets:
            index = self._nets.index(net)
            share = (index + share) / len(self._nets)
            rest = (len(self._nets) - 1 - index) * (seconds + left)
            time_left += f", {duration(left + rest)} for all nets"
        note = f"epoch {epoch}, mse {loss:.2e}, γ {gamma:.0f}, {time_left}"
        self._reporter.progress(f"{self._before}net {net}", min(max(share, 0.0), 1.0), note)


def duration(seconds: float) -> str:
    """A time for people: ``40 s``, ``12 min``, ``2.5 h``."""
    if seconds < 2 * _MINUTE:
        return f"{seconds:.0f} s"
    if seconds < 2 * _HOUR:
        return f"{seconds / _MINUTE:.0f} min"
    return f"{seconds / _HOUR:.1f} h"
