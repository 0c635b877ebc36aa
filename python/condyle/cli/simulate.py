# SPDX-License-Identifier: Apache-2.0
"""``condyle simulate``: a study's activities, or a recorded trial of a musculoskeletal model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final, Literal

import typer

from condyle.cli import law_options, solver_options, stages, trial_options, trial_run
from condyle.errors import InputDataError

#: Exit code where results are written, but time frames are not in equilibrium; a caller's mistake is 2.
_NUMERICS_FAILED = 1
#: What a study's stage takes; everything else is of a model and a trial.
_OF_A_STUDY = {"source", "runs", "threads"}

_PANEL: Final = "Contact"


def add_to(app: typer.Typer) -> None:
    """Adds the command to the root."""
    app.command()(simulate)


def simulate(
    context: typer.Context,
    source: Annotated[
        Path, typer.Argument(metavar="STUDY.toml|MODEL.json", help="Study, or model file.")
    ],
    motion: Annotated[
        Path | None,
        typer.Argument(metavar="MOTION.sto", help="Coordinates of the trial, .sto or .mot."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FOLDER", help="Where results are written."),
    ] = None,
    loads: trial_options.Loads = None,
    paths: trial_options.Paths = None,
    start: trial_options.Start = None,
    end: trial_options.End = None,
    criterion: trial_options.Criterion = "3",
    strength: trial_options.Strength = "hill",
    reserve: trial_options.Reserve = 0.0,
    negligible_force: trial_options.NegligibleForce = 0.0,
    any_range: trial_options.AnyRange = False,
    meshes: trial_options.Meshes = None,
    femur: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="The femoral component's contact surface. [default: by the model's contact pairs]",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    insert: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="The insert's, one mesh, split at z = 0. [default: by the model's contact pairs]",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    patella: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|none",
            help="The patella's, which meets the femur's mesh. [default: by the model's contact pairs]",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    contact: Annotated[
        Literal["exact", "fast", "surrogate", "hybrid"] | None,
        typer.Option(
            help="What evaluates the knee. [default: fast; surrogate with --surrogate]",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    surrogate: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.onnx", help="Surrogate of the knee's contact.", rich_help_panel=_PANEL
        ),
    ] = None,
    side_of_body: Annotated[
        Literal["left", "right"] | None,
        typer.Option(help="Left or right knee. [default: the surrogate's]", rich_help_panel=_PANEL),
    ] = None,
    law: law_options.Law = "linear_volume",
    modulus: law_options.Modulus = None,
    youngs_modulus_mpa: law_options.YoungsModulus = None,
    poissons_ratio: law_options.PoissonsRatio = None,
    thickness_mm: law_options.Thickness = None,
    coefficient: law_options.Coefficient = None,
    exponent: law_options.Exponent = None,
    law_table: law_options.LawTable = None,
    plausible_depth_mm: Annotated[
        float,
        typer.Option(metavar="MM", help="Overlap beyond this is flagged.", rich_help_panel=_PANEL),
    ] = 2.0,
    cache: Annotated[
        Path | None,
        typer.Option(
            help="Folder that keeps what fast builds of the meshes between runs.",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    pressures: Annotated[
        bool | None,
        typer.Option(
            "--pressures/--no-pressures",
            help="Evaluate the meshes at the poses found. [default: where there are meshes]",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    map_at: Annotated[
        list[float] | None,
        typer.Option(
            metavar="T",
            help="Draw the pressure map of the insert at this time, s; give several.",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    map_vtp: Annotated[
        bool,
        typer.Option(
            "--map-vtp", help="These maps for ParaView, too, as VTP.", rich_help_panel=_PANEL
        ),
    ] = False,
    force_tolerance: solver_options.ForceTolerance = None,
    moment_tolerance: solver_options.MomentTolerance = None,
    max_iterations: solver_options.MaxIterations = None,
    max_newton_step_mm: solver_options.MaxNewtonStepMm = None,
    max_newton_step_deg: solver_options.MaxNewtonStepDeg = None,
    local_search: solver_options.LocalSearch = None,
    jacobian: solver_options.JacobianName = "analytic",
    perturbation: solver_options.Perturbation = None,
    max_substeps: solver_options.MaxSubsteps = None,
    chunk: solver_options.Chunk = 0,
    runs: stages.Runs = Path("runs"),
    threads: stages.Threads = 0,
) -> None:
    """Simulates a study's activities (STUDY.toml), or a trial of a body model (MODEL.json MOTION.sto -o FOLDER).

    Of a trial: secondary knee kinematics, muscle, ligament and contact forces in one equilibrium (docs/simulation.md).
    The exit code is 1 where time frames are not in equilibrium: results are written, and summary.json names them.
    """
    if source.suffix == ".toml":
        _refuse_options_of_trials(context)
        stages.run_study(source, "simulate", runs, threads)
        return
    if motion is None or output is None:
        raise InputDataError(
            f"{source}: a model needs a MOTION.sto and -o FOLDER (a study is a .toml)"
        )
    if _given(context, "runs"):
        raise InputDataError("--runs goes with a study; results of a trial go to -o FOLDER")
    files = trial_run.TrialFiles(
        model=source,
        motion=motion,
        loads=loads,
        paths=paths,
        meshes=tuple(meshes or ()),
        surrogate=surrogate,
        law_table=law_table,
    )
    window = trial_run.TrialWindow(start, end, negligible_force, any_range)
    wanted = trial_run.WantedContacts(
        femur=femur,
        insert=insert,
        patella=patella,
        kind=contact,
        side_of_body=side_of_body,
        law=law_options.read_law(
            law,
            modulus=modulus,
            youngs_modulus_mpa=youngs_modulus_mpa,
            poissons_ratio=poissons_ratio,
            thickness_mm=thickness_mm,
            coefficient=coefficient,
            exponent=exponent,
            law_table=law_table,
        ),
        plausible_depth=1e-3 * plausible_depth_mm,
        cache=cache,
        pressures=pressures,
        map_at=tuple(map_at or ()),
        map_vtp=map_vtp,
    )
    settings = solver_options.solver_settings(
        force_tolerance=force_tolerance,
        moment_tolerance=moment_tolerance,
        max_iterations=max_iterations,
        max_newton_step_mm=max_newton_step_mm,
        max_newton_step_deg=max_newton_step_deg,
        local_search=local_search,
        jacobian=jacobian,
        perturbation=perturbation,
        max_substeps=max_substeps,
        chunk=chunk,
        threads=threads,
    )
    muscles = trial_options.muscle_settings(criterion, strength, reserve)
    if not trial_run.run_trial(files, window, wanted, muscles, settings, output):
        raise typer.Exit(_NUMERICS_FAILED)


def _given(context: typer.Context, name: str) -> bool:
    """Whether the user said it, rather than its default."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _refuse_options_of_trials(context: typer.Context) -> None:
    for option in context.command.params:
        name = option.name or ""
        if name not in _OF_A_STUDY and _given(context, name):
            said = "MOTION.sto" if name == "motion" else option.opts[0]
            raise InputDataError(
                f"{said} does not go with a study: it is of a model and a trial (MODEL.json MOTION.sto -o FOLDER)"
            )
