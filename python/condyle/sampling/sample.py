# SPDX-License-Identifier: Apache-2.0
"""Sampling: rounds of candidates until each domain has its numbers, then selection and split.

A domain's pilot estimates the acceptance a; round 1 is one complete Hammersley set of 1.1 · target
/ a candidates, all of them evaluated; as long as samples are missing, further complete sets,
shifted modulo 1, make up for them. Then the keyed hash keeps and splits
(:mod:`condyle.sampling.selection`).
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from condyle.errors import InputDataError
from condyle.sampling.candidate_store import CANDIDATES_FOLDER, CandidateStore, Tally, round_chunks
from condyle.sampling.domain import DOMAIN_NAMES, SamplingDomain
from condyle.sampling.domains import build_domains
from condyle.sampling.equilibrium_protocol import StaticEquilibriumSolver
from condyle.sampling.evaluate_chunk import ACCEPTED, Chunk
from condyle.sampling.manifest import MANIFEST_NAME, check_same_design, new_manifest, read_manifest
from condyle.sampling.plan import DomainTarget, SamplingPlan
from condyle.sampling.reference_curves import ReferenceCurves
from condyle.sampling.report import DomainReport, Progress, SamplingProgress, SamplingReport
from condyle.sampling.run_log import RunLog
from condyle.sampling.sample_parts import check_sample_parts, write_sample_parts
from condyle.whole_files import remove_leftovers, to_canonical_json, write_whole


def sample(
    plan: SamplingPlan,
    curves: ReferenceCurves,
    solver: StaticEquilibriumSolver,
    directory: Path,
    identity: Mapping[str, Any],
    progress: Progress | None = None,
    *,
    executor: Executor | None = None,
) -> SamplingReport:
    """Sample a plan into a directory; a run that was stopped, however, goes on where it was.

    The dataset is the same, byte for byte, whether or not the run was interrupted and whatever the
    executor.

    Args:
        plan: What to sample.
        curves: What to sample around.
        solver: Solves prescribed equilibria; with an executor of threads it must be safe to call
            from several.
        directory: The dataset's: manifest.json, samples/ (what to read), candidates/ (working
            store), run.log.
        identity: What is sampled, as JSON values: hashes of implant and contact law, side of body,
            ….
        progress: Called after each chunk.
        executor: Evaluates chunks (threads, processes, a cluster's); in this thread when None.

    Returns:
        Counts, acceptance and cost a domain.

    Raises:
        InputDataError: The directory cannot be written or holds another design's samples, a part is
            damaged, or a domain accepts too few candidates. Parts that are written stay.
    """
    started = time.perf_counter()
    directory = Path(directory)
    domains = build_domains(plan, curves)
    with RunLog(directory) as log:
        remove_leftovers(directory)
        manifest, resumed = _open_manifest(directory, new_manifest(plan, curves, identity))
        if manifest["complete"] and check_sample_parts(directory, manifest):
            log.write("complete already")
            return _report(manifest, started, resumed=True)
        log.write(f"start: {'resumed' if resumed else 'new'}, design {manifest['design_hash']}")
        manifest = {**manifest, "complete": False, "domains": [], "parts": []}
        _write_manifest(directory, manifest)
        store = CandidateStore(directory, manifest["design_hash"], plan, solver, executor)
        chunks: dict[int, list[Chunk]] = {}
        for target in plan.targets:
            run = _DomainRun(plan, target, domains[target.domain], store, progress, log)
            manifest["domains"].append(run.complete())
            chunks[target.domain] = run.chunks
            _write_manifest(directory, manifest)
        manifest["parts"] = write_sample_parts(
            directory, manifest["design_hash"], plan, store, chunks
        )
        manifest["complete"] = True
        _write_manifest(directory, manifest)
        report = _report(manifest, started, resumed)
        log.write(f"complete: {report.samples} samples, {report.wall_time_s:.3f} s in this run")
        return report


def _open_manifest(directory: Path, wanted: dict[str, Any]) -> tuple[dict[str, Any], bool]:
    """The manifest to go on with, and whether there was one."""
    path = directory / MANIFEST_NAME
    if not path.exists():
        if (directory / CANDIDATES_FOLDER).exists():
            raise InputDataError(
                f"{directory} holds {CANDIDATES_FOLDER}/ but no {MANIFEST_NAME}; "
                "sample into another directory"
            )
        return wanted, False
    found = read_manifest(directory)
    check_same_design(path, found, wanted)
    # Of a complete dataset nothing may change; an incomplete one is finished by this version.
    return (found if found["complete"] else wanted), True


def _write_manifest(directory: Path, manifest: dict[str, Any]) -> None:
    write_whole(directory / MANIFEST_NAME, (to_canonical_json(manifest) + "\n").encode())


def _report(manifest: dict[str, Any], started: float, resumed: bool) -> SamplingReport:
    rows = tuple(DomainReport.from_manifest(entry) for entry in manifest["domains"])
    return SamplingReport(rows, time.perf_counter() - started, resumed)


class _DomainRun:
    """The rounds of one domain."""

    def __init__(
        self,
        plan: SamplingPlan,
        target: DomainTarget,
        domain: SamplingDomain,
        store: CandidateStore,
        progress: Progress | None,
        log: RunLog,
    ) -> None:
        self._plan = plan
        self._target = target
        self._domain = domain
        self._store = store
        self._progress = progress
        self._log = log
        self._total = Tally()  # of the rounds that can be kept
        self.chunks: list[Chunk] = []

    def complete(self) -> dict[str, Any]:
        """Draw rounds until the target is met; the manifest's entry for the domain."""
        pilot = self._draw(0, self._plan.pilot)
        self._check_acceptance(pilot)
        estimate = Tally()
        estimate.merge(pilot)
        rounds: list[dict[str, int]] = []
        while self._total.accepted < self._target.total:
            if len(rounds) == self._plan.max_rounds:
                raise InputDataError(
                    f"sampling domain {self._target.domain}: {self._total.accepted} of "
                    f"{self._target.total} samples after {len(rounds)} rounds "
                    f"(max_rounds); {_rejections(self._total)}"
                )
            missing = self._target.total - self._total.accepted
            size = math.ceil(
                self._plan.oversampling * missing * estimate.candidates / estimate.accepted
            )
            tally = self._draw(len(rounds) + 1, size)
            rounds.append({"candidates": tally.candidates, "accepted": tally.accepted})
            self._total.merge(tally)
            estimate.merge(tally)
        return {
            "domain": self._target.domain,
            "name": DOMAIN_NAMES[self._target.domain],
            "definition": self._domain.describe(),
            "train": self._target.train,
            "test": self._target.test,
            "pilot": {"candidates": pilot.candidates, "accepted": pilot.accepted},
            "rounds": rounds,
            "candidates": self._total.candidates,
            "accepted": self._total.accepted,
            "rejected": _rejected(self._total),
            "evaluations": dict(sorted(self._total.evaluations.items())),
        }

    def _draw(self, round_number: int, size: int) -> Tally:
        number, tally = self._target.domain, Tally()
        planned = round_chunks(number, round_number, size, self._plan.chunk_rows)
        for chunk, record in self._store.evaluate(planned, self._domain):
            tally.add(record)
            if round_number > 0:
                self.chunks.append(chunk)
            if self._progress is not None:
                accepted = self._total.accepted + (tally.accepted if round_number > 0 else 0)
                self._progress(
                    SamplingProgress(
                        number, round_number, chunk.stop, size, accepted, self._target.total
                    )
                )
        self._log.write(
            f"domain {number} round {round_number}: {tally.accepted} of {size} accepted; "
            f"{_rejections(tally)}"
        )
        return tally

    def _check_acceptance(self, pilot: Tally) -> None:
        share = pilot.accepted / pilot.candidates
        if share < self._plan.min_acceptance:
            raise InputDataError(
                f"sampling domain {self._target.domain} ({DOMAIN_NAMES[self._target.domain]}): "
                f"{pilot.accepted} of {pilot.candidates} pilot candidates are accepted, "
                f"fewer than min_acceptance = {self._plan.min_acceptance:.6g} of them; "
                f"{_rejections(pilot)}: "
                "do the reference curves belong to this implant?"
            )


def _rejected(tally: Tally) -> dict[str, int]:
    return {reason: count for reason, count in sorted(tally.counts.items()) if reason != ACCEPTED}


def _rejections(tally: Tally) -> str:
    reasons = ", ".join(f"{count} {reason}" for reason, count in _rejected(tally).items())
    return f"rejected: {reasons or 'none'}"
