# SPDX-License-Identifier: Apache-2.0
"""The axis about which a patella turns: a cylinder fitted to the trochlea of a femoral component.

Which faces are the trochlea's, in the axes of a Condyle mesh (x anterior, y superior, z to the subject's right):

1. their normal lies within 15° of the sagittal plane: the floor of the groove, not its flanks;
2. and points from 5° to 70° downwards of straight anterior. A flange that faces anterior within 5° is straight: a
   patella slides along it. 70° is as far as a patella flexes with a knee of some 100°;
3. they are in the middle half of the component's width;
4. of the patches that such faces make over shared edges, one: the most central among those with a third of the largest
   one's area or more. The others are crests of the flange and edges of the notch.

Nothing of it knows left from right: a left component's fit is the right one's mirrored in z.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle._core.geometry import Mesh
from condyle.errors import InputDataError
from condyle.model.cylinder_fit import CylinderFit, fit_cylinder

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

_FLOOR: Final = np.radians(15.0)  # rule 1
_ANTERIOR: Final = np.radians(5.0)  # rule 2
_DISTAL: Final = np.radians(70.0)
_MIDDLE: Final = 0.25  # rule 3: half the band, of the component's width
_CONSIDERED: Final = 1.0 / 3.0  # rule 4, of the largest area

#: What a trochlea is taken for. Four components (two real, two of our own) have an RMS of 0.12 to 0.29 mm over 65° and
#: lie within 0.04 widths of the middle; a condyle's edge of the notch at 0.2.
_LEAST_FACES: Final = 30
_LARGEST_RMS: Final = 0.5e-3
_LEAST_ARC: Final = np.radians(40.0)
_FARTHEST: Final = 1.0 / 6.0  # mean z of the patch from the middle, of the width


@dataclass(frozen=True)
class Trochlea:
    """The fit, and what it was fitted to; in the mesh's coordinates.

    Attributes:
        cylinder: its ``axis`` points to the subject's right; turning the patella about it negatively flexes.
        faces: (n,) indices into the mesh's faces.
    """

    cylinder: CylinderFit
    faces: Indices


def fit_trochlea(mesh: Mesh, name: str = "femur") -> Trochlea:
    """The cylinder nearest to the faces of the trochlea, weighted by their areas.

    Args:
        mesh: femoral component in Condyle's axes, normals out of it [m].
        name: of the surface, for messages.

    Raises:
        InputDataError: this is no trochlea: too few such faces, off the middle, an arc too short, or too far from a
            cylinder; says value and limit.
    """
    vertices, corners = np.asarray(mesh.vertices), np.asarray(mesh.faces).astype(np.intp)
    centroids, normals, areas = _faces(vertices, corners)
    faces = _trochlear(vertices, corners, centroids, normals, areas, name)
    fit = fit_cylinder(centroids[faces], normals[faces], areas[faces])
    _require_a_trochlea(fit, name)
    return Trochlea(replace(fit, axis=np.sign(fit.axis[2]) * fit.axis), faces)


def _faces(vertices: Array, corners: Indices) -> tuple[Array, Array, Array]:
    """(n, 3) centroids and unit normals, (n,) areas."""
    p, q, r = (vertices[corners[:, k]] for k in range(3))
    cross = np.cross(q - p, r - p)
    doubled = np.linalg.norm(cross, axis=1)
    return (p + q + r) / 3.0, cross / np.maximum(doubled, 1e-300)[:, None], 0.5 * doubled


def _trochlear(
    vertices: Array, corners: Indices, centroids: Array, normals: Array, areas: Array, name: str
) -> Indices:
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    width, aside = high - low, centroids[:, 2] - 0.5 * (low + high)
    downwards = np.arctan2(-normals[:, 1], normals[:, 0])
    kept = np.flatnonzero(
        (np.abs(normals[:, 2]) <= np.sin(_FLOOR))
        & (downwards >= _ANTERIOR)
        & (downwards <= _DISTAL)
        & (np.abs(aside) <= _MIDDLE * width)
        & (areas > 0.0)
    )
    patches = [kept[patch] for patch in _patches(corners[kept])]
    weights = [float(areas[patch].sum()) for patch in patches]
    means = [float(areas[patch] @ aside[patch] / areas[patch].sum()) for patch in patches]
    large = [i for i, area in enumerate(weights) if area >= _CONSIDERED * max(weights)]
    chosen = min(large, key=lambda i: abs(means[i]), default=None)
    found = 0 if chosen is None else len(patches[chosen])
    what = f"surface {name!r} does not look like a trochlea (x anterior, y superior, z right)"
    if chosen is None or found < _LEAST_FACES:
        raise InputDataError(
            f"{what}: {found} connected faces of its middle look forward and down: must be at least {_LEAST_FACES}"
        )
    if abs(means[chosen]) > _FARTHEST * width:
        raise InputDataError(
            f"{what}: the faces that look forward and down are {1e3 * abs(means[chosen]):.3g} mm from its middle: must "
            f"be at most {1e3 * _FARTHEST * width:.3g} mm"
        )
    return patches[chosen]


def _patches(corners: Indices) -> list[Indices]:
    """Faces that hang together over shared edges, as lists of rows of ``corners``."""
    if len(corners) == 0:
        return []
    edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]))
    owners = np.tile(np.arange(len(corners)), 3)
    order = np.lexsort(edges.T)
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    first, second = owners[order[:-1]][same], owners[order[1:]][same]
    # The least index of a patch spreads over its edges until nothing changes.
    labels = np.arange(len(corners))
    while True:
        before = labels.copy()
        least = np.minimum(labels[first], labels[second])
        np.minimum.at(labels, first, least)
        np.minimum.at(labels, second, least)
        labels = labels[labels]
        if (labels == before).all():
            break
    return [np.flatnonzero(labels == label) for label in np.unique(labels)]


def _require_a_trochlea(fit: CylinderFit, name: str) -> None:
    what = f"surface {name!r} does not look like a trochlea"
    if not fit.converged or fit.rms > _LARGEST_RMS:
        raise InputDataError(
            f"{what}: {fit.points} faces lie {1e3 * fit.rms:.3g} mm RMS off a cylinder: must be at most "
            f"{1e3 * _LARGEST_RMS:g} mm"
        )
    if fit.arc < _LEAST_ARC:
        raise InputDataError(
            f"{what}: {fit.points} faces reach over {np.degrees(fit.arc):.3g}° of a cylinder: must be at least "
            f"{np.degrees(_LEAST_ARC):g}°"
        )
