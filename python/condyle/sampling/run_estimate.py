# SPDX-License-Identifier: Apache-2.0
"""How far a whole sampling run is, and how long it will still take: an estimate for a screen, never for a dataset.

Work is counted in contact evaluations and candidates together: a candidate costs something even where none is needed.
What a domain costs is known from its own candidates as soon as there are some; before, from what other implants took.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from condyle.sampling.chunk import PILOT_ROUND
from condyle.sampling.plan import SamplingPlan
from condyle.sampling.proximity_run import points_needed
from condyle.sampling.report import SamplingProgress

#: Contact evaluations and candidates for each sample of a domain that has not begun: rounded from a parametric implant
#: and DM.
_USUAL_WORK: Final = {1: 6.0, 2: 5.0, 3: 8.0, 4: 24.0, 5: 2.5, 6: 2.5}
#: A pilot candidate's, and the domain that has no pilot: its points are another one's.
_PILOT_WORK: Final = 2.5
_NO_PILOT: Final = 5
#: Rates are of the last so many seconds.
_WINDOW_S: Final = 60.0


@dataclass(frozen=True)
class RunEstimate:
    """Where a run stands.

    Attributes:
        fraction: Of the whole run's work, 0 to 1; never falls.
        candidates_per_s: Evaluated lately; None before anything was.
        acceptance: Accepted over candidates of this domain so far, the pilot not counted; None in the pilot.
        seconds_left: Of the whole run; None before a rate is known.
    """

    fraction: float
    candidates_per_s: float | None
    acceptance: float | None
    seconds_left: float | None

    def text(self) -> str:
        """For people: ``1 234 candidates/s, 43 % accepted, 2 min left``."""
        parts = []
        if self.candidates_per_s is not None:
            parts.append(f"{self.candidates_per_s:.0f} candidates/s")
        if self.acceptance is not None:
            parts.append(f"{self.acceptance:.0%} accepted")
        if self.seconds_left is not None:
            parts.append(f"{duration_text(self.seconds_left)} left")
        return ", ".join(parts)


def duration_text(seconds: float) -> str:
    """As coarse as an estimate is: ``40 s``, ``12 min``, ``3 h 10 min``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"


class RunEstimator:
    """Follows a run's progress, chunk by chunk.

    Args:
        plan: The run's.
        clock: Seconds from any start.
    """

    def __init__(self, plan: SamplingPlan, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._oversampling = plan.oversampling
        self._pilot = plan.pilot
        self._needed = {target.domain: target.total for target in plan.targets}
        if 4 in self._needed:
            self._needed[4] = points_needed(plan)
        #: Work and candidates of each domain so far; accepted ones in rounds that count.
        self._work = dict.fromkeys(self._needed, 0)
        self._candidates = dict.fromkeys(self._needed, 0)
        self._in_rounds = dict.fromkeys(self._needed, 0)
        self._fraction = 0.0
        #: (time, work, candidates) of what was evaluated now.
        self._recent: deque[tuple[float, int, int]] = deque()
        self._began = clock()

    def update(self, step: SamplingProgress) -> RunEstimate:
        """Takes the next chunk in."""
        domain, work = step.domain, step.evaluations + step.candidates
        self._work[domain] += work
        self._candidates[domain] += step.candidates
        if step.round_number != PILOT_ROUND:
            self._in_rounds[domain] += step.candidates
        now = self._clock()
        if step.fresh:
            self._recent.append((now, work, step.candidates))
        elif not self._recent:
            self._began = now  # reading what is there already is not the rate
        while self._recent and self._recent[0][0] < now - _WINDOW_S:
            self._began = self._recent.popleft()[0]
        seconds = now - self._began
        left = self._left(step)
        done = sum(self._work.values())
        self._fraction = max(self._fraction, done / (done + left)) if done else 0.0
        acceptance = None
        if self._in_rounds[domain]:
            acceptance = step.accepted / self._in_rounds[domain]
        if seconds <= 0 or not self._recent:
            return RunEstimate(self._fraction, None, acceptance, None)
        lately = sum(item[1] for item in self._recent)
        rate = sum(item[2] for item in self._recent) / seconds
        return RunEstimate(self._fraction, rate, acceptance, left * seconds / lately)

    def _left(self, step: SamplingProgress) -> float:
        """Work that is left."""
        later = [domain for domain in self._needed if domain > step.domain]
        pilots = sum(domain != _NO_PILOT for domain in later) * self._pilot * _PILOT_WORK
        usual = sum(_USUAL_WORK[domain] * self._needed[domain] for domain in later)
        return usual + pilots + self._left_here(step)

    def _left_here(self, step: SamplingProgress) -> float:
        domain, accepted = step.domain, step.accepted
        if step.round_number == PILOT_ROUND or not accepted:
            return _USUAL_WORK[domain] * self._needed[domain]
        each = self._work[domain] / self._candidates[domain]
        drawn = step.round_size - step.done
        if drawn:
            # A round is as large as it takes. Its first candidates say little of the others' acceptance: they are of
            # one end of the domain, for sets and time frames are drawn in order.
            return each * drawn
        missing = max(0, step.target - accepted) * self._in_rounds[domain] / accepted
        return each * self._oversampling * missing
