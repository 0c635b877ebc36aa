# SPDX-License-Identifier: Apache-2.0
"""``condyle surrogate``: what a surrogate file says of itself, and how a study's surrogate learns."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.markdown import Markdown

from condyle.cli.console import console, progress_bar
from condyle.cli.stages import Runs, ScreenReporter, StudyFile, Threads

app = typer.Typer(help="Surrogate files (ONNX contract v1).", no_args_is_help=True)


@app.command()
def info(
    file: Annotated[Path, typer.Argument(help="Surrogate, .onnx")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
) -> None:
    """Prints a surrogate's card: implant, contact law, domains, errors, trust, training record, limits."""
    from condyle.surrogate import card_markdown, describe, model_card

    card = model_card(file)
    runtime = describe(file)["runtime"]
    if as_json:
        typer.echo(json.dumps(card | {"runtime": runtime}, indent=2, ensure_ascii=False))
        return
    text = card_markdown(card) + f"\nEvaluated here by: {runtime}\n"
    if console.is_terminal:
        console.print(Markdown(text))
    else:
        typer.echo(text, nl=False)


@app.command()
def learn(
    study: StudyFile,
    share: Annotated[
        list[float] | None,
        typer.Option(
            min=0.01,
            max=1.0,
            help="Share of the training samples; give several. Default: 1/8, 1/4, 1/2, 1.",
        ),
    ] = None,
    minutes: Annotated[
        list[float] | None,
        typer.Option(
            min=1e-3,
            help="Training times to tell the errors at; give several. Default: 5 15 30 60.",
        ),
    ] = None,
    every: Annotated[
        int, typer.Option(min=1, help="Epochs between the networks kept for the curve over time.")
    ] = 5,
    seed: Annotated[int, typer.Option(min=0, help="Of the subsets, which are nested.")] = 1,
    runs: Runs = Path("runs"),
    threads: Threads = 0,
) -> None:
    """Learning curves: held-out errors against the number of samples and against training time.

    Trains once for every share, as the study's [training] says, and writes learning_curves.md, a table and a figure
    into the run. What is finished is kept; the same command resumes.
    """
    from condyle.study import StudyRun, read_study
    from condyle.study.learning_curves import LearningPlan, learning_curves

    plan = LearningPlan.of(share, minutes, every=every, seed=seed)
    with progress_bar() as progress:
        run = StudyRun(read_study(study), runs, threads, ScreenReporter(progress))
        run.run("sample")
        if not learning_curves(run.context, plan):
            run.context.reporter.skipped("learn")
    file = run.context.directory.root / "learning_curves.md"
    typer.echo(file.read_text(encoding="utf-8"), nl=False)
