# SPDX-License-Identifier: Apache-2.0
"""What there is to see of a model at one configuration: plain arrays in ground, for a picture."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def _nothing(*shape: int) -> Array:
    return np.empty((0, *shape))


@dataclass(frozen=True)
class Polyline:
    """A muscle's or ligament's line.

    Attributes:
        name: of the muscle or ligament.
        points: (k, 3) in ground [m].
        amount: What colours it: activity of a muscle, strain of a ligament; NaN where unknown.
    """

    name: str
    points: Array
    amount: float = float("nan")


@dataclass(frozen=True)
class Surface:
    """A triangle mesh where its body is.

    Attributes:
        name: of the contact surface.
        vertices: (v, 3) in ground [m].
        faces: (f, 3) indices.
    """

    name: str
    vertices: Array
    faces: NDArray[np.int64]


@dataclass(frozen=True)
class ModelScene:
    """One configuration of a model.

    Attributes:
        title: Model and time.
        bones: (k, 2, 3) [m] a line of a body: from the joint that it hangs on to one that hangs on it.
        plates: Bodies with three joints and more: (k, 3) these joints [m].
        joints: (joints, 3) where bodies hang [m].
        muscles: Their lines.
        ligaments: Theirs.
        surfaces: Contact surfaces.
        markers: (markers, 3) [m].
        forces: (k, 2, 3) point and force [m, N] of external loads.
        up: (3,) unit vector against gravity.
        forward: (3,) horizontal unit vector to where the body faces.
    """

    title: str
    bones: Array = field(default_factory=lambda: _nothing(2, 3))
    plates: tuple[Array, ...] = ()
    joints: Array = field(default_factory=lambda: _nothing(3))
    muscles: tuple[Polyline, ...] = ()
    ligaments: tuple[Polyline, ...] = ()
    surfaces: tuple[Surface, ...] = ()
    markers: Array = field(default_factory=lambda: _nothing(3))
    forces: Array = field(default_factory=lambda: _nothing(2, 3))
    up: Array = field(default_factory=lambda: np.array([0.0, 1.0, 0.0]))
    forward: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
