# SPDX-License-Identifier: Apache-2.0
"""What happened in a training: everything needed to repeat it and to judge it, as JSON."""

from __future__ import annotations

import platform
from dataclasses import asdict, dataclass, field
from importlib import metadata
from typing import Any

import numpy as np
import torch

from condyle.training.levenberg_marquardt import LevenbergMarquardtState, StopReason


@dataclass(frozen=True)
class NetRecord:
    """Training of one network.

    Attributes:
        name: "I", "II" (medial) or "III" (lateral).
        seed: Seed of its initial weights.
        widths: Layer widths, inputs first.
        n_parameters: P.
        n_rows: Samples it learned from.
        epochs: Epochs done.
        stop_reason: One of ``trainbr``'s names (or "patience").
        loss: Final mean squared error with outputs mapped to [-1, 1].
        history: Per epoch: loss, gamma, alpha, beta, mu.
    """

    name: str
    seed: int
    widths: tuple[int, ...]
    n_parameters: int
    n_rows: int
    epochs: int
    stop_reason: str
    loss: float
    history: dict[str, list[float]]

    @classmethod
    def of(
        cls,
        name: str,
        seed: int,
        widths: tuple[int, ...],
        n_rows: int,
        state: LevenbergMarquardtState,
    ) -> NetRecord:
        """The record of a finished optimiser state."""
        assert state.stop_reason is not None
        return cls(
            name=name,
            seed=seed,
            widths=widths,
            n_parameters=state.parameters.numel(),
            n_rows=n_rows,
            epochs=state.epoch,
            stop_reason=state.stop_reason.value,
            loss=state.history["loss"][-1],
            history={key: list(values) for key, values in state.history.items()},
        )

    @property
    def advice(self) -> str:
        """One sentence on what the stop reason means."""
        return StopReason(self.stop_reason).advice


@dataclass(frozen=True)
class TrainingRecord:
    """Training of a surrogate; ``to_dict`` is reproducible for equal inputs and threads.

    Attributes:
        settings: The :class:`~condyle.training.settings.TrainingSettings` as a dictionary.
        n_samples: Samples given.
        n_loaded: Samples in which the (medial, lateral) side is loaded.
        data_hash: SHA-256 of poses and wrenches.
        versions: Of Python, numpy and torch.
        nets: One record a network.
        wall_times_s: Wall time of each network [s]; not part of ``to_dict``.
    """

    settings: dict[str, Any]
    n_samples: int
    n_loaded: tuple[int, int]
    data_hash: str
    versions: dict[str, str]
    nets: tuple[NetRecord, ...]
    wall_times_s: dict[str, float] = field(default_factory=dict, compare=False)

    def to_dict(self, *, history: bool = True) -> dict[str, Any]:
        """JSON-able; without ``history`` short enough for a model file's metadata."""
        values = asdict(self)
        del values["wall_times_s"]
        values["n_loaded"] = list(self.n_loaded)
        values["nets"] = [{**asdict(net), "widths": list(net.widths)} for net in self.nets]
        for net in values["nets"]:
            final = {key: net["history"][key][-1] for key in ("gamma", "alpha", "beta")}
            net.update(final)
            if not history:
                del net["history"]
        return values


def versions() -> dict[str, str]:
    """Versions that the numbers depend on."""
    found = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "torch": torch.__version__,
    }
    try:
        found["condyle"] = metadata.version("condyle")
    except metadata.PackageNotFoundError:
        found["condyle"] = "not installed"
    return found
