# SPDX-License-Identifier: Apache-2.0
"""Stage ``sample``: the reference contact at points of the sampled domains, as a dataset."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import condyle
from condyle.study.context import StudyContext
from condyle.study.curves import curves_file, make_curves, sensitive_directions
from condyle.study.external_samples import adopt_samples
from condyle.study.sample_figures import draw_sample_figures

if TYPE_CHECKING:
    from condyle.sampling import SamplingPlan


def run(context: StudyContext) -> bool:
    """Samples the study's domains, going on from what an interrupted run has left, and draws the samples."""
    if context.study.sampling.dataset is not None:
        return _and_figures(context, adopt_samples(context))
    inputs = {
        **context.study.canonical("contact", "sampling"),
        "implant": context.outputs_of("implant"),
        "reference": _simulated_curves(context),
        "version": condyle.__version__,
    }
    sampled = context.directory.run_stage("sample", inputs, lambda: _sample(context))
    return _and_figures(context, sampled)


def _and_figures(context: StudyContext, sampled: bool) -> bool:
    """Draws the samples where needed; whether anything was done."""
    drawn = draw_sample_figures(context)
    if drawn and not sampled:
        context.reporter.stage("sample", "samples unchanged, figures drawn")
    return drawn or sampled


def _simulated_curves(context: StudyContext) -> dict[str, str]:
    """Digests of the simulated activities, if it is around them that the study samples."""
    if context.study.sampling.curves.kind != "activities":
        return {}
    outputs = context.outputs_of("reference")
    return {name: digest for name, digest in outputs.items() if name.endswith(".csv")}


def _sample(context: StudyContext) -> list[Path]:
    from condyle.sampling import SamplingProgress, sample, write_csv
    from condyle.sampling.cluster import cluster_executor
    from condyle.sampling.evaluate import equilibrium_solver
    from condyle.sampling.run_estimate import RunEstimator

    directions, sentence, sensitive = sensitive_directions(context)
    plan = _plan(context, directions)
    solver = equilibrium_solver(
        context.reference, max_depth=plan.max_depth, threads=context.threads
    )
    found = make_curves(context, solver)
    total = sum(target.total for target in plan.targets)
    domains = ", ".join(str(target.domain) for target in plan.targets)
    context.reporter.stage(
        "sample", f"{total} samples in domains {domains}; {found.told}; {sentence}"
    )

    estimator = RunEstimator(plan)

    def progress(p: SamplingProgress) -> None:
        what = "pilot" if p.round_number == 0 else f"round {p.round_number}"
        estimate = estimator.update(p)
        note = f"{what}, {estimate.text()}"
        context.reporter.progress(f"domain {p.domain}", estimate.fraction, note)

    with cluster_executor(context.scheduler) as executor:
        report = sample(
            plan,
            found.curves,
            solver,
            context.directory.samples,
            context.identity(),
            progress,
            executor=executor,
        )
    summary = report.to_json() | {"sensitive_directions": sensitive}
    if found.bounds is not None:
        summary["conformity"] = found.bounds
    curves = curves_file(context)
    curves.parent.mkdir(parents=True, exist_ok=True)
    write_csv(found.curves, curves)
    table = context.directory.write_table("samples", summary)
    cost = summary["evaluations_per_accepted"]
    rate = total / report.wall_time_s
    context.reporter.finished(
        "sample", f"{cost:.1f} contact evaluations per accepted sample, {rate:.0f} samples/s"
    )
    return [context.directory.samples / "manifest.json", table, curves]


def _plan(context: StudyContext, directions: tuple[str, ...]) -> SamplingPlan:
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
        sensitive_directions=directions,
        max_depth=1e-3 * context.study.contact.plausible_depth_mm,
        margin_x=1e-3 * section.margin_x_mm,
        margin_z=1e-3 * section.margin_z_mm,
        margin_theta_y=math.radians(section.margin_theta_y_deg),
    )
