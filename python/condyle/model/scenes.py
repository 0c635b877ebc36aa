# SPDX-License-Identifier: Apache-2.0
"""From a model's configuration to what there is to see of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from condyle._core.model import Kinematics
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel
from condyle.model.scene import ModelScene, Polyline, Surface
from condyle.model.trial import Trial
from condyle.model.trial_analysis import TrialAnalysis

Array = NDArray[np.float64]


def scene_at(
    model: MusculoskeletalModel,
    trial: Trial,
    frame: int,
    analysis: TrialAnalysis | None = None,
    meshes: Path | None = None,
) -> ModelScene:
    """A trial's time frame.

    Args:
        model: of the trial.
        trial: its motion and loads.
        frame: 0-based index of the time frame.
        analysis: of the trial, for activities and ligament strains.
        meshes: folder of the contact surfaces' files, if not the model's own.

    Raises:
        InputDataError: no such time frame.
    """
    if not 0 <= frame < len(trial):
        raise InputDataError(f"time frame {frame}: the trial has 0 to {len(trial) - 1}")
    now = Kinematics(model.core, trial.q[frame])
    row = trial.snapshot_rows[frame] if trial.snapshot_rows else 0
    activities = _row(None if analysis is None else analysis.activities, frame)
    strains = _row(None if analysis is None else analysis.ligament_strains, frame)
    muscles = tuple(
        Polyline(name, now.muscle_line(i, trial.snapshots, row), _of(activities, i))
        for i, name in enumerate(model.muscle_names)
    )
    ligaments = tuple(
        Polyline(name, now.ligament_line(i, trial.snapshots, row), _of(strains, i))
        for i, name in enumerate(model.ligament_names)
    )
    loaded = trial.loads[frame][np.abs(trial.loads[frame][:, :3]).max(axis=1, initial=0.0) > 1.0]
    return ModelScene(
        title=f"{model.name}, {trial.times[frame]:.3f} s",
        bones=_bones(model, now),
        centres=now.mass_centres,
        muscles=muscles,
        ligaments=ligaments,
        surfaces=_surfaces(model, now, meshes or model.folder),
        markers=now.markers,
        forces=np.stack([loaded[:, 3:6], loaded[:, :3]], axis=1),
    )


def _row(table: Array | None, frame: int) -> Array | None:
    return None if table is None or len(table) == 0 else table[frame]


def _of(values: Array | None, index: int) -> float:
    return float("nan") if values is None else float(values[index])


def _bones(model: MusculoskeletalModel, now: Kinematics) -> Array:
    """From where a body hangs to where others hang on it; to its mass centre where none do."""
    parents = np.asarray(model.core.parents)
    own = {
        int(body): now.child_placements[i, :3, 3]
        for i, body in enumerate(model.core.joint_children)
    }
    lines = []
    for body in range(len(model.body_names)):
        hung = [own[int(child)] for child in np.flatnonzero(parents == body)]
        lines += [(own[body], end) for end in (hung or [now.mass_centres[body]])]
    return np.array(lines).reshape(-1, 2, 3)


def _surfaces(model: MusculoskeletalModel, now: Kinematics, folder: Path) -> tuple[Surface, ...]:
    from condyle.contact import read_mesh

    found = []
    files = model.core.contact_surface_files
    for name, file, placement in zip(
        model.core.contact_surface_names, files, now.surface_placements, strict=True
    ):
        path = folder / file
        if not path.exists():
            continue
        mesh = read_mesh(path, "m")
        vertices = mesh.vertices @ placement[:3, :3].T + placement[:3, 3]
        found.append(Surface(name, vertices, np.asarray(mesh.faces, dtype=np.int64)))
    return tuple(found)
