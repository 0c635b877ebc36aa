# SPDX-License-Identifier: Apache-2.0
"""Where OpenSim's paths run at each time frame of a motion, for surfaces that Condyle does not wrap itself.

A snapshot holds the points of a path, those where it meets and leaves a surface included, each in the
body that carries it. Between them the path is straight, and on the surface it is longer than its
chord: that excess is one number. A path of stationary length changes, to first order, as if its
points were fixed to their bodies; so a snapshot gives lengths and moment arms near its posture.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from condyle.errors import InputDataError
from condyle.opensim.forces import geometry_path
from condyle.opensim.frames import point_in_body
from condyle.opensim.library import load_model, opensim_library
from condyle.opensim.model_import import to_text
from condyle.opensim.motion import read_motion
from condyle.opensim.posture import Postures
from condyle.whole_files import write_whole

Which = Literal["beyond-cylinders", "wrapped", "all"]
#: Surfaces that Condyle wraps paths around itself.
_ANALYTIC: Final = {"WrapCylinder"}
#: [m] The rounding that an excess below zero may have: of sums of lengths of a metre.
_ROUNDING: Final = 1e-12


def path_snapshots(
    file: Path,
    motion_file: Path,
    *,
    which: Which = "beyond-cylinders",
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """The paths of a model's muscles and ligaments at every time frame of a motion.

    Args:
        file: .osim.
        motion_file: Coordinates, .sto, .mot or .csv; those without a column stay at their default.
        which: Paths that wrap around something else than cylinders; all that wrap; or all.
        progress: Called with (time frames done, of how many).

    Returns:
        Content of a path snapshot file: ``bodies``, ``times`` (T) [s], and per path T entries of
        ``points`` (body index, x, y, z [m] in that body) and ``arc_excess`` [m] >= 0.

    Raises:
        InputDataError: A file cannot be used, or the motion does not belong to the model.
    """
    loaded = load_model(file)
    motion = read_motion(motion_file)
    postures = Postures(loaded, motion)
    paths = _paths(loaded.model, which)
    bodies = [body.getName() for body in loaded.model.getBodySet()]
    bodies.append("ground")
    index = {name: i for i, name in enumerate(bodies)}
    entries: dict[str, list[dict[str, Any]]] = {name: [] for name in paths}
    for frame in range(postures.n):
        state = postures.set(frame)
        for name, path in paths.items():
            entries[name].append(_entry(loaded.file, name, path, state, index))
        if progress is not None:
            progress(frame + 1, postures.n)
    return {
        "format": "condyle-path-snapshots",
        "version": 1,
        "source": f"{file.name} in the postures of {motion_file.name}",
        "bodies": bodies,
        "times": [float(time) for time in motion.times],
        "paths": entries,
    }


def write_snapshots(file: Path, snapshots: dict[str, Any]) -> None:
    """Writes a path snapshot file."""
    write_whole(file, to_text(snapshots))


def _paths(model: Any, which: Which) -> dict[str, Any]:
    """GeometryPaths by the names of the muscles and ligaments that run along them."""
    library = opensim_library()
    paths = {}
    for component in model.getComponentsList():
        force = library.Force.safeDownCast(component)
        path = geometry_path(force) if force is not None else None
        if path is None:
            continue
        wraps = path.getWrapSet()
        kinds = {
            wraps.get(i).getWrapObject().getConcreteClassName() for i in range(wraps.getSize())
        }
        if which == "all" or (kinds - _ANALYTIC if which == "beyond-cylinders" else kinds):
            paths[force.getName()] = path
    return paths


def _entry(file: Path, name: str, path: Any, state: Any, index: dict[str, int]) -> dict[str, Any]:
    points, in_ground = [], []
    current = path.getCurrentPath(state)
    for i in range(current.getSize()):
        point = current.get(i)
        body, location = point_in_body(point.getParentFrame(), point.getLocation(state))
        points.append([index[body], *location])
        p = point.getLocationInGround(state)
        in_ground.append([p.get(k) for k in range(3)])
    chords = np.linalg.norm(np.diff(np.array(in_ground), axis=0), axis=1)
    excess = path.getLength(state) - math.fsum(chords)
    if excess < -_ROUNDING:
        raise InputDataError(
            f"{file}: path {name}: OpenSim's length is {-excess:.3g} m below that of its own points"
        )
    return {"points": points, "arc_excess": max(excess, 0.0)}
