# SPDX-License-Identifier: Apache-2.0
"""``[training]`` of a study: which surrogate, and how it is trained.

``search`` is ``true`` or a table of its own::

    [training.search]
    trial_time_s = 600
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from condyle.study.section import Positive, Section

#: Settings that a search chooses, and settings that only one architecture has.
_SEARCHED = ("hidden_layers", "neurons")


class SearchSection(Section):
    """The paper's search for layers and neurons: 2 × 10 first, then ten neurons more at a time, then a layer.

    Attributes:
        enabled: whether there is a search; naming this section switches it on.
        performance: mean squared error (inputs and outputs mapped to [-1, 1]) below which a trial is accepted.
        trial_time_s: wall time of a trial; where it ends one, the outcome depends on the machine.
        max_layers: hidden layers of the last trials.
        max_neurons: neurons a layer at most.
    """

    enabled: bool = True
    performance: Positive = 1e-3
    trial_time_s: Positive = 3600.0
    max_layers: Annotated[int, Field(ge=2, le=6)] = 4
    max_neurons: Annotated[int, Field(ge=10, le=200)] = 40


class TrainingSection(Section):
    """The surrogate's networks and their training.

    Attributes:
        architecture: ``potential`` (an energy a side, conservative by construction) or ``two_stage`` (the paper's three
            networks).
        hidden_layers: hidden layers of each network.
        neurons: in each of them.
        max_epochs: Levenberg-Marquardt iterations at most, a network.
        time_budget_s: wall time at most, a network (``potential``: a side); where it ends a training, the result
            depends on the machine.
        patience: iterations over which the loss must fall by 1 %, or the training ends; 0: no such rule.
        precision: of the normal equations' products: ``float64``, or ``mixed`` (float32 products, float64 sums), which
            an energy's do not stand.
        power: exponent of ``potential``'s energy in its depth; above 2 for a wrench that is smooth at lift-off.
        search: the paper's search for layers and neurons, of ``two_stage``: true, or its settings.
        seed: of the initial weights.
        threads: of the linear algebra; part of the record, since it may change the last digits.
    """

    architecture: Literal["potential", "two_stage"] = "potential"
    hidden_layers: Annotated[int, Field(ge=1, le=6)] = 3
    neurons: Annotated[int, Field(ge=1, le=200)] = 30
    max_epochs: Annotated[int, Field(ge=1)] = 60
    time_budget_s: Positive | None = None
    patience: Annotated[int, Field(ge=0)] = 20
    precision: Literal["float64", "mixed"] = "float64"
    power: Annotated[float, Field(gt=2, le=6)] = 2.5
    search: SearchSection = SearchSection(enabled=False)
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 1
    threads: Annotated[int, Field(ge=1, le=256)] = 2

    @field_validator("search", mode="before")
    @classmethod
    def _on_or_off(cls, value: Any) -> Any:
        return {"enabled": value} if isinstance(value, bool) else value

    @model_validator(mode="after")
    def _settings_of_the_architecture(self) -> Self:
        if "power" in self.model_fields_set and self.architecture != "potential":
            raise ValueError('power goes with architecture = "potential" only')
        if self.precision == "mixed" and self.architecture == "potential":
            raise ValueError(
                'precision = "mixed" goes with architecture = "two_stage" only: '
                "an energy's normal equations need float64"
            )
        if self.search.enabled:
            if self.architecture != "two_stage":
                raise ValueError('search goes with architecture = "two_stage" only')
            given = [name for name in _SEARCHED if name in self.model_fields_set]
            if given:
                raise ValueError(f"{given[0]} does not go with search, which chooses it")
        return self
