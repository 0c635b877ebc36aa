# SPDX-License-Identifier: Apache-2.0
"""Frames of OpenSim as frames fixed to a body: translation and body-fixed x-y-z angles."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from condyle.opensim.library import opensim_library

Array = npt.NDArray[np.float64]


def vector(value: Any) -> list[float]:
    """Three numbers of a ``SimTK::Vec3``."""
    return [float(value.get(i)) for i in range(3)]


def rotation_matrix(rotation: Any) -> Array:
    """Matrix (3,3) of a ``SimTK::Rotation``."""
    return np.array([[rotation.get(i, j) for j in range(3)] for i in range(3)])


def frame_in_body(frame: Any) -> dict[str, Any]:
    """A physical frame in the body that it is fixed to, as a model file says it.

    R = Rx·Ry·Rz of ``orientation_xyz`` [rad]; ``translation`` [m].
    """
    base = frame.findBaseFrame()
    X = frame.findTransformInBaseFrame()
    return _described(base.getName(), X)


def compose(frame: Any, transform: Any) -> dict[str, Any]:
    """As :func:`frame_in_body`, of what stands at ``transform`` in a frame."""
    X = frame.findTransformInBaseFrame().compose(transform)
    return _described(frame.findBaseFrame().getName(), X)


def point_in_body(frame: Any, location: Any) -> tuple[str, list[float]]:
    """Body and location in it [m] of a point of a frame."""
    base = frame.findBaseFrame()
    if base.getName() == frame.getName():
        return base.getName(), vector(location)
    X = frame.findTransformInBaseFrame()
    p = rotation_matrix(X.R()) @ np.array(vector(location)) + np.array(vector(X.p()))
    return base.getName(), [float(value) for value in p]


def find_frame(model: Any, path: str) -> Any:
    """The physical frame at a path of a model, None where there is none.

    A path may be absolute (/bodyset/femur_r) or a name of old (femur_r).
    """
    library = opensim_library()
    for candidate in (path, f"/bodyset/{path}"):
        if model.hasComponent(candidate):
            return library.PhysicalFrame.safeDownCast(model.getComponent(candidate))
    return None


def _described(body: str, X: Any) -> dict[str, Any]:
    angles = X.R().convertRotationToBodyFixedXYZ()
    return {"body": body, "translation": vector(X.p()), "orientation_xyz": vector(angles)}
