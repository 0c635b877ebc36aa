# SPDX-License-Identifier: Apache-2.0
"""From a model's configuration to what there is to see of it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from condyle._core.model import Kinematics
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel
from condyle.model.scene import ModelScene, Polyline, Surface
from condyle.model.surface_files import SurfaceFile, surface_files
from condyle.model.trial import Trial
from condyle.model.trial_analysis import TrialAnalysis

Array = NDArray[np.float64]
#: A body that nothing hangs on and that is lighter than this part of its parent is not where the parent
#: ends: the patella beside the tibia.
_LIGHT = 0.1
#: External forces below this are not shown [N].
_LEAST_FORCE = 1.0
#: Step of a coordinate, to see what it moves [rad, m].
_STEP = 1e-3


def scene_at(
    model: MusculoskeletalModel,
    trial: Trial,
    frame: int,
    analysis: TrialAnalysis | None = None,
    surfaces: Mapping[str, SurfaceFile] | None = None,
    title: str | None = None,
) -> ModelScene:
    """A trial's time frame.

    Args:
        model: of the trial.
        trial: its motion and loads.
        frame: 0-based index of the time frame.
        analysis: of the trial, for activities and ligament strains.
        surfaces: Meshes of contact surfaces (:func:`surface_files`); None: those beside the model's file.
        title: None: the model and the time.

    Raises:
        InputDataError: no such time frame, or a mesh that cannot be read.
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
    size = np.linalg.norm(trial.loads[frame][:, :3], axis=1)
    loaded = trial.loads[frame][size > _LEAST_FORCE]
    up = _up(model)
    bones, plates = _skeleton(model, now)
    return ModelScene(
        title=title or f"{model.name}, {trial.times[frame]:.3f} s",
        bones=bones,
        plates=plates,
        joints=now.child_placements[:, :3, 3],
        muscles=muscles,
        ligaments=ligaments,
        surfaces=_surfaces(
            model, now, surface_files(model) if surfaces is None else dict(surfaces)
        ),
        markers=now.markers,
        forces=np.stack([loaded[:, 3:6], loaded[:, :3]], axis=1),
        up=up,
        forward=_forward(model, now, up),
    )


def _row(table: Array | None, frame: int) -> Array | None:
    return None if table is None or len(table) == 0 else table[frame]


def _of(values: Array | None, index: int) -> float:
    return float("nan") if values is None else float(values[index])


def _up(model: MusculoskeletalModel) -> Array:
    gravity = np.asarray(model.core.gravity, dtype=np.float64)
    size = float(np.linalg.norm(gravity))
    # Not quite straight down is how a laboratory's scales stood, not how a picture should.
    axis = int(np.abs(gravity).argmax()) if size > 0 else 1
    up = np.zeros(3)
    up[axis] = 1.0 if size == 0 or gravity[axis] < 0 else -1.0
    return up


def _forward(model: MusculoskeletalModel, now: Kinematics, up: Array) -> Array:
    """Where a body that is free to go anywhere faces: its x axis; ground's where there is none."""
    ahead = np.array([1.0, 0.0, 0.0]) if abs(up[0]) < 0.5 else np.array([0.0, 1.0, 0.0])
    roots = [i for i, parent in enumerate(model.core.parents) if parent < 0]
    if len(roots) != 1:
        return ahead
    still = now.body_placements[roots[0]]
    movers = 0
    for index in range(len(model.coordinate_names)):
        q = np.array(now.q)
        q[index] += _STEP
        moved = Kinematics(model.core, q).body_placements[roots[0]]
        movers += int(np.abs(moved - still).max() > 0.1 * _STEP)
    axis = still[:3, 0] - (still[:3, 0] @ up) * up
    size = float(np.linalg.norm(axis))
    return axis / size if movers >= 6 and size > 0.5 else ahead


def _skeleton(model: MusculoskeletalModel, now: Kinematics) -> tuple[Array, tuple[Array, ...]]:
    """From where a body hangs to where others hang on it; through its mass centre where none do."""
    parents, masses = np.asarray(model.core.parents), np.asarray(model.core.masses)
    own = {
        int(body): now.child_placements[i, :3, 3]
        for i, body in enumerate(model.core.joint_children)
    }
    lines, plates = [], []
    for body in range(len(model.body_names)):
        children = [int(child) for child in np.flatnonzero(parents == body)]
        light = [
            child
            for child in children
            if masses[child] < _LIGHT * masses[body] and not (parents == child).any()
        ]
        ends = [
            own[child] for child in children if len(light) == len(children) or child not in light
        ]
        if not ends:
            ends = [2 * now.mass_centres[body] - own[body]]
        if len(ends) > 1:
            plates.append(np.array([own[body], *ends]))
        lines += [(own[body], end) for end in ends]
    return np.array(lines).reshape(-1, 2, 3), tuple(plates)


def _surfaces(
    model: MusculoskeletalModel, now: Kinematics, files: Mapping[str, SurfaceFile]
) -> tuple[Surface, ...]:
    from condyle.contact import read_mesh

    found = []
    names = list(model.core.contact_surface_names)
    for name, surface in files.items():
        if surface.file is None:
            continue
        mesh = read_mesh(surface.file, "m")
        if surface.body is None:
            placement = now.surface_placements[names.index(name)]
        elif surface.body == "ground":
            placement = surface.placement
        else:
            placement = now.body_placements[model.body(surface.body)] @ surface.placement
        vertices = mesh.vertices @ placement[:3, :3].T + placement[:3, 3]
        found.append(Surface(name, vertices, np.asarray(mesh.faces, dtype=np.int64)))
    return tuple(found)
