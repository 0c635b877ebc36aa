# SPDX-License-Identifier: Apache-2.0
"""``condyle run STUDY.toml``, its single stages, and ``condyle demo``."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Final

import typer
from rich.progress import Progress, TaskID

from condyle.cli.console import console, errors, progress_bar

StudyFile = Annotated[Path, typer.Argument(help="Study, .toml")]
Runs = Annotated[Path, typer.Option(help="Folder of run directories.")]
Threads = Annotated[
    int, typer.Option(min=0, help="Threads; 0 for all cores. No result depends on it.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        help="Dask scheduler whose workers evaluate the samples, such as tcp://head:8786. No result depends on it.",
        metavar="ADDRESS",
    ),
]

#: What each single-stage command does; earlier stages run first where they are not current. ``simulate`` is in
#: simulate.py: it takes a model and a trial, too.
_COMMANDS: Final = {
    "sample": "Samples the study's domains with the reference contact.",
    "train": "Trains the surrogate and writes surrogate.onnx.",
    "evaluate": "Compares the surrogate with held-out samples.",
    "report": "Writes tables and figures.",
}

#: Exit code where time frames of a trial are not in equilibrium; results are written.
_NUMERICS_FAILED: Final = 1
#: So many of them are told one by one.
_TOLD: Final = 10
#: Between lines of progress where the output is no terminal [s].
LINE_EVERY_S: Final = 20.0


class ScreenReporter:
    """Shows stages as lines and their progress as a bar."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._task: TaskID | None = None
        self._started = time.perf_counter()
        self._said = self._started

    def stage(self, name: str, text: str) -> None:
        """Begins a stage."""
        self._started = self._said = time.perf_counter()
        console.print(f"[bold]{name:<10}[/bold] {text}", highlight=False)

    def skipped(self, name: str) -> None:
        """Says that nothing had to be done."""
        console.print(f"[bold]{name:<10}[/bold] [dim]unchanged[/dim]")

    def progress(self, task: str, fraction: float, note: str) -> None:
        """Moves the bar; where the output is no terminal, says a line now and then."""
        if not console.is_terminal:
            now = time.perf_counter()
            if now - self._said >= LINE_EVERY_S:
                self._said = now
                text = f"           {task}: {fraction:.0%}, {note}"
                console.print(text, highlight=False, markup=False, soft_wrap=True)
            return
        if self._task is None:
            self._task = self._progress.add_task(task, total=1.0, note=note)
        self._progress.update(self._task, description=task, completed=fraction, note=note)

    def finished(self, name: str, text: str) -> None:
        """Ends a stage, with its wall time."""
        if self._task is not None:
            self._progress.remove_task(self._task)
            self._task = None
        seconds = time.perf_counter() - self._started
        console.print(f"           {text} [dim]({seconds:.0f} s)[/dim]", highlight=False)


def run_study(
    study_file: Path | None, until: str, runs: Path, threads: int, scheduler: str | None = None
) -> None:
    """Runs a study's stages up to one; None: the demo's study."""
    from condyle.study import Study, StudyRun, read_study

    study = read_study(study_file) if study_file is not None else Study(name="demo")
    with progress_bar() as progress:
        run = StudyRun(study, runs, threads, ScreenReporter(progress), scheduler)
        run.run(until)
    console.print(f"\nresults: {run.context.directory.root}", highlight=False)
    if _tell_unconverged(run.unconverged()):
        raise typer.Exit(_NUMERICS_FAILED)


def _tell_unconverged(rows: list[dict[str, Any]]) -> bool:
    """Says on standard error which time frames of trials are not in equilibrium; whether there are any."""
    for row in rows[:_TOLD]:
        errors.print(
            f"{row['activity']} ({row['contact']}), {row['time_s']:.4g} s: {row['message']}",
            highlight=False,
            markup=False,
            soft_wrap=True,
        )
    if len(rows) > _TOLD:
        errors.print(f"and {len(rows) - _TOLD} more time frames: tables.json, unconverged")
    return bool(rows)


def _stage_command(stage: str) -> Callable[[Path, Path, int], None]:
    def command(study: StudyFile, runs: Runs = Path("runs"), threads: Threads = 0) -> None:
        run_study(study, stage, runs, threads)

    return command


def add_to(app: typer.Typer) -> None:
    """Adds the commands to the root."""

    @app.command(name="run")
    def run_command(
        study: StudyFile,
        runs: Runs = Path("runs"),
        threads: Threads = 0,
        scheduler: Scheduler = None,
    ) -> None:
        """Runs a whole study: implant, reference simulation, samples, surrogate, errors, report."""
        run_study(study, "report", runs, threads, scheduler)

    @app.command(help=_COMMANDS["sample"])
    def sample(
        study: StudyFile,
        runs: Runs = Path("runs"),
        threads: Threads = 0,
        scheduler: Scheduler = None,
    ) -> None:
        run_study(study, "sample", runs, threads, scheduler)

    for stage, text in _COMMANDS.items():
        if stage == "sample":
            continue
        app.command(name=stage, help=text)(_stage_command(stage))

    @app.command()
    def demo(runs: Runs = Path("runs"), threads: Threads = 0) -> None:
        """Runs the whole path on the built-in implant, into runs/demo."""
        run_study(None, "report", runs, threads)
        typer.echo((runs / "demo" / "tables.md").read_text(encoding="utf-8"))
