# SPDX-License-Identifier: Apache-2.0
"""The rounds of one domain, and which of its candidates are kept.

A pilot estimates the acceptance a; round 1 is one complete Hammersley set of 1.1 · target / a
candidates, all of them evaluated; as long as samples are missing, further complete sets, shifted
modulo 1, make up for them. Then the keyed hash keeps and splits (:mod:`condyle.sampling.selection`).
Domains whose rounds are made otherwise derive from :class:`DomainRun`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.sampling.candidate_store import CandidateStore, Tally
from condyle.sampling.chunk import PILOT_ROUND, Chunk, round_chunks
from condyle.sampling.domain import DOMAIN_NAMES, SamplingDomain
from condyle.sampling.evaluate_chunk import ACCEPTED
from condyle.sampling.plan import DomainTarget, SamplingPlan
from condyle.sampling.report import Progress, SamplingProgress
from condyle.sampling.run_log import RunLog
from condyle.sampling.selection import assign_splits


@dataclass(frozen=True)
class RunContext:
    """What the runs of all domains share."""

    plan: SamplingPlan
    store: CandidateStore
    progress: Progress | None
    log: RunLog


class DomainRun:
    """See the module docstring.

    Args:
        context: The sampling run's.
        target: What to keep.
        domain: Where to draw.
        needed: Accepted candidates to draw; the target's total by default, more where another
            domain takes the rest.
    """

    def __init__(
        self,
        context: RunContext,
        target: DomainTarget,
        domain: SamplingDomain,
        needed: int | None = None,
    ) -> None:
        self.context = context
        self.target = target
        self.needed = target.total if needed is None else needed
        #: Of the rounds that can be kept.
        self.chunks: list[Chunk] = []
        self._domain = domain
        self._total = Tally()
        self._rounds: list[dict[str, int]] = []

    def complete(self) -> dict[str, Any]:
        """Draw rounds until the target is met; the manifest's entry for the domain."""
        pilot = self._draw(PILOT_ROUND, self.context.plan.pilot, self._domain)
        self._check_acceptance(pilot)
        estimate = Tally()
        estimate.merge(pilot)
        while self._total.accepted < self.needed:
            self._check_rounds()
            missing = self.needed - self._total.accepted
            size = math.ceil(
                self.context.plan.oversampling * missing * estimate.candidates / estimate.accepted
            )
            estimate.merge(self._draw(len(self._rounds) + 1, size, self._domain))
        return self._entry(pilot)

    def splits(self) -> NDArray[np.int8]:
        """The split of every accepted candidate, in candidate order."""
        return assign_splits(
            self.accepted_ids(),
            seed=self.context.plan.seed,
            train=self.target.train,
            test=self.target.test,
        )

    def accepted_ids(self) -> NDArray[np.uint64]:
        """All accepted candidates, in candidate order."""
        return np.concatenate([self.context.store.accepted_ids(chunk) for chunk in self.chunks])

    def _draw(self, round_number: int, size: int, domain: SamplingDomain) -> Tally:
        number, tally = self.target.domain, Tally()
        kept = round_number != PILOT_ROUND
        planned = round_chunks(number, round_number, size, self.context.plan.chunk_rows)
        for chunk, record, fresh in self.context.store.evaluate(planned, domain):
            tally.add(record)
            if kept:
                self.chunks.append(chunk)
            if self.context.progress is not None:
                accepted = self._total.accepted + (tally.accepted if kept else 0)
                self.context.progress(
                    SamplingProgress(
                        number,
                        round_number,
                        chunk.stop,
                        size,
                        accepted,
                        self.needed,
                        chunk.stop - chunk.start,
                        sum(record["evaluations"].values()),
                        fresh,
                    )
                )
        self.context.log.write(
            f"domain {number} round {round_number}: {tally.accepted} of {size} accepted; "
            f"{rejections(tally)}"
        )
        if kept:
            self._rounds.append({"candidates": tally.candidates, "accepted": tally.accepted})
            self._total.merge(tally)
        return tally

    def _entry(self, pilot: Tally) -> dict[str, Any]:
        return {
            "domain": self.target.domain,
            "name": DOMAIN_NAMES[self.target.domain],
            "definition": self._domain.describe(),
            "train": self.target.train,
            "test": self.target.test,
            "needed": self.needed,
            "pilot": {"candidates": pilot.candidates, "accepted": pilot.accepted},
            "rounds": self._rounds,
            "candidates": self._total.candidates,
            "accepted": self._total.accepted,
            "two_sided": self._total.two_sided,
            "rejected": _rejected(self._total),
            "evaluations": dict(sorted(self._total.evaluations.items())),
        }

    def _check_acceptance(self, pilot: Tally) -> None:
        share = pilot.accepted / pilot.candidates
        if share < self.context.plan.min_acceptance:
            raise InputDataError(
                f"sampling domain {self.target.domain} ({DOMAIN_NAMES[self.target.domain]}): "
                f"{pilot.accepted} of {pilot.candidates} pilot candidates are accepted, "
                f"fewer than min_acceptance = {self.context.plan.min_acceptance:.6g} of them; "
                f"{rejections(pilot)}: "
                "do the reference curves belong to this implant?"
            )

    def _check_rounds(self) -> None:
        if len(self._rounds) == self.context.plan.max_rounds:
            raise InputDataError(
                f"sampling domain {self.target.domain}: {self._total.accepted} of "
                f"{self.needed} samples after {len(self._rounds)} rounds "
                f"(max_rounds); {rejections(self._total)}"
            )


def rejections(tally: Tally) -> str:
    """A tally's rejections, for a message."""
    reasons = ", ".join(f"{count} {reason}" for reason, count in _rejected(tally).items())
    return f"rejected: {reasons or 'none'}"


def _rejected(tally: Tally) -> Mapping[str, int]:
    return {reason: count for reason, count in sorted(tally.counts.items()) if reason != ACCEPTED}
