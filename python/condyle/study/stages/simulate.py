# SPDX-License-Identifier: Apache-2.0
"""Stage ``simulate``: the study's activities with the surrogate or the hybrid, compared with the reference's."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import condyle
from condyle.conventions import POSE_COLUMNS
from condyle.evaluation import kinematics_error_table, simulation_load_error_table
from condyle.study.context import StudyContext
from condyle.study.simulation_files import read_simulation, write_simulation
from condyle.whole_files import write_whole

if TYPE_CHECKING:
    from condyle.surrogate import HybridContactModel, OnnxContactModel

_TABLES = ("simulation_loads", "simulation_kinematics", "times", "unconverged")


@dataclass
class _Results:
    """Tables' rows by name, and the files written."""

    rows: dict[str, list[dict[str, Any]]] = field(
        default_factory=lambda: {name: [] for name in _TABLES}
    )
    files: list[Path] = field(default_factory=list)


def run(context: StudyContext) -> bool:
    """Simulates with each contact model that the study names and writes the error and time tables."""
    from condyle.surrogate import load_surrogate

    inputs = {
        **context.study.canonical("simulate"),
        "surrogate": context.outputs_of("train"),
        "reference": context.outputs_of("reference"),
        "version": condyle.__version__,
    }

    def work() -> list[Path]:
        models = context.study.simulate.contact
        context.reporter.stage("simulate", f"{', '.join(context.activities)}; {', '.join(models)}")
        surrogate = load_surrogate(context.directory.surrogate)
        results = _Results()
        results.rows["unconverged"] += context.directory.read_table("reference_unconverged")
        runs = [(name, contact) for name in context.activities for contact in models]
        for i, (name, contact) in enumerate(runs):
            context.reporter.progress("simulating", i / len(runs), f"{name}, {contact}")
            _simulate(context, surrogate, name, contact, results)
        for table, rows in results.rows.items():
            results.files.append(context.directory.write_table(table, rows))
        context.reporter.finished("simulate", _said(results))
        return results.files

    return context.directory.run_stage("simulate", inputs, work)


def _simulate(
    context: StudyContext,
    surrogate: OnnxContactModel,
    name: str,
    contact: str,
    results: _Results,
) -> None:
    """One activity with one contact model."""
    from condyle.surrogate import HybridContactModel

    folder = context.directory.simulations
    # A hybrid of its own for every activity, so that its count is the activity's.
    hybrid = HybridContactModel(surrogate, context.reference) if contact == "hybrid" else None
    outcome = context.activities[name].simulate(hybrid or surrogate, contact)
    simulation = outcome.simulated
    file = folder / f"{name}_{contact}.csv"
    write_simulation(file, simulation)
    results.files += [file, *outcome.files]
    if hybrid is not None:
        results.files.append(_write_calls(folder / f"{name}_hybrid_calls.csv", hybrid))
    known = read_simulation(folder / f"{name}_reference.csv")
    rows = results.rows
    rows["unconverged"] += outcome.unconverged(name, contact)
    both = known["converged"] & (simulation.status == "converged")
    for table, errors in (
        (
            "simulation_loads",
            simulation_load_error_table(name, known["wrenches"][both], simulation.wrenches[both]),
        ),
        (
            "simulation_kinematics",
            kinematics_error_table(name, known["kinematics"][both], simulation.kinematics[both]),
        ),
    ):
        excluded = int((~both).sum())
        rows[table] += [{"contact": contact, **row, "excluded": excluded} for row in errors]
    directory = context.directory
    rows["times"].append(
        {
            "what": f"{name}, {len(simulation.time)} time frames",
            "activity": name,
            "contact": contact,
            "time_frames": len(simulation.time),
            "duration_s": float(simulation.time[-1] - simulation.time[0]),
            "reference_s": directory.read_table("reference_seconds")[name],
            "surrogate_s": outcome.seconds,
            "reference_phases_s": directory.read_table("reference_phases")[name],
            "phases_s": outcome.phases,
            # A hybrid counts those for a trial's start, too; so are the reference's counted.
            "evaluations": int(simulation.evaluations.sum())
            if hybrid is None
            else hybrid.evaluations,
            "reference_evaluations": 0 if hybrid is None else hybrid.reference_calls,
            "untrusted_time_frames": int((simulation.trust < 0.5).sum()),
        }
    )


def _write_calls(file: Path, hybrid: HybridContactModel) -> Path:
    """Where the reference was called (the first thousand poses), and the surrogate's trust there."""
    poses, trust = hybrid.log
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*POSE_COLUMNS, "trust"])
    for pose, value in zip(poses.tolist(), trust.tolist(), strict=True):
        writer.writerow([*map(repr, pose), repr(value)])
    write_whole(file, text.getvalue())
    return file


def _said(results: _Results) -> str:
    errors = [*results.rows["simulation_loads"], *results.rows["simulation_kinematics"]]
    said = []
    for contact in dict.fromkeys(row["contact"] for row in errors):
        worst = {
            unit: max(r["rmse"] for r in errors if (r["contact"], r["unit"]) == (contact, unit))
            for unit in ("N", "Nm", "mm", "deg")
        }
        text = f"{contact}: worst RMSE " + ", ".join(f"{v:.3g} {unit}" for unit, v in worst.items())
        if contact == "hybrid":
            mine = [row for row in results.rows["times"] if row["contact"] == contact]
            calls, evaluations = (
                sum(row[key] for row in mine) for key in ("reference_evaluations", "evaluations")
            )
            text += f"; {calls} of {evaluations} evaluations by the reference"
        said.append(text)
    return "; ".join(said)
