# SPDX-License-Identifier: Apache-2.0
"""Figures of a study's samples, drawn as soon as there are samples, where matplotlib is installed."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import condyle
from condyle.study.context import StudyContext
from condyle.study.curves import curves_file

_RECORD = "sample_figures"


def draw_sample_figures(context: StudyContext) -> bool:
    """Draws the samples and their reference curves, if they have changed since the last time.

    What is drawn decides no later stage.

    Args:
        context: a study whose samples are complete.

    Returns:
        Whether anything was drawn.
    """
    if importlib.util.find_spec("matplotlib") is None:
        return False

    def work() -> list[Path]:
        from condyle.report.sample_figures import write_sample_figures
        from condyle.sampling import read_table

        context.reporter.progress("figures", 0.0, "drawing the samples")
        own = context.study.sampling.dataset is None
        curves = read_table(curves_file(context)) if own else None
        return write_sample_figures(context.samples_directory, context.directory.figures, curves)

    inputs = {"samples": context.outputs_of("sample"), "version": condyle.__version__}
    return context.directory.run_stage(_RECORD, inputs, work)


def sample_figure_files(context: StudyContext) -> list[Path]:
    """The figures that were drawn, none without matplotlib."""
    return [
        context.directory.root / name for name in context.directory.stage_outputs(_RECORD) or {}
    ]
