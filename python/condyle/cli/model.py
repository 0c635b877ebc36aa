# SPDX-License-Identifier: Apache-2.0
"""``condyle model``: what a musculoskeletal model holds, what a motion asks of it, and a picture of it."""

from __future__ import annotations

import json as json_text
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from condyle.cli import trial_options
from condyle.cli.console import console
from condyle.cli.model_words import (
    say,
    tell_failed,
    tell_force_dependent,
    tell_hinge,
    tell_passed_by,
    tell_summary,
)
from condyle.errors import InputDataError
from condyle.whole_files import write_whole

if TYPE_CHECKING:
    from condyle.model import MusculoskeletalModel, Trial, TrialAnalysis

app = typer.Typer(
    help="Musculoskeletal models: check, analyse a motion, draw (docs/musculoskeletal.md).",
    no_args_is_help=True,
)

ModelFile = Annotated[
    Path,
    typer.Argument(metavar="MODEL.json", help="Model file; `condyle opensim import` makes one."),
]
#: Exit code where an analysis is written, but time frames of it failed; a caller's mistake is 2.
_NUMERICS_FAILED = 1


@app.command()
def check(
    model: ModelFile,
    json: Annotated[bool, typer.Option("--json", help="Print everything as JSON.")] = False,
) -> None:
    """Reads a model, and says what it holds, who balances what, and what may not be meant."""
    from condyle.model import MusculoskeletalModel, summarise

    found = summarise(MusculoskeletalModel.read(model))
    if json:
        console.print(
            json_text.dumps(asdict(found), indent=1, ensure_ascii=False),
            highlight=False,
            markup=False,
            soft_wrap=True,
        )
        return
    tell_summary(model, found)


@app.command()
def analyse(
    model: ModelFile,
    motion: Annotated[
        Path, typer.Argument(metavar="MOTION.sto", help="Coordinates, .sto or .mot.")
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FOLDER", help="Where results are written.")
    ],
    loads: trial_options.Loads = None,
    paths: trial_options.Paths = None,
    start: trial_options.Start = None,
    end: trial_options.End = None,
    criterion: trial_options.Criterion = "3",
    strength: trial_options.Strength = "hill",
    reserve: trial_options.Reserve = 0.0,
    negligible_force: trial_options.NegligibleForce = 0.0,
    any_range: trial_options.AnyRange = False,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 for all cores.")] = 0,
) -> None:
    """Inverse dynamics, paths, ligaments and muscle forces of a motion, as STO files and a summary.

    The exit code is 1 where muscle forces of some time frames could not be found: summary.json names them.
    """
    from condyle.model import MusculoskeletalModel, analyse_trial, write_analysis

    settings = trial_options.muscle_settings(criterion, strength, reserve)
    read = MusculoskeletalModel.read(model)
    trial = trial_options.trial_of(
        read, motion, loads, paths, start, end, negligible_force, any_range
    )
    recruitment = _muscles_balance(read)
    found = analyse_trial(read, trial, settings, recruitment=recruitment, threads=threads)
    inputs = trial_options.trial_inputs(model, motion, loads, paths)
    written = write_analysis(output, read, trial, found, settings, inputs)
    say(f"{output}: {', '.join(file.name for file in written)}")
    say(f"{len(trial)} time frames from {trial.times[0]:g} to {trial.times[-1]:g} s")
    if not recruitment:
        say("no muscle forces: no coordinate of this model is balanced by muscles")
    tell_force_dependent(read, trial)
    tell_passed_by(found.wraps_ignored, given=paths is not None)
    if tell_failed(found):
        raise typer.Exit(_NUMERICS_FAILED)


