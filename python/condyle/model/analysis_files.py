# SPDX-License-Identifier: Apache-2.0
"""An analysis in files: OpenSim's tables, and a summary that says where they come from and what went wrong."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

import condyle
from condyle._core.io import make_motion, write_motion
from condyle.model.musculoskeletal_model import MusculoskeletalModel
from condyle.model.trial import Trial
from condyle.model.trial_analysis import MuscleSettings, TrialAnalysis
from condyle.whole_files import content_hash, to_canonical_json, write_whole

Array = NDArray[np.float64]
SUMMARY: Final = "summary.json"


def write_analysis(
    folder: Path,
    model: MusculoskeletalModel,
    trial: Trial,
    analysis: TrialAnalysis,
    settings: MuscleSettings,
    inputs: Mapping[str, Path | None],
) -> list[Path]:
    """Writes ``generalised_forces.sto``, ``muscle_lengths.sto``, … and last of all ``summary.json``.

    Columns are the model's names; generalised forces and residuals have OpenSim's endings, ``_moment`` [Nm] and
    ``_force`` [N]. The summary names no folder, host or time of day: the same inputs give the same bytes.

    Args:
        folder: made where needed.
        model: of the analysis.
        trial: likewise.
        analysis: parts that were not asked for are not written.
        settings: of the muscles.
        inputs: Files that the analysis came from, by what they are; None: not given.

    Returns:
        The files written.

    Raises:
        InputDataError: a file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    # A summary stands for all the files beside it.
    (folder / SUMMARY).unlink(missing_ok=True)
    written = []
    for name, (columns, table) in _tables(model, analysis).items():
        file = folder / f"{name}.sto"
        write_motion(make_motion(name, list(columns), analysis.times, table, False), file)
        written.append(file)
    text = to_canonical_json(summarise_analysis(model, trial, analysis, settings, inputs))
    write_whole(folder / SUMMARY, text + "\n")
    return [*written, folder / SUMMARY]


def summarise_analysis(
    model: MusculoskeletalModel,
    trial: Trial,
    analysis: TrialAnalysis,
    settings: MuscleSettings,
    inputs: Mapping[str, Path | None],
) -> dict[str, Any]:
    """Content of ``summary.json``; arguments as :func:`write_analysis`."""
    bad = failed_frames(analysis)
    return {
        "format": "condyle-model-analysis",
        "version": 1,
        "condyle": condyle.__version__,
        "model": model.name,
        "inputs": {
            what: {"name": file.name, "sha256": content_hash(file.read_bytes())}
            for what, file in inputs.items()
            if file is not None
        },
        "settings": asdict(settings),
        "time_frames": len(analysis.times),
        "first_time": float(analysis.times[0]),
        "last_time": float(analysis.times[-1]),
        "balanced_by_muscles": list(analysis.balanced) if analysis.status else [],
        "force_dependent": list(model.force_dependent),
        "at_default": list(trial.at_default),
        "status": dict(Counter(analysis.status)),
        "failed": [
            {
                "time": float(analysis.times[i]),
                "status": analysis.status[i],
                "message": analysis.messages[i],
            }
            for i in bad
        ],
        "largest_kkt_residual": _largest(analysis.kkt),
        "largest_activity": _named_peak(analysis.activities, model.muscle_names),
        "largest_reserve": _named_peak(analysis.reserves, analysis.balanced),
        "wraps_passed_by": list(analysis.wraps_ignored),
        "not_supported": list(model.not_supported),
    }


def generalised_force_columns(model: MusculoskeletalModel) -> list[str]:
    """The coordinates with OpenSim's endings: ``_moment`` [Nm] of rotations, ``_force`` [N] of translations."""
    turning = model.core.coordinate_is_rotational
    return [
        name + ("_moment" if rotational else "_force")
        for name, rotational in zip(model.coordinate_names, turning, strict=True)
    ]


def failed_frames(analysis: TrialAnalysis) -> list[int]:
    """Indices of the time frames whose recruitment did not converge."""
    return [i for i, status in enumerate(analysis.status) if status != "converged"]


def _tables(
    model: MusculoskeletalModel, analysis: TrialAnalysis
) -> dict[str, tuple[Sequence[str], Array]]:
    forces = generalised_force_columns(model)
    of = dict(zip(model.coordinate_names, forces, strict=True))
    tables: dict[str, tuple[Sequence[str], Array]] = {
        "generalised_forces": (forces, analysis.generalised_forces),
        "muscle_lengths": (model.muscle_names, analysis.muscle_lengths),
        "muscle_forces": (model.muscle_names, analysis.muscle_forces),
        "activities": (model.muscle_names, analysis.activities),
        "ligament_forces": (model.ligament_names, analysis.ligament_forces),
        "ligament_strains": (model.ligament_names, analysis.ligament_strains),
        "reserves": ([of[name] for name in analysis.balanced], analysis.reserves),
        "residuals": (forces, analysis.residuals),
    }
    frames = len(analysis.times)
    return {
        name: (columns, np.ascontiguousarray(table))
        for name, (columns, table) in tables.items()
        if len(columns) > 0 and len(table) == frames and (name != "reserves" or table.any())
    }


def _largest(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else None


def _named_peak(table: Array, names: Sequence[str]) -> dict[str, Any] | None:
    if table.size == 0:
        return None
    frame, column = np.unravel_index(int(np.abs(table).argmax()), table.shape)
    return {"name": names[int(column)], "value": float(table[frame, column])}
