# SPDX-License-Identifier: Apache-2.0
"""Stage ``report``: tables.json, tables.md, the figures, and all of it as report.html."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import condyle
from condyle.report.html_page import html_page
from condyle.report.tables import render_tables
from condyle.study.context import StudyContext
from condyle.study.external_samples import has_stage
from condyle.study.overview_figures import muscle_figures, overview_figures
from condyle.study.pressure import pressure_pose
from condyle.study.sample_figures import sample_figure_files
from condyle.study.simulation_files import read_simulation
from condyle.whole_files import write_whole

TABLES = (
    "fast_error",
    "samples",
    "external_samples",
    "sample_errors",
    "simulation_loads",
    "simulation_kinematics",
    "times",
    "unconverged",
    "parity",
)


def run(context: StudyContext) -> bool:
    """Merges the stages' tables and draws the figures."""
    stages = ("implant", "body", "reference", "sample", "train", "evaluate", "simulate")
    inputs: dict[str, Any] = {
        stage: context.outputs_of(stage) for stage in stages if has_stage(context.study, stage)
    }
    inputs |= {"version": condyle.__version__, "pressure_law": _pressure_law(context)}

    def work() -> list[Path]:
        context.reporter.stage("report", "tables and figures")
        directory = context.directory
        tables = {name: directory.read_table(name) for name in TABLES}
        json_file, markdown_file = directory.root / "tables.json", directory.root / "tables.md"
        write_whole(json_file, json.dumps(tables, indent=1) + "\n")
        figures = [*_simulation_figures(context), _parity_figure(context)]
        shown = [f.relative_to(directory.root) for f in (*sample_figure_files(context), *figures)]
        text = render_tables(context.study.name, tables, [f.as_posix() for f in shown])
        write_whole(markdown_file, text)
        page_file = directory.root / "report.html"
        write_whole(page_file, html_page(text, context.study.name, directory.root))
        context.reporter.finished(
            "report", f"{markdown_file}, {len(shown)} figures; all in one page: {page_file}"
        )
        return [json_file, markdown_file, page_file, *figures]

    return context.directory.run_stage("report", inputs, work)


def _pressure_law(context: StudyContext) -> dict[str, str | float] | None:
    law = context.study.contact.pressure_law
    return None if law is None else law.make().describe()


def _simulation_figures(context: StudyContext) -> list[Path]:
    """All activities together, then loads, kinematics and pressure of each; none without a reference contact."""
    from condyle.report.simulation_figures import Trace, kinematics_figure, loads_figure
    from condyle.report.style import house_style, save

    if not has_stage(context.study, "simulate"):
        return []
    folder = context.directory.figures
    made: list[Path] = []
    # Two lines a panel: the first contact model that the study names beside the reference.
    models = ("reference", context.study.simulate.contact[0])
    shown: dict[str, list[Trace]] = {}
    with house_style():
        for name in context.activities:
            known, predicted = (
                read_simulation(context.directory.simulations / f"{name}_{model}.csv")
                for model in models
            )
            traces = [
                Trace(label, t["time"], t["wrenches"], t["kinematics"])
                for label, t in zip(models, (known, predicted), strict=True)
            ]
            shown[name] = traces
            made.append(save(loads_figure(name, traces), folder / f"{name}_loads.png"))
            made.append(save(kinematics_figure(name, traces), folder / f"{name}_kinematics.png"))
            made.append(_draw_pressure(context, name, known, folder / f"{name}_pressure.png"))
        return [
            *overview_figures(context, shown),
            *muscle_figures(context, models),
            *made,
        ]


def _parity_figure(context: StudyContext) -> Path:
    """The surrogate against held-out samples."""
    from condyle.contact import Derivatives
    from condyle.report.sample_figures import parity_figure
    from condyle.report.style import house_style, save
    from condyle.sampling import Dataset
    from condyle.surrogate import load_surrogate

    test = Dataset.read(context.samples_directory).select(split="test")
    model = load_surrogate(context.directory.surrogate)
    loads = model.evaluate(test.poses, Derivatives.none, context.threads)
    statistics = context.directory.read_table("sample_errors")
    with house_style():
        figure = parity_figure(test.wrenches, loads.wrench, statistics)
        return save(figure, context.directory.figures / "parity.png")


def _draw_pressure(
    context: StudyContext, name: str, trace: dict[str, NDArray[Any]], file: Path
) -> Path:
    """The implant at the time frame of the highest total compression."""
    from condyle.contact import rotation_TF
    from condyle.report.implant_figures import implant_figure
    from condyle.report.style import save

    frame = int(np.argmax(trace["wrenches"][:, :, 1].sum(axis=1)))
    pose = pressure_pose(context, trace["poses"][frame], trace["wrenches"][frame])
    contact = context.pressure_contact
    inserts = [(m.vertices, m.faces) for m in (contact.insert_medial, contact.insert_lateral)]
    force = trace["wrenches"][frame, :, 1].sum()
    flexion = np.degrees(trace["kinematics"][frame, 0])
    law = "" if contact is context.reference else f" ({contact.law_name()})"
    figure = implant_figure(
        (contact.femur.vertices, contact.femur.faces),
        inserts,
        contact.face_pressures(pose),
        rotation_TF(pose),
        pose[:3],
        f"{name}: {force:.0f} N at {flexion:.0f}° of flexion{law}",
    )
    return save(figure, file)
