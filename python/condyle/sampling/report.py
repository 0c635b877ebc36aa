# SPDX-License-Identifier: Apache-2.0
"""What a sampling run says about itself: progress, and the paper's Table 1 when it is done."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from condyle.sampling.domain import DOMAIN_NAMES, PAPER_COUNTS
from condyle.sampling.evaluate_chunk import INFEASIBLE


@dataclass(frozen=True)
class SamplingProgress:
    """Where a run is, after each chunk.

    Attributes:
        domain: The paper's number.
        round_number: 0 is the pilot.
        done: Candidates evaluated in this round.
        round_size: Candidates of this round.
        accepted: Accepted in the domain so far; the pilot's are not counted.
        target: To be accepted in the domain: what it keeps, and what another one takes from it.
        candidates: Of this chunk.
        evaluations: Contact evaluations spent on this chunk.
        fresh: Whether the chunk was evaluated now; otherwise it was there already.
    """

    domain: int
    round_number: int
    done: int
    round_size: int
    accepted: int
    target: int
    candidates: int
    evaluations: int
    fresh: bool


Progress = Callable[[SamplingProgress], None]


@dataclass(frozen=True)
class DomainReport:
    """One domain's row.

    Attributes:
        domain: The paper's number.
        train: Samples kept for training.
        test: Samples kept for testing.
        candidates: Evaluated, the pilot not counted.
        accepted: Of these.
        rejected: Of these, by reason.
        two_sided: Of the accepted ones, those with a load on both sides.
        rounds: Rounds drawn.
        solver_evaluations: Contact evaluations spent on candidates that statics allow.
    """

    domain: int
    train: int
    test: int
    candidates: int
    accepted: int
    rejected: Mapping[str, int]
    two_sided: int
    rounds: int
    solver_evaluations: int

    @property
    def name(self) -> str:
        """What the domain is called."""
        return DOMAIN_NAMES[self.domain]

    @property
    def acceptance(self) -> float:
        """Accepted over candidates."""
        return self.accepted / self.candidates

    @property
    def feasible_acceptance(self) -> float:
        """Accepted over the candidates that statics allow."""
        return self.accepted / (
            self.candidates - sum(self.rejected.get(reason, 0) for reason in INFEASIBLE)
        )

    @property
    def evaluations_per_accepted(self) -> float:
        """Contact evaluations an accepted sample costs, infeasible candidates not counted."""
        return self.solver_evaluations / self.accepted

    @classmethod
    def from_manifest(cls, entry: Mapping[str, Any]) -> DomainReport:
        """From a manifest's ``domains`` entry."""
        evaluations = entry["evaluations"]
        return cls(
            domain=entry["domain"],
            train=entry["train"],
            test=entry["test"],
            candidates=entry["candidates"],
            accepted=entry["accepted"],
            rejected=dict(entry["rejected"]),
            two_sided=entry["two_sided"],
            rounds=len(entry["rounds"]),
            solver_evaluations=sum(
                n for status, n in evaluations.items() if status not in INFEASIBLE
            ),
        )

    def to_json(self) -> dict[str, Any]:
        """A row of the table, the paper's counts beside it."""
        paper_train, paper_test = PAPER_COUNTS[self.domain]
        return {
            "domain": self.domain,
            "name": self.name,
            "train": self.train,
            "test": self.test,
            "paper_train": paper_train,
            "paper_test": paper_test,
            "candidates": self.candidates,
            "accepted": self.accepted,
            "acceptance": self.acceptance,
            "feasible_acceptance": self.feasible_acceptance,
            "rejected": dict(self.rejected),
            "two_sided": self.two_sided,
            "rounds": self.rounds,
            "evaluations_per_accepted": self.evaluations_per_accepted,
        }


@dataclass(frozen=True)
class SamplingReport:
    """A whole run.

    Attributes:
        domains: One report a domain, in the plan's order.
        wall_time_s: Of this call; little when it found the dataset complete.
        resumed: Whether part of the dataset was there already.
    """

    domains: tuple[DomainReport, ...]
    wall_time_s: float
    resumed: bool

    @property
    def samples(self) -> int:
        """Kept in all domains."""
        return sum(domain.train + domain.test for domain in self.domains)

    def to_json(self) -> dict[str, Any]:
        """For tables.json: the domains' rows (Table 1) and the totals."""
        accepted = sum(domain.accepted for domain in self.domains)
        return {
            "domains": [domain.to_json() for domain in self.domains],
            "train": sum(domain.train for domain in self.domains),
            "test": sum(domain.test for domain in self.domains),
            "evaluations_per_accepted": sum(domain.solver_evaluations for domain in self.domains)
            / accepted,
            "wall_time_s": self.wall_time_s,
            "resumed": self.resumed,
        }