@app.command("hinge-patella")
def hinge(
    model: ModelFile,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE.json", help="Model file to write.")
    ],
    meshes: trial_options.Meshes = None,
    femur: Annotated[
        str | None, typer.Option(metavar="NAME", help="Surface of the femoral component.")
    ] = None,
    insert: Annotated[
        str | None, typer.Option(metavar="NAME", help="Surface of the insert: says the tibia.")
    ] = None,
    patella: Annotated[
        str | None, typer.Option(metavar="NAME", help="Surface of the patellar button.")
    ] = None,
    stiffness: Annotated[
        float, typer.Option(metavar="N/M", help="Of the patellar ligament.")
    ] = 1.187e6,
) -> None:
    """Puts a patella of six force-dependent coordinates on a hinge, held by a linear patellar ligament.

    As in Marra et al. 2017. The hinge is the axis of a cylinder fitted to the trochlea of the femoral component's mesh
    (docs/simulation.md). Surfaces are found as `condyle simulate` finds them.
    """
    from condyle.model import MusculoskeletalModel, hinge_patella, joint_surfaces, surface_files

    read = MusculoskeletalModel.read(model)
    joint = joint_surfaces(read, femur=femur, insert=insert, patella=patella)
    hinged = hinge_patella(read, surface_files(read, meshes or []), joint, stiffness=stiffness)
    write_whole(output, hinged.text())
    tell_hinge(output, joint, hinged)


@app.command()
def picture(
    model: ModelFile,
    motion: Annotated[
        Path | None,
        typer.Argument(metavar="MOTION.sto", help="Coordinates; none: the default posture."),
    ] = None,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE.png", help="Picture to write.")
    ] = Path("model.png"),
    at: Annotated[
        float | None, typer.Option(metavar="T", help="Time, s; the nearest frame.")
    ] = None,
    loads: trial_options.Loads = None,
    paths: trial_options.Paths = None,
    meshes: trial_options.Meshes = None,
    criterion: trial_options.Criterion = "3",
    strength: trial_options.Strength = "hill",
    reserve: trial_options.Reserve = 0.0,
    negligible_force: trial_options.NegligibleForce = 0.0,
    any_range: trial_options.AnyRange = False,
) -> None:
    """Draws bones, muscles by activity, ligaments by strain, contact surfaces and external forces."""
    from condyle.model import MusculoskeletalModel, analyse_trial, scene_at, surface_files
    from condyle.report.model_figure import model_figure
    from condyle.report.style import house_style, save

    if motion is None and (at is not None or loads is not None or paths is not None):
        raise InputDataError("--at, --loads and --paths go with a MOTION.sto")
    if motion is not None and at is None:
        raise InputDataError(f"{motion}: --at T says which time of the motion is drawn")
    read = MusculoskeletalModel.read(model)
    surfaces = surface_files(read, meshes or [])
    analysis: TrialAnalysis | None = None
    if motion is None or at is None:
        trial, title = _default_posture(read), f"{read.name}, default posture"
        analysis = analyse_trial(read, trial, recruitment=False, dynamics=False, threads=1)
    else:
        settings = trial_options.muscle_settings(criterion, strength, reserve)
        whole = trial_options.trial_of(
            read, motion, loads, paths, None, None, negligible_force, any_range
        )
        trial, title = whole.only(whole.nearest(at)), None
        analysis = analyse_trial(read, trial, settings, recruitment=_muscles_balance(read))
        tell_passed_by(analysis.wraps_ignored, given=paths is not None)
        tell_failed(analysis)
    scene = scene_at(read, trial, 0, analysis, surfaces, title)
    with house_style():
        save(model_figure(scene), output)
    say(str(output))
    drawn = {name for name, surface in surfaces.items() if surface.file is not None}
    if missing := [name for name in read.core.contact_surface_names if name not in drawn]:
        say(f"not drawn, no mesh file (--meshes): {', '.join(missing)}")


def _default_posture(model: MusculoskeletalModel) -> Trial:
    import numpy as np

    from condyle.model import make_trial

    return make_trial(model, np.zeros(1), model.default_q()[None])


def _muscles_balance(model: MusculoskeletalModel) -> bool:
    return bool(model.balanced_by_muscles) and bool(model.muscle_names)
