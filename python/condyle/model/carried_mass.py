# SPDX-License-Identifier: Apache-2.0
"""A body's mass given to the body that carries it, in a model file's own terms."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Content = dict[str, Any]

_NONE = [0.0] * 6


def carry_mass(content: Content, child: str, parent: str, X_BC: Array) -> None:
    """Gives a child's mass, where it is in the parent, to the parent; mass centre and inertia become those of both.

    Args:
        content: of a model file; is changed.
        child: body.
        parent: body, or ground, which has no mass.
        X_BC: (4, 4) the child in the parent.
    """
    bodies = {body["name"]: body for body in content["bodies"]}
    light = bodies[child]
    if parent in bodies:
        heavy = bodies[parent]
        centre = X_BC[:3, :3] @ _centre(light) + X_BC[:3, 3]
        tensor = X_BC[:3, :3] @ _tensor(light) @ X_BC[:3, :3].T
        parts = [
            (float(heavy["mass"]), _centre(heavy), _tensor(heavy)),
            (float(light["mass"]), centre, tensor),
        ]
        mass = sum(m for m, _, _ in parts)
        if mass > 0.0:
            whole = sum((m * c for m, c, _ in parts), np.zeros(3)) / mass
            about = sum((J + m * _steiner(c - whole) for m, c, J in parts), np.zeros((3, 3)))
            heavy |= {"mass": mass, "mass_centre": whole.tolist(), "inertia": _listed(about)}
    light |= {"mass": 0.0, "inertia": list(_NONE)}


def _centre(body: Content) -> Array:
    return np.array(body.get("mass_centre", [0.0, 0.0, 0.0]), dtype=np.float64)


def _tensor(body: Content) -> Array:
    xx, yy, zz, xy, xz, yz = body.get("inertia", _NONE)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=np.float64)


def _listed(J: Array) -> list[float]:
    return [float(J[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def _steiner(d: Array) -> Array:
    """Inertia of a unit mass at d."""
    return np.asarray((d @ d) * np.eye(3) - np.outer(d, d))
