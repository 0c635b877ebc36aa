# SPDX-License-Identifier: Apache-2.0
"""All simulated activities of a study in one picture each of forces and of kinematics, and the muscles of trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from condyle.study.context import StudyContext

if TYPE_CHECKING:
    from condyle.report.muscle_figure import MuscleForces
    from condyle.report.simulation_figures import Trace

_TABLE: Final = "muscle_forces/"


def overview_figures(context: StudyContext, traces: Mapping[str, Sequence[Trace]]) -> list[Path]:
    """Like the paper's Figures 3 and 4.

    Args:
        context: of the study.
        traces: by activity: the reference's, then the other contact model's.
    """
    from condyle.report.activity_figures import (
        ActivityTraces,
        compressive_forces_figure,
        knee_kinematics_figure,
    )
    from condyle.report.style import save

    if not traces:
        return []
    activities = [
        ActivityTraces(name, surrogate=predicted, reference=known)
        for name, (known, predicted) in traces.items()
    ]
    folder = context.directory.figures
    return [
        save(
            compressive_forces_figure(activities, body_weight=_body_weight(context)),
            folder / "compressive_forces.png",
        ),
        save(knee_kinematics_figure(activities), folder / "knee_kinematics.png"),
    ]


def muscle_figures(context: StudyContext, contacts: Sequence[str]) -> list[Path]:
    """The largest muscle forces of each trial, with the reference and the other contact model.

    Args:
        context: of the study.
        contacts: ``reference`` and the other's name.
    """
    from condyle.report.muscle_figure import muscle_forces_figure
    from condyle.report.style import save

    made = []
    for name in context.study.trials:
        reference, other = (_muscle_forces(context, name, contact) for contact in contacts)
        figure = muscle_forces_figure(name, other, reference)
        made.append(save(figure, context.directory.figures / f"{name}_muscles.png"))
    return made


def _muscle_forces(context: StudyContext, trial: str, contact: str) -> MuscleForces:
    import pyarrow.parquet as parquet

    from condyle.report.muscle_figure import MuscleForces

    file = context.directory.simulations / f"{trial}_{contact}" / "simulation.parquet"
    table = parquet.read_table(file)
    columns = [name for name in table.column_names if name.startswith(_TABLE)]
    return MuscleForces(
        label=contact,
        time=table.column("time").to_numpy(),
        names=[name.removeprefix(_TABLE) for name in columns],
        forces=np.column_stack([table.column(name).to_numpy() for name in columns]),
    )


def _body_weight(context: StudyContext) -> float | None:
    """Of the study's body [N]; None where there is none, or where load cases stand beside its trials."""
    if context.study.body is None or context.study.activities:
        return None
    core = context.body.model.core
    return float(np.sum(core.masses) * np.linalg.norm(core.gravity))
