# SPDX-License-Identifier: Apache-2.0
"""What there is to see of a model at one configuration: plain arrays in ground, for a picture."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
        bones: A line a body, from the joint that it hangs on to each joint that hangs on it: (k, 2, 3) [m].
        centres: (bodies, 3) mass centres [m].
        muscles: Their lines.
        ligaments: Theirs.
        surfaces: Contact surfaces.
        markers: (markers, 3) [m].
        forces: (k, 2, 3) point and force [m, N] of external loads.
    """

    title: str
    bones: Array
    centres: Array
    muscles: tuple[Polyline, ...] = ()
    ligaments: tuple[Polyline, ...] = ()
    surfaces: tuple[Surface, ...] = ()
    markers: Array = field(default_factory=lambda: np.empty((0, 3)))
    forces: Array = field(default_factory=lambda: np.empty((0, 2, 3)))
