# SPDX-License-Identifier: Apache-2.0
"""Orthographic views of a model's scene: what is seen from where, in the plane of the picture."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from condyle.model.scene import ModelScene

Array = NDArray[np.float64]
#: Half the height of the close view [m], and its width of that.
_NEAR: Final = 0.115
_NEAR_WIDTH: Final = 0.72
#: Room around the body [m].
_MARGIN: Final = 0.08
#: Narrowest view, of its height.
_LEAST_WIDTH: Final = 0.35
#: The close view is turned so far from the side to the front, and looks down so far [rad].
_TURN: Final = np.radians(38.0)
_DOWN: Final = np.radians(12.0)


@dataclass(frozen=True)
class View:
    """From where a scene is seen, and how much of it.

    Attributes:
        title: in words.
        axes: (3, 3) rows: to the right of the picture, up in it, towards who looks.
        low: (2,) lower left corner of what is shown, in the picture's plane [m].
        high: (2,) upper right corner.
        centre: (3,) point in ground in the middle of the close view [m].
        near: whether it is the close view.
    """

    title: str
    axes: Array
    low: Array
    high: Array
    centre: Array = field(default_factory=lambda: np.zeros(3))
    near: bool = False

    def flat(self, points: Array) -> Array:
        """(…, 3) points in ground → (…, 2) in the picture's plane [m]."""
        return np.asarray(points @ self.axes[:2].T)

    def depth(self, points: Array) -> Array:
        """(…, 3) points in ground → (…) how near to who looks [m]."""
        return np.asarray(points @ self.axes[2])

    @property
    def aspect(self) -> float:
        """Width over height."""
        width, height = self.high - self.low
        return float(width / height)


def views_of(scene: ModelScene) -> list[View]:
    """From the side that has the muscles, from the front, and near the contact surfaces or the ligaments."""
    right = np.cross(scene.forward, scene.up)
    side, word = right, "right"
    if _muscles_are_left(scene, right):
        side, word = -right, "left"
    body = np.concatenate(
        [scene.bones.reshape(-1, 3), scene.joints, _ends(scene)]
        + [line.points for line in (*scene.muscles, *scene.ligaments)]
    )
    found = [
        _view(f"from the {word}", side, scene.up, body),
        _view("from the front", scene.forward, scene.up, body),
    ]
    middle, what = _middle(scene)
    if middle is not None:
        towards = np.cos(_TURN) * side + np.sin(_TURN) * scene.forward
        towards = np.cos(_DOWN) * towards + np.sin(_DOWN) * scene.up
        axes = _axes(towards, scene.up)
        centre, half = axes[:2] @ middle, _NEAR * np.array([_NEAR_WIDTH, 1.0])
        title = f"{what}, from the front {word}"
        found.append(View(title, axes, centre - half, centre + half, middle, near=True))
    return found


def _axes(towards: Array, up: Array) -> Array:
    across = np.cross(up, towards)
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(towards, across), towards])


def _view(title: str, towards: Array, up: Array, points: Array) -> View:
    axes = _axes(towards, up)
    flat = points @ axes[:2].T
    low, high = flat.min(axis=0) - _MARGIN, flat.max(axis=0) + _MARGIN
    height = high[1] - low[1]
    short = np.array([max(0.0, _LEAST_WIDTH * height - (high[0] - low[0])) / 2, 0.0])
    return View(title, axes, low - short, high + short)


def _ends(scene: ModelScene) -> Array:
    """Where external forces act."""
    return scene.forces[:, 0].reshape(-1, 3)


def _muscles_are_left(scene: ModelScene, right: Array) -> bool:
    lines = scene.muscles or scene.ligaments
    if not lines or len(scene.joints) == 0:
        return False
    there = np.concatenate([line.points for line in lines]) @ right
    return bool(np.median(there) < np.median(scene.joints @ right) - 0.02)


def _middle(scene: ModelScene) -> tuple[Array | None, str]:
    if scene.surfaces:
        boxes = [(s.vertices.min(axis=0) + s.vertices.max(axis=0)) / 2 for s in scene.surfaces]
        return np.mean(boxes, axis=0), "contact surfaces"
    if scene.ligaments:
        return np.median(np.concatenate([s.points for s in scene.ligaments]), axis=0), "ligaments"
    return None, ""
