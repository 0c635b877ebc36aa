# SPDX-License-Identifier: Apache-2.0
"""Settings of a surrogate's training."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any, Literal

from condyle.errors import InputDataError
from condyle.training.mlp_least_squares import Precision


@dataclass(frozen=True)
class TrainingSettings:
    """How a surrogate's networks are trained.

    Attributes:
        hidden_layers: Number of hidden layers of each network (the paper: 3).
        neurons: Neurons in each of them (the paper: 30).
        max_epochs: Epochs of a network, at most.
        time_budget_s: Time of a network, at most [s]; where this ends a training, its result
            depends on the machine's speed.
        patience: Epochs over which the loss must fall by ``min_relative_improvement``; 0: no such
            rule.
        min_relative_improvement: See ``patience``.
        min_grad: Gradient at which a training has converged.
        lift_off: What net I learns of a side that carries no load. ``one_sided``: only that Fy ≤ 0,
            which is all that the zero gate needs; ``zero``: Fy = Mx = 0, as the samples say. See
            :mod:`condyle.training.two_stage`.
        second_stage_inputs: Whether nets II and III learn from the ``true`` Fy and Mx or from those
            that net I ``predicted``, which are what they will be given in use.
        power: p of the potential surrogate's energy, > 2; see :mod:`condyle.training.potential`.
        seed: Seed of the initial weights.
        threads: Threads of the linear algebra; part of the record, since rounding depends on it.
        precision: Of the normal equations' products.
        chunk_rows: Samples at a time in the normal equations.
        min_loaded_rows: Fewest samples in which each side must be loaded.
    """

    hidden_layers: int = 3
    neurons: int = 30
    max_epochs: int = 150
    time_budget_s: float = math.inf
    patience: int = 20
    min_relative_improvement: float = 1e-2
    min_grad: float = 1e-7
    lift_off: Literal["one_sided", "zero"] = "one_sided"
    second_stage_inputs: Literal["true", "predicted"] = "predicted"
    power: float = 2.5
    seed: int = 1
    threads: int = 1
    precision: Precision = "float64"
    chunk_rows: int = 1024
    min_loaded_rows: int = 100

    def __post_init__(self) -> None:
        """Refuses values that cannot be meant."""
        for name in (
            "hidden_layers",
            "neurons",
            "max_epochs",
            "threads",
            "chunk_rows",
            "min_loaded_rows",
        ):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise InputDataError(
                    f"training setting {name} is {value!r}; it must be an integer >= 1"
                )
        if not self.time_budget_s > 0:
            raise InputDataError(
                f"training setting time_budget_s is {self.time_budget_s!r}; it must be > 0"
            )
        if self.patience < 0:
            raise InputDataError(f"training setting patience is {self.patience!r}; it must be >= 0")
        if not 2 < self.power <= 6:
            raise InputDataError(
                f"training setting power is {self.power!r}; it must be above 2, at most 6"
            )
        if self.seed < 0:
            raise InputDataError(f"training setting seed is {self.seed!r}; it must be >= 0")
        for name, allowed in (
            ("lift_off", ("one_sided", "zero")),
            ("second_stage_inputs", ("true", "predicted")),
            ("precision", ("float64", "mixed")),
        ):
            if getattr(self, name) not in allowed:
                raise InputDataError(
                    f"training setting {name} is {getattr(self, name)!r}; "
                    f"it must be one of {', '.join(allowed)}"
                )

    @property
    def hidden(self) -> tuple[int, ...]:
        """Width of every hidden layer."""
        return (self.neurons,) * self.hidden_layers

    def to_dict(self) -> dict[str, Any]:
        """JSON-able; an unlimited time budget is None."""
        values = asdict(self)
        if math.isinf(self.time_budget_s):
            values["time_budget_s"] = None
        return values
