# SPDX-License-Identifier: Apache-2.0
"""How long force-dependent kinematics of recorded activities takes, by what evaluates the knee's contact.

    OMP_NUM_THREADS=1 .venv/bin/python tests/benchmarks/fdk_speed.py [SURROGATE.onnx]

Subject DM (CONDYLE_DATA, or shared/data beside the project; needs `opensim` for the first run). On one core, in one
run: the right foot's stance in gait with `exact`, `fast` and the surrogate, then the windows of
docs/examples/dm_trials.toml with the latter two, once with the patella's own six coordinates and once with it on a
hinge, as the paper had it. Timed is the equilibrium solution of all time frames, dynamics, paths, ligaments and muscles
included, but no reading, no meshes' preparation and no pressures. The patella's contact, where it has one, is `fast`.
Contact models take turns, and the quickest of their repeats counts.
"""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import dataclass
from pathlib import Path

from dm_trial import CACHE, MUSCLES, ROOT, DmTrial, dm_contacts, read_dm_trial

from condyle.evaluation.paper_activities import PAPER_TIMES
from condyle.fdk import BodyContact, TrialSimulation, TrialSimulationSettings, simulate_trial

STANCE = ("DM_ngait_og1", 2.406, 3.125)  # [s]
WINDOWS = (
    ("DM_ngait_og1", 2.0, 3.5),
    ("DM_bouncy5", 1.5, 3.05),
    ("DM_smooth1", 2.15, 3.7),
    ("DM_crouch_tm1", 1.428, 5.8),
)
KINDS = ("exact", "fast", "surrogate")


@dataclass(frozen=True)
class Timing:
    """The quickest of the repeats.

    Attributes:
        seconds: of all time frames.
        found: what was simulated in them.
    """

    seconds: float
    found: TrialSimulation


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser()
    default = ROOT / "runs" / "dm_trials" / "surrogate.onnx"
    parser.add_argument("surrogate", nargs="?", type=Path, default=default)
    parser.add_argument("--repeats", type=int, default=7, help="of fast and surrogate")
    parser.add_argument("--exact-repeats", type=int, default=2)
    parser.add_argument("--cache", type=Path, default=CACHE)
    options = parser.parse_args()
    if not options.surrogate.is_file():
        parser.error(
            f"{options.surrogate}: no such file; `condyle run docs/examples/dm_trials.toml` makes one"
        )
    load = os.getloadavg()[0]
    print(f"one thread; load average {load:.1f} on {os.cpu_count()} cores at the start")
    report("stance", STANCE, KINDS, options)
    for window in WINDOWS:
        report("six coordinates of the patella", window, KINDS[1:], options)
        report("patella on a hinge", window, KINDS[1:], options, hinged=True)


def report(
    title: str,
    window: tuple[str, float, float],
    kinds: tuple[str, ...],
    options: argparse.Namespace,
    *,
    hinged: bool = False,
) -> None:
    """Measures a window and prints its tables."""
    name, start, end = window
    subject = read_dm_trial(name, start, end, options.cache, hinged=hinged)
    contacts = {
        kind: dm_contacts(subject, kind, options.surrogate if kind == "surrogate" else None)
        for kind in kinds
    }
    repeats = {
        kind: options.exact_repeats if kind == "exact" else options.repeats for kind in kinds
    }
    timings = measure(subject, contacts, repeats)
    print(f"\n{name}, {title}, {start} to {end} s, {len(subject.trial)} time frames\n")
    print_times(timings, subject)
    print_phases(timings)


def measure(
    subject: DmTrial, contacts: dict[str, list[BodyContact]], repeats: dict[str, int]
) -> dict[str, Timing]:
    """Simulates with each in turn, round after round, so that a busy spell of the machine befalls all."""
    settings = TrialSimulationSettings()
    settings.threads = 1
    best: dict[str, Timing] = {}
    for round_ in range(max(repeats.values())):
        for kind, pair in contacts.items():
            if round_ >= repeats[kind]:
                continue
            begun = time.perf_counter()
            found = simulate_trial(subject.model, subject.trial, pair, MUSCLES, settings)
            seconds = time.perf_counter() - begun
            if kind not in best or seconds < best[kind].seconds:
                best[kind] = Timing(seconds, found)
    return best


def print_times(timings: dict[str, Timing], subject: DmTrial) -> None:
    """A row a contact model, then the ratios."""
    times = subject.trial.times
    duration = times[-1] - times[0]
    print(
        "| contact | converged | in parts or softened first | s | µs a time frame | evaluations a time frame | "
        "times real time |"
    )
    print("|---|---|---|---|---|---|---|")
    for kind, timing in timings.items():
        frames = len(times)
        records = timing.found.records
        evaluations = sum(record.evaluations for record in records) / frames
        hard = sum(record.approach != "start" for record in records)
        converged = frames - timing.found.not_converged
        each = 1e6 * timing.seconds / frames
        print(
            f"| {kind} | {converged}/{frames} | {hard} | {timing.seconds:.4g} | {each:.0f} | {evaluations:.1f} | "
            f"{duration / timing.seconds:.3g} |"
        )
    last = timings["surrogate"].seconds
    ratios = " : ".join(f"{timing.seconds / last:.3g}" for timing in timings.values())
    paper = PAPER_TIMES["normal gait"]
    print(
        f"\n{' : '.join(timings)} = {ratios}; the paper's reference : surrogate = {paper.speed_improvement:g} : 1 "
        f"({60 * paper.reference_min / paper.time_frames:.2g} and "
        f"{60 * paper.surrogate_min / paper.time_frames:.2g} s a time frame)"
    )


def print_phases(timings: dict[str, Timing]) -> None:
    """µs a time frame by phase; the rest is what no phase counts, above all where to begin: seating the knee, once."""
    phases = list(next(iter(timings.values())).found.seconds())
    print(f"\n| µs a time frame | {' | '.join(phases)} | rest |")
    print("|---" * (len(phases) + 2) + "|")
    for kind, timing in timings.items():
        frames = len(timing.found.times)
        seconds = timing.found.seconds()
        each = [1e6 * seconds[phase] / frames for phase in phases]
        rest = 1e6 * timing.seconds / frames - sum(each)
        print(f"| {kind} | " + " | ".join(f"{value:.0f}" for value in [*each, rest]) + " |")


if __name__ == "__main__":
    main()
