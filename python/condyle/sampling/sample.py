# SPDX-License-Identifier: Apache-2.0
"""Sampling: the rounds of every domain (:mod:`condyle.sampling.domain_run`), then the samples."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from condyle.conventions import POSE_COLUMNS
from condyle.errors import InputDataError
from condyle.sampling.candidate_store import CANDIDATES_FOLDER, CandidateStore
from condyle.sampling.domain_envelopes import EnvelopeDomain
from condyle.sampling.domain_run import DomainRun, RunContext
from condyle.sampling.domains import BoundaryPoints, DomainInputs, build_domain
from condyle.sampling.envelope_run import EnvelopeRun
from condyle.sampling.equilibrium_protocol import StaticEquilibriumSolver
from condyle.sampling.executors import ChunkExecutor
from condyle.sampling.manifest import MANIFEST_NAME, check_same_design, new_manifest, read_manifest
from condyle.sampling.part_files import columns_array
from condyle.sampling.plan import DomainTarget, SamplingPlan
from condyle.sampling.proximity_run import ProximityRun, points_needed
from condyle.sampling.reference_curves import ReferenceCurves
from condyle.sampling.report import DomainReport, Progress, SamplingReport
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
    executor: ChunkExecutor | None = None,
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
        executor: Evaluates chunks: any of concurrent.futures (threads, processes), or a cluster's
            (:func:`condyle.sampling.cluster.cluster_executor`); in this thread when None.

    Returns:
        Counts, acceptance and cost a domain.

    Raises:
        InputDataError: The directory cannot be written or holds another design's samples, a part is
            damaged, or a domain accepts too few candidates. Parts that are written stay.
        CondyleError: The executor's workers cannot go on, or would compute other bytes.
    """
    started = time.perf_counter()
    directory = Path(directory)
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
        context = RunContext(plan, store, progress, log)
        runs: dict[int, DomainRun] = {}
        for target in plan.targets:
            run = _domain_run(context, target, DomainInputs(plan, curves, solver), runs)
            manifest["domains"].append(run.complete())
            runs[target.domain] = run
            _write_manifest(directory, manifest)
        manifest["parts"] = write_sample_parts(
            directory, manifest["design_hash"], store, list(runs.values())
        )
        manifest["complete"] = True
        _write_manifest(directory, manifest)
        report = _report(manifest, started, resumed)
        log.write(f"complete: {report.samples} samples, {report.wall_time_s:.3f} s in this run")
        return report


def _domain_run(
    context: RunContext,
    target: DomainTarget,
    inputs: DomainInputs,
    runs: Mapping[int, DomainRun],
) -> DomainRun:
    """The run of a domain, those before it being complete."""
    if target.domain in (5, 6):
        points = _boundary_points(runs[4])
        if target.domain == 5:
            return ProximityRun(context, target, runs[4].target, points)
        inputs = DomainInputs(inputs.plan, inputs.curves, inputs.solver, points)
    domain = build_domain(target.domain, inputs)
    if isinstance(domain, EnvelopeDomain):
        return EnvelopeRun(context, target, domain)
    needed = points_needed(context.plan) if target.domain == 4 else None
    return DomainRun(context, target, domain, needed)


def _boundary_points(run: DomainRun) -> BoundaryPoints:
    tables = [run.context.store.accepted(chunk) for chunk in run.chunks]
    poses = np.concatenate([columns_array(table, POSE_COLUMNS) for table in tables])
    return BoundaryPoints(run.accepted_ids(), poses, run.splits())


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
