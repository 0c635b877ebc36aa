# SPDX-License-Identifier: Apache-2.0
"""Stage ``sample``: the reference contact at points of the sampled domains, as a dataset."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import condyle
from condyle.study.context import StudyContext
from condyle.study.simulation_files import read_simulation

if TYPE_CHECKING:
    from condyle.sampling import ReferenceCurves, SamplingPlan


def run(context: StudyContext) -> bool:
    """Samples the study's domains, going on from what an interrupted run has left."""
    inputs = {
        **context.study.canonical("contact", "sampling"),
        "implant": context.outputs_of("implant"),
        "reference": {
            name: digest
            for name, digest in context.outputs_of("reference").items()
            if name.endswith(".csv")
        },
        "version": condyle.__version__,
    }
    return context.directory.run_stage("sample", inputs, lambda: _sample(context))


def _sample(context: StudyContext) -> list[Path]:
    from condyle.sampling import SamplingProgress, sample
    from condyle.sampling.evaluate import equilibrium_solver

    plan = _plan(context)
    total = sum(target.total for target in plan.targets)
    domains = ", ".join(str(target.domain) for target in plan.targets)
    context.reporter.stage("sample", f"{total} samples in domains {domains}")

    def progress(p: SamplingProgress) -> None:
        what = "pilot" if p.round_number == 0 else f"round {p.round_number}"
        note = f"{what}: {p.done} of {p.round_size} candidates, {p.accepted} of {p.target} accepted"
        context.reporter.progress(f"domain {p.domain}", p.done / p.round_size, note)

    report = sample(
        plan,
        reference_curves(context),
        equilibrium_solver(context.reference, max_depth=plan.max_depth, threads=context.threads),
        context.directory.samples,
        context.identity(),
        progress,
    )
    summary = report.to_json()
    table = context.directory.write_table("samples", summary)
    cost = summary["evaluations_per_accepted"]
    rate = total / report.wall_time_s
    context.reporter.finished(
        "sample", f"{cost:.1f} contact evaluations per accepted sample, {rate:.0f} samples/s"
    )
    return [context.directory.samples / "manifest.json", table]


def reference_curves(context: StudyContext) -> ReferenceCurves:
    """The study's activities, as the reference stage simulated them."""
    from condyle.sampling import ReferenceCurves

    activities = {}
    for name in context.load_cases:
        trace = read_simulation(context.directory.simulations / f"{name}_reference.csv")
        activities[name] = (trace["time"], trace["poses"], trace["wrenches"])
    return ReferenceCurves.from_activities(activities)


def _plan(context: StudyContext) -> SamplingPlan:
    """The section's preset with the study's own numbers over it."""
    import dataclasses

    from condyle.sampling import SamplingPlan

    section = context.study.sampling
    plan = SamplingPlan.preset(section.preset, seed=section.seed)
    own = {
        int(d): {str(k): n for k, n in numbers.items()} for d, numbers in section.targets.items()
    }
    plan = plan.with_targets(own)
    return dataclasses.replace(
        plan,
        max_depth=1e-3 * context.study.contact.plausible_depth_mm,
        margin_x=1e-3 * section.margin_x_mm,
        margin_z=1e-3 * section.margin_z_mm,
        margin_theta_y=math.radians(section.margin_theta_y_deg),
    )
