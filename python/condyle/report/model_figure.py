# SPDX-License-Identifier: Apache-2.0
"""A musculoskeletal model at one time frame: the body from two sides, and its contact surfaces near by."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray

if TYPE_CHECKING:
    from condyle.model.scene import ModelScene, Polyline, Surface

Array = NDArray[np.float64]
_BONE: Final = "#555555"
_LIGAMENT: Final = "#0072B2"
_SLACK: Final = "#A6CEE3"
_MUSCLE: Final = "#B22222"
_FORCE: Final = "#009E73"
_SURFACES: Final = ("#C9B79C", "#8FB6C9", "#B9C98F")
#: Newtons that are drawn one metre long.
_FORCE_SCALE: Final = 1500.0
#: Triangles drawn of one surface at most: a picture needs no more, and matplotlib sorts them all.
_TRIANGLES: Final = 6000
#: Half-width of the close view [m].
_NEAR: Final = 0.11
#: (title, elevation, azimuth) [deg] with y upwards.
_SIDE: Final = ("from the right", 0.0, -90.0)
_FRONT: Final = ("from the front", 0.0, 0.0)


def model_figure(scene: ModelScene) -> Figure:
    """Draws a scene: muscles by activity (dark: high), ligaments (pale: slack), external forces, markers.

    The close view is around the contact surfaces; without any it is left out.
    """
    views = [_SIDE, _FRONT] + ([("at the contact surfaces", 12.0, -60.0)] if scene.surfaces else [])
    figure = Figure(figsize=(4.2 * len(views), 6.4), layout="constrained")
    figure.suptitle(scene.title)
    for index, (title, elevation, azimuth) in enumerate(views):
        near = index == 2
        axes = figure.add_subplot(1, len(views), index + 1, projection="3d")
        axes.set_title(title)
        axes.view_init(elev=elevation, azim=azimuth)
        axes.set_proj_type("ortho")
        _draw(axes, scene, near=near)
        _frame(axes, scene, near=near)
    return figure


def _drawn(points: Array) -> Array:
    """Ground's (x forward, y up, z right) as matplotlib's (x, y into the page, z up)."""
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def _draw(axes: Any, scene: ModelScene, *, near: bool) -> None:
    thick = 1.6 if near else 1.0
    axes.add_collection3d(
        Line3DCollection(_drawn(scene.bones), colors=_BONE, linewidths=2.2 * thick)
    )
    for surface, colour in zip(scene.surfaces, _cycle(_SURFACES), strict=False):
        axes.add_collection3d(_patches(surface, colour))
    _lines(axes, scene.ligaments, [_ligament_colour(line) for line in scene.ligaments], 0.6 * thick)
    _lines(axes, scene.muscles, _muscle_colours(scene.muscles), 1.3 * thick)
    if near:
        return
    if len(scene.markers):
        axes.scatter(*_drawn(scene.markers).T, s=3, color="#CC79A7", depthshade=False)
    for point, force in scene.forces:
        ends = np.stack([point, point + force / _FORCE_SCALE])
        axes.plot(*_drawn(ends).T, color=_FORCE, linewidth=2.0)


def _cycle(colours: Iterable[str]) -> Iterable[str]:
    colours = list(colours)
    while True:
        yield from colours


def _patches(surface: Surface, colour: str) -> Poly3DCollection:
    step = max(1, -(-len(surface.faces) // _TRIANGLES))
    triangles = _drawn(surface.vertices)[surface.faces[::step]]
    return Poly3DCollection(triangles, facecolors=colour, edgecolors="none", alpha=0.55)


def _lines(axes: Any, lines: tuple[Polyline, ...], colours: list[Any], width: float) -> None:
    if lines:
        drawn = [_drawn(line.points) for line in lines]
        axes.add_collection3d(Line3DCollection(drawn, colors=colours, linewidths=width))


def _ligament_colour(line: Polyline) -> str:
    return _SLACK if line.amount <= 0.0 else _LIGAMENT


def _muscle_colours(lines: tuple[Polyline, ...]) -> list[Any]:
    scale, colour_map = Normalize(0.0, 1.0, clip=True), colormaps["Reds"]
    return [
        _MUSCLE if np.isnan(line.amount) else colour_map(0.25 + 0.75 * float(scale(line.amount)))
        for line in lines
    ]


def _frame(axes: Any, scene: ModelScene, *, near: bool) -> None:
    """Equal scales, no ticks."""
    if near:
        middle = np.mean([_drawn(s.vertices).mean(axis=0) for s in scene.surfaces], axis=0)
        half = np.full(3, _NEAR)
    else:
        shown = [_drawn(scene.centres)]
        shown += [_drawn(line) for line in scene.bones]
        points = np.concatenate(shown)
        low, high = points.min(axis=0), points.max(axis=0)
        middle, half = (low + high) / 2, (high - low) / 2 + 0.1
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    axes.set_zlim(middle[2] - half[2], middle[2] + half[2])
    axes.set_box_aspect(half)
    axes.set_axis_off()
