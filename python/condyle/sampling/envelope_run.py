# SPDX-License-Identifier: Apache-2.0
"""The rounds of domain 1: every time frame has its own number of samples.

Where the load is low most of a time frame's box has no equilibrium, where it is high nearly all has;
a common round would leave the first with few samples. So a round draws, for each time frame that
still misses samples, a Hammersley set as large as the frame's own acceptance asks for, and the
keyed hash keeps the frame's number of its accepted candidates.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from condyle.sampling.chunk import PILOT_ROUND
from condyle.sampling.domain_envelopes import EnvelopeDomain
from condyle.sampling.domain_run import DomainRun, RunContext
from condyle.sampling.plan import DomainTarget
from condyle.sampling.selection import DROPPED, TRAIN, candidate_origin, keyed_hash


class EnvelopeRun(DomainRun):
    """See the module docstring."""

    def __init__(self, context: RunContext, target: DomainTarget, domain: EnvelopeDomain) -> None:
        super().__init__(context, target, domain)
        self._envelopes = domain
        self._drawn: dict[int, EnvelopeDomain] = {}
        #: (f,) samples that each time frame is to have.
        self._shares = _spread(target.total, len(domain.centres))

    def complete(self) -> dict[str, Any]:
        """Draw rounds until every time frame has its samples; the manifest's entry."""
        plan, frames = self.context.plan, len(self._shares)
        pilot = self._draw(
            PILOT_ROUND, plan.pilot, self._envelopes.with_sizes(_spread(plan.pilot, frames))
        )
        self._check_acceptance(pilot)
        first_rate = pilot.accepted / pilot.candidates
        drawn, accepted = np.zeros(frames, np.int64), np.zeros(frames, np.int64)
        # Beyond this many candidates a time frame has no equilibria worth looking for.
        most = np.ceil(self._shares / plan.min_acceptance).astype(np.int64)
        while np.any(accepted < self._shares):
            self._check_rounds()
            self._pass_on(accepted, drawn >= most)
            missing = np.maximum(self._shares - accepted, 0)
            # Its own acceptance, and the pilot's as that of one more accepted candidate.
            rate = (accepted + 1) / (drawn + 1 / first_rate)
            sizes = np.ceil(plan.oversampling * missing / rate).astype(np.int64)
            sizes = np.minimum(sizes, np.maximum(most - drawn, missing))
            number = len(self._rounds) + 1
            self._drawn[number] = self._envelopes.with_sizes(sizes)
            before = len(self.chunks)
            self._draw(number, int(sizes.sum()), self._drawn[number])
            drawn += sizes
            for chunk in self.chunks[before:]:
                found = self._frames_of(self.context.store.accepted_ids(chunk))
                accepted += np.bincount(found, minlength=frames)
        return self._entry(pilot) | {
            "samples_per_time_frame": [int(self._shares.min()), int(self._shares.max())]
        }

    def splits(self) -> NDArray[np.int8]:
        """TRAIN for each time frame's smallest hashes, DROPPED for the rest."""
        ids = self.accepted_ids()
        frames = self._frames_of(ids)
        order = np.lexsort((ids, keyed_hash(ids, self.context.plan.seed), frames))
        counts = np.bincount(frames, minlength=len(self._shares))
        firsts = np.repeat(np.cumsum(counts) - counts, counts)
        place = np.arange(len(ids)) - firsts  # in its time frame, by hash
        splits = np.full(len(ids), DROPPED, dtype=np.int8)
        splits[order[place < self._shares[frames[order]]]] = TRAIN
        return splits

    def _frames_of(self, ids: NDArray[np.uint64]) -> NDArray[np.int64]:
        frames = np.zeros(len(ids), dtype=np.int64)
        origins = np.array([candidate_origin(int(i))[1:] for i in ids], np.int64).reshape(-1, 2)
        for number in np.unique(origins[:, 0]):
            rows = origins[:, 0] == number
            frames[rows] = self._drawn[int(number)].frames_of(origins[rows, 1])
        return frames

    def _pass_on(self, accepted: NDArray[np.int64], given_up: NDArray[np.bool_]) -> None:
        """What a hopeless time frame still misses goes to the others, evenly."""
        short = given_up & (accepted < self._shares)
        if np.any(short) and not np.all(given_up):
            missing = int((self._shares - accepted)[short].sum())
            self._shares[short] = accepted[short]
            self._shares[~given_up] += _spread(missing, int((~given_up).sum()))


def _spread(total: int, places: int) -> NDArray[np.int64]:
    """``total`` over ``places`` (places,), as evenly in number and in place as integers allow."""
    return np.diff(np.arange(places + 1, dtype=np.int64) * total // places)
