# SPDX-License-Identifier: Apache-2.0
"""How many samples of which domain, and everything else that decides what a dataset holds.

Two runs of one plan around the same curves with the same solver give the same bytes.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from condyle.errors import InputDataError
from condyle.sampling.domain import PAPER_COUNTS
from condyle.sampling.equilibrium_protocol import PRESCRIBED_COLUMNS, SENSITIVE_COLUMNS

DOMAINS_AVAILABLE: Final = (1, 2, 3, 4, 5, 6)


@dataclass(frozen=True)
class DomainTarget:
    """How many samples to keep in one domain.

    Attributes:
        domain: The paper's number.
        train: Samples for training.
        test: Samples for testing.
    """

    domain: int
    train: int
    test: int

    def __post_init__(self) -> None:
        """Checks."""
        if self.domain not in DOMAINS_AVAILABLE:
            known = ", ".join(str(number) for number in DOMAINS_AVAILABLE)
            raise InputDataError(f"sampling plan: domain is {self.domain!r}; available are {known}")
        if self.train < 1 or self.test < 0:
            raise InputDataError(
                f"sampling plan: domain {self.domain} has train = {self.train} and "
                f"test = {self.test}; at least 1 and 0 are needed"
            )
        if self.domain == 1 and self.test:
            raise InputDataError(
                f"sampling plan: domain 1 has test = {self.test}; it must be 0: "
                "simulated activities test that domain"
            )

    @property
    def total(self) -> int:
        """Train and test together."""
        return self.train + self.test


@dataclass(frozen=True)
class SamplingPlan:
    """See the module docstring.

    Attributes:
        targets: What to keep, one target a domain, in the domains' order. Domains 5 and 6 start from
            domain 4's samples.
        seed: Keys the selection and the split, and shifts every round after the first.
        sensitive_directions: Where domains 1, 2 and 4 prescribe the load and the pose is solved for:
            ``("y", "theta_x")``, or ``("y",)`` and θx is part of the pose that they draw.
        max_depth: Overclosure beyond which a sample is rejected [m] (the paper's filter).
        widening: Length of a widened score range over the curves' own.
        margin_x: Reference curves are thickened by ± this in x [m].
        margin_z: Likewise in z [m].
        margin_theta_y: Likewise in θy [rad].
        boundary_max_Fy: Domain 4 has Fy in [0, this] [N].
        boundary_max_Mx: Domain 4 has Mx in ± this [Nm].
        single_sided_max_Fy: Domain 3 has Fy in [0, this] [N].
        envelope_points: Samples a time frame in domain 1; so many time frames share its target.
        far_max_y: Domain 6 reaches up to this y [m].
        min_theta_z: Candidates flexed further are infeasible [rad]: no component articulates beyond
            120° of flexion.
        max_theta_z: Candidates extended further are infeasible [rad]: 15° of hyperextension.
        pilot: Candidates of the pilot, which estimates a domain's acceptance and is not kept.
        oversampling: Candidates drawn over candidates expected to be needed.
        min_acceptance: A pilot that accepts a smaller share stops the run: the curves do not fit
            the implant.
        chunk_rows: Candidates that are evaluated and written together; a kill loses one chunk at
            most.
        max_rounds: Rounds of candidates before giving up.
    """

    targets: tuple[DomainTarget, ...]
    seed: int
    sensitive_directions: tuple[str, ...] = SENSITIVE_COLUMNS
    max_depth: float = 2e-3
    widening: float = 1.5
    margin_x: float = 1e-3
    margin_z: float = 1e-3
    margin_theta_y: float = math.radians(1.0)
    boundary_max_Fy: float = 100.0
    boundary_max_Mx: float = 5.0
    single_sided_max_Fy: float = 100.0
    envelope_points: int = 20
    far_max_y: float = 0.1
    min_theta_z: float = math.radians(-120.0)
    max_theta_z: float = math.radians(15.0)
    pilot: int = 512
    oversampling: float = 1.1
    min_acceptance: float = 0.01
    chunk_rows: int = 2048
    max_rounds: int = 10

    def __post_init__(self) -> None:
        """Checks.

        Raises:
            InputDataError: A value outside its limits; the message names the field, the value and
                the limit.
        """
        if self.sensitive_directions not in (SENSITIVE_COLUMNS, SENSITIVE_COLUMNS[:1]):
            raise InputDataError(
                f"sampling plan: sensitive_directions is {self.sensitive_directions!r}; "
                "('y', 'theta_x') or ('y',) is needed"
            )
        ordered = sorted(self.targets, key=lambda target: target.domain)
        object.__setattr__(self, "targets", tuple(ordered))
        numbers = [target.domain for target in self.targets]
        if not numbers or len(set(numbers)) != len(numbers):
            raise InputDataError(
                f"sampling plan: targets are for domains {numbers}; each domain once, at least one"
            )
        if 4 not in numbers and (5 in numbers or 6 in numbers):
            raise InputDataError(
                f"sampling plan: targets are for domains {numbers}; 5 and 6 start from the samples "
                "of 4, which is needed too"
            )
        limits = {
            "seed": (0, 2**63 - 1),
            "max_depth": (1e-6, 0.1),
            "widening": (1.0, 10.0),
            "margin_x": (0.0, 0.02),
            "margin_z": (0.0, 0.02),
            "margin_theta_y": (0.0, 0.5),
            "boundary_max_Fy": (1e-3, 1e5),
            "boundary_max_Mx": (1e-6, 1e4),
            "single_sided_max_Fy": (1e-3, 1e5),
            "envelope_points": (1, 1_000_000),
            "far_max_y": (1e-3, 1.0),
            "min_theta_z": (-math.pi, 0.0),
            "max_theta_z": (0.0, math.pi),
            "pilot": (16, 1_000_000),
            "oversampling": (1.0, 10.0),
            "min_acceptance": (1e-6, 1.0),
            "chunk_rows": (1, 1_000_000),
            "max_rounds": (1, 1_000),
        }
        for name, (low, high) in limits.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputDataError(
                    f"sampling plan: {name} is {value!r}; it must be {low:.6g} to {high:.6g}"
                )

    @classmethod
    def preset(cls, name: str, *, seed: int) -> SamplingPlan:
        """A plan by name.

        ``quick`` (12 200 samples, 7 000 of them in contact on both sides) and ``standard`` (twice
        that) cover domains 2 to 6; ``paper`` has the paper's 154 310 in all six domains,
        ``paper_tenth`` a tenth of each.

        Raises:
            InputDataError: No such preset.
        """
        if name not in _PRESETS:
            raise InputDataError(
                f"sampling preset is {name!r}; available are {', '.join(_PRESETS)}"
            )
        return cls(targets=_PRESETS[name], seed=seed)

    def with_targets(self, targets: Mapping[int, Mapping[str, int]]) -> SamplingPlan:
        """This plan with other numbers: ``{2: {"train": 5000, "test": 900}}``.

        What is not named stays. A domain that the plan does not have is added, one without training
        samples (``{"train": 0}``) is left out.
        """
        named = {target.domain: target for target in self.targets}
        for domain, numbers in targets.items():
            unknown = sorted(set(numbers) - {"train", "test"})
            if unknown:
                raise InputDataError(
                    f"sampling plan: domain {domain} has an unknown target {unknown[0]!r}; "
                    "train and test are known"
                )
            old = named.get(domain)
            train = numbers.get("train", old.train if old else 0)
            if train == 0 and not numbers.get("test"):
                named.pop(domain, None)
                continue
            named[domain] = DomainTarget(domain, train, numbers.get("test", old.test if old else 0))
        return dataclasses.replace(self, targets=tuple(named[domain] for domain in sorted(named)))

    @property
    def drawn_columns(self) -> tuple[str, ...]:
        """What domains 1 and 2 draw: PRESCRIBED_COLUMNS, with θx for Mx where that is not sensitive."""
        given = "Mx" if "theta_x" in self.sensitive_directions else "theta_x"
        return tuple(given if name == "Mx" else name for name in PRESCRIBED_COLUMNS)

    @property
    def margins(self) -> dict[str, float]:
        """Thickening of the reference curves, by variable."""
        return {"x": self.margin_x, "z": self.margin_z, "theta_y": self.margin_theta_y}

    def to_json(self) -> dict[str, object]:
        """All fields, for a manifest."""
        return dataclasses.asdict(self) | {
            "targets": [dataclasses.asdict(target) for target in self.targets]
        }


def _small(times: int) -> tuple[DomainTarget, ...]:
    """Domains 2 to 6, train : test as 85 : 15, domain 2 : domain 4 about the paper's 2.6 : 1."""
    train = {2: 4_250, 3: 850, 4: 1_700, 5: 3_400, 6: 170}
    test = {2: 750, 3: 150, 4: 300, 5: 600, 6: 30}
    return tuple(DomainTarget(d, times * train[d], times * test[d]) for d in train)


#: The paper's counts are its Table 1's.
_PRESETS: Final = {
    "quick": _small(1),
    "standard": _small(2),
    "paper_tenth": (
        DomainTarget(1, 1_806, 0),
        DomainTarget(2, 2_725, 342),
        DomainTarget(3, 1_000, 177),
        DomainTarget(4, 999, 176),
        DomainTarget(5, 6_776, 1_196),
        DomainTarget(6, 200, 35),
    ),
    "paper": tuple(DomainTarget(domain, *counts) for domain, counts in PAPER_COUNTS.items()),
}
