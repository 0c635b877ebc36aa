# SPDX-License-Identifier: Apache-2.0
"""Rate, acceptance and time left over a whole run."""

import dataclasses
import itertools
from pathlib import Path

import pytest
from spring_contact import SpringSolver, spring_curves

from condyle.sampling import DomainTarget, SamplingPlan, SamplingProgress, sample
from condyle.sampling.run_estimate import RunEstimate, RunEstimator, duration_text

PLAN = SamplingPlan(
    targets=(
        DomainTarget(1, 83, 0),
        DomainTarget(2, 170, 30),
        DomainTarget(3, 68, 12),
        DomainTarget(4, 170, 30),
        DomainTarget(5, 230, 42),
        DomainTarget(6, 17, 3),
    ),
    seed=2017,
    pilot=48,
    chunk_rows=40,
)
#: Seconds a contact evaluation and a candidate take on the clock of these tests.
PACE = 0.013


class Work:
    """A clock that goes as work is done."""

    def __init__(self) -> None:
        self.now = 1711.0

    def __call__(self) -> float:
        return self.now

    def do(self, step: SamplingProgress) -> None:
        self.now += PACE * (step.evaluations + step.candidates) if step.fresh else 0.0


@pytest.fixture(scope="module")
def steps(tmp_path_factory: pytest.TempPathFactory) -> list[SamplingProgress]:
    seen: list[SamplingProgress] = []
    directory: Path = tmp_path_factory.mktemp("run")
    sample(PLAN, spring_curves(), SpringSolver(), directory, {}, seen.append)
    return seen


def follow(steps: list[SamplingProgress]) -> tuple[list[RunEstimate], list[float]]:
    """Estimates after each step, and the time at each."""
    clock = Work()
    estimator = RunEstimator(PLAN, clock)
    estimates, times = [], []
    for step in steps:
        clock.do(step)
        estimates.append(estimator.update(step))
        times.append(clock.now)
    return estimates, times


def test_the_fraction_rises_to_one_and_never_falls(steps: list[SamplingProgress]) -> None:
    fractions = [estimate.fraction for estimate in follow(steps)[0]]
    assert all(a <= b for a, b in itertools.pairwise(fractions))
    assert 0 < fractions[0] < 0.05
    # All candidates are drawn: what may be missing is a later round that was not needed.
    assert fractions[-1] == pytest.approx(1.0)


def test_time_left_is_that_of_the_whole_run(steps: list[SamplingProgress]) -> None:
    estimates, times = follow(steps)
    assert times[-1] - times[0] > 30
    for estimate, now in zip(estimates, times, strict=True):
        left = times[-1] - now
        # Before the domains are known their usual cost stands for them: the springs' is another, by less than three.
        assert left / 3 - 2.0 < estimate.seconds_left < 3 * left + 2.0
    # Half-way through domain 5 nearly everything is known: 15 % and the last domain's guess.
    late = [i for i, step in enumerate(steps) if step.domain == 5][4]
    assert estimates[late].seconds_left == pytest.approx(times[-1] - times[late], rel=0.15, abs=1.0)


def test_rate_and_acceptance_are_the_steps_own(steps: list[SamplingProgress]) -> None:
    estimates, times = follow(steps)
    ten = steps[:10]
    assert times[9] - 1711.0 < 60  # within the window
    rate = sum(step.candidates for step in ten) / (times[9] - 1711.0)
    assert estimates[9].candidates_per_s == pytest.approx(rate, rel=1e-9)
    last = [i for i, step in enumerate(steps) if step.domain == 2][-1]
    drawn = sum(s.candidates for s in steps if s.domain == 2 and s.round_number > 0)
    assert estimates[last].acceptance == pytest.approx(steps[last].accepted / drawn)
    assert estimates[0].acceptance is None  # the pilot's are not kept


def test_what_was_stored_counts_as_done_and_not_as_speed(steps: list[SamplingProgress]) -> None:
    half = len(steps) // 2
    resumed = [dataclasses.replace(s, fresh=i >= half) for i, s in enumerate(steps)]
    estimates, times = follow(resumed)
    before = estimates[half - 1]
    assert before.fraction > 0.3
    assert before.candidates_per_s is None and before.seconds_left is None
    assert estimates[half].candidates_per_s == pytest.approx(
        resumed[half].candidates / (times[half] - 1711.0), rel=1e-9
    )


def test_texts() -> None:
    assert [duration_text(s) for s in (0.4, 89.0, 91.0, 3540.0, 11400.0)] == [
        "0 s",
        "89 s",
        "2 min",
        "59 min",
        "3 h 10 min",
    ]
    whole = RunEstimate(0.3, 1234.4, 0.43, 125.0)
    assert whole.text() == "1234 candidates/s, 43 % accepted, 2 min left".replace("43 %", "43%")
    assert RunEstimate(0.1, None, None, None).text() == ""
