# SPDX-License-Identifier: Apache-2.0
"""Runs a study's stages in their order."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from condyle.study.context import StudyContext
from condyle.study.external_samples import has_stage, require_stage
from condyle.study.reporter import Reporter, SilentReporter
from condyle.study.run_directory import RunDirectory
from condyle.study.schema import Study
from condyle.study.stages import body, evaluate, implant, reference, report, sample, simulate, train

STAGES: Final = {
    "implant": implant.run,
    "body": body.run,
    "reference": reference.run,
    "sample": sample.run,
    "train": train.run,
    "evaluate": evaluate.run,
    "simulate": simulate.run,
    "report": report.run,
}


class StudyRun:
    """A study and its run directory.

    Args:
        study: the settings.
        runs: folder that holds run directories; this one is ``runs/<study.name>``.
        threads: for contact and sampling, 0 for all cores; no result depends on it.
        reporter: told of progress.
        scheduler: address of a Dask scheduler whose workers evaluate the samples; None: this machine does.
    """

    def __init__(
        self,
        study: Study,
        runs: Path,
        threads: int = 0,
        reporter: Reporter | None = None,
        scheduler: str | None = None,
    ) -> None:
        directory = RunDirectory(Path(runs) / study.name)
        self.context = StudyContext(
            study, directory, threads, reporter or SilentReporter(), scheduler
        )

    def run(self, until: str = "report") -> None:
        """Runs the stages up to and including one; those that are current are skipped.

        Raises:
            ValueError: no such stage.
            CondyleError: a stage cannot go on; the message says why. What is finished is kept.
        """
        if until not in STAGES:
            raise ValueError(f"stage '{until}': must be one of {', '.join(STAGES)}")
        require_stage(self.context.study, until)
        for name in (name for name in STAGES if has_stage(self.context.study, name)):
            if not STAGES[name](self.context):
                self.context.reporter.skipped(name)
            if name == until:
                return

    def unconverged(self) -> list[dict[str, Any]]:
        """Time frames of trials that are not in equilibrium, with every contact model simulated so far."""
        directory = self.context.directory
        found = directory.read_table("unconverged")
        if found is None:
            found = directory.read_table("reference_unconverged")
        return list(found or [])
