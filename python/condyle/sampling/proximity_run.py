# SPDX-License-Identifier: Apache-2.0
"""The rounds of domain 5: copies of contact boundary points, and which of them are kept.

The points are domain 4's own samples, each in its split, and as many of its spare accepted
candidates as are missing, used only here: 67 760 + 11 958 copies are of 16 940 points for training
(domain 4's 9 990 and 6 950 more) and 2 990 for testing (1 755 and 1 235 more). Four times 2 990 is
two copies too many: those of the largest hash are dropped.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.sampling.candidate_store import Tally
from condyle.sampling.domain_proximity import RAISES, ProximityDomain
from condyle.sampling.domain_run import DomainRun, RunContext, rejections
from condyle.sampling.domains import BoundaryPoints
from condyle.sampling.plan import DomainTarget, SamplingPlan
from condyle.sampling.selection import DROPPED, TEST, TRAIN, keyed_hash


def points_needed(plan: SamplingPlan) -> int:
    """Boundary points that domain 4 is to accept, for itself and for domain 5."""
    targets = {target.domain: target for target in plan.targets}
    boundary, proximity = targets[4], targets.get(ProximityDomain.number)
    if proximity is None:
        return boundary.total
    more = sum(max(0, n - own) for n, own in zip(_points(proximity), _own(boundary), strict=True))
    return boundary.total + more


class ProximityRun(DomainRun):
    """See the module docstring."""

    def __init__(
        self,
        context: RunContext,
        target: DomainTarget,
        boundary_target: DomainTarget,
        boundary: BoundaryPoints,
    ) -> None:
        super().__init__(context, target, ProximityDomain(boundary.poses[:0], boundary.ids[:0]))
        self._boundary = boundary
        order = np.lexsort((boundary.ids, keyed_hash(boundary.ids, context.plan.seed)))
        splits = boundary.splits[order]
        #: Rows of the boundary points by split, in the order in which they are used.
        self._queues = {code: order[splits == code] for code in (TRAIN, TEST)}
        self._spare = order[splits == DROPPED]
        for code, needed, own in zip(
            (TRAIN, TEST), _points(target), _own(boundary_target), strict=True
        ):
            self._lengthen(code, max(0, needed - own))
            self._queues[code] = self._queues[code][:needed]
        self._split_of: dict[int, int] = {}

    def complete(self) -> dict[str, Any]:
        """Evaluate copies until both splits have theirs; the manifest's entry."""
        waiting = self._queues
        wanted = {TRAIN: self.target.train, TEST: self.target.test}
        while any(len(rows) for rows in waiting.values()):
            self._check_rounds()
            for code, rows in waiting.items():
                self._split_of |= dict.fromkeys(self._boundary.ids[rows].tolist(), code)
            rows = np.sort(np.concatenate(list(waiting.values())))
            domain = ProximityDomain(self._boundary.poses[rows], self._boundary.ids[rows])
            self._draw(len(self._rounds) + 1, domain.copies, domain)
            codes = self._codes()
            missing = {code: n - int(np.sum(codes == code)) for code, n in wanted.items()}
            waiting = {code: self._more(math.ceil(n / len(RAISES))) for code, n in missing.items()}
        return self._entry(Tally()) | {"points": len(self._split_of)}

    def splits(self) -> NDArray[np.int8]:
        """The split of each copy's point; what is too many goes by the copy's own hash."""
        ids, codes = self.accepted_ids(), self._codes()
        order = np.lexsort((ids, keyed_hash(ids, self.context.plan.seed)))
        splits = np.full(len(ids), DROPPED, dtype=np.int8)
        for code, number in ((TRAIN, self.target.train), (TEST, self.target.test)):
            splits[order[codes[order] == code][:number]] = code
        return splits

    def _codes(self) -> NDArray[np.int8]:
        """The split of the point of each accepted copy."""
        sources = [self.context.store.accepted_ids(chunk, "source") for chunk in self.chunks]
        return np.array([self._split_of[int(i)] for i in np.concatenate(sources)], dtype=np.int8)

    def _lengthen(self, code: int, number: int) -> None:
        self._queues[code] = np.concatenate([self._queues[code], self._more(number)])

    def _more(self, number: int) -> NDArray[np.int64]:
        """The next spare points."""
        if number > len(self._spare):
            raise InputDataError(
                f"sampling domain 5: {number} more contact boundary points are needed and "
                f"{len(self._spare)} are left; {rejections(self._total)}"
            )
        more, self._spare = np.split(self._spare, [max(number, 0)])
        return more


def _points(proximity: DomainTarget) -> tuple[int, int]:
    """Points that domain 5's copies (train, test) are of."""
    return math.ceil(proximity.train / len(RAISES)), math.ceil(proximity.test / len(RAISES))


def _own(boundary: DomainTarget) -> tuple[int, int]:
    return boundary.train, boundary.test
