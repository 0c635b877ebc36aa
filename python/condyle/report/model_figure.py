# SPDX-License-Identifier: Apache-2.0
"""A musculoskeletal model at one time frame: the body from the side and the front, and its implant near by.

Views are orthographic and drawn flat, far things first: what a three-dimensional axis of matplotlib would
draw, without the room that it leaves around it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from condyle.report.model_views import View, views_of

if TYPE_CHECKING:
    from condyle.model.scene import ModelScene, Polyline, Surface

Array = NDArray[np.float64]
#: Active muscles are thick and dark, resting ones thin and pale; likewise taut ligaments.
ACTIVITY: Final = LinearSegmentedColormap.from_list(
    "activity", ["#E3BCB0", "#E5836B", "#C1272D", "#5E0A17"]
)
STRAIN: Final = LinearSegmentedColormap.from_list("strain", ["#6FB1DE", "#1F6FB2", "#08306B"])
#: Darkest at these.
_MOST_ACTIVITY: Final = 1.0
_MOST_STRAIN: Final = 0.1
SLACK: Final = "#B9CFE4"
_MUSCLE: Final = "#C1272D"
_LIGAMENT: Final = "#1F6FB2"
_BONE: Final = "#EFE9DC"
_BONE_EDGE: Final = "#8C857A"
_PLATE: Final = "#F5F1E8"
_FORCE: Final = "#00805E"
_MARKER: Final = "#7A6A8A"
#: Metal, polyethylene, and what else there is.
_SURFACES: Final = ("#A9B8C9", "#EAD9B0", "#D9C2A0", "#B7C9A9")
#: Half the width of a bone's stick [m].
_BONE_RADIUS: Final = 0.011
#: Bones farther from the centre of the close view are not in it [m].
_NEAR_BONE: Final = 0.09
#: Newtons that are drawn one metre long.
_FORCE_SCALE: Final = 1600.0
#: Triangles drawn of one surface where it is small in the picture.
_FEW_TRIANGLES: Final = 3000
#: Lengths of the scale [m].
_BARS: Final = (0.2, 0.1, 0.05, 0.02)
_HEIGHT: Final = 6.6  # [in] of a view
_STRIP: Final = 0.75  # [in] of the legend below
_POINTS: Final = 72.0  # [1/in]


def model_figure(scene: ModelScene) -> Figure:
    """Draws a scene.

    Muscles are coloured by activity and ligaments by strain, pale where slack; in one colour where the scene does
    not know. The side view is from the side that has the muscles. The close view is around the contact surfaces,
    else around the ligaments; without both it is left out, and it shows neither markers nor forces.
    """
    views = views_of(scene)
    widths = [view.aspect * _HEIGHT for view in views]
    figure = Figure(figsize=(sum(widths) + 0.4, _HEIGHT + _STRIP + 0.6), layout="constrained")
    figure.suptitle(scene.title, fontweight="bold", fontsize=12)
    rows = figure.add_gridspec(2, 1, height_ratios=[_HEIGHT, _STRIP])
    columns = rows[0].subgridspec(1, len(views), width_ratios=widths)
    for index, view in enumerate(views):
        axes = figure.add_subplot(columns[0, index])
        axes.set_title(view.title, fontsize=10, fontweight="normal")
        _draw(axes, scene, view)
        _frame(axes, view)
    _draw_legend(figure, rows[1], scene)
    return figure


def _draw(axes: Axes, scene: ModelScene, view: View) -> None:
    points = np.concatenate([scene.bones.reshape(-1, 3), scene.joints, np.zeros((0, 3))])
    if view.near and scene.surfaces:
        middle = float(np.mean([view.depth(s.vertices).mean() for s in scene.surfaces]))
    else:
        middle = float(view.depth(points).mean()) if len(points) else 0.0
    _draw_bones(axes, scene, view)
    for index, surface in enumerate(scene.surfaces):
        axes.add_collection(_patches(surface, _SURFACES[index % len(_SURFACES)], view))
    thick = 1.5 if view.near else 1.0
    _draw_lines(axes, scene.ligaments, view, middle, thick, _ligament_look)
    _draw_lines(axes, scene.muscles, view, middle, thick, _muscle_look)
    if view.near:
        return
    if len(scene.markers):
        flat = view.flat(scene.markers)
        axes.scatter(
            flat[:, 0],
            flat[:, 1],
            s=7,
            facecolors="none",
            edgecolors=_MARKER,
            linewidths=0.6,
            zorder=6,
        )
    _draw_forces(axes, scene, view)


def _draw_bones(axes: Axes, scene: ModelScene, view: View) -> None:
    """Sticks of a bone's width, far ones first; pale in the close view, where they are in the way."""
    width = 2 * _BONE_RADIUS * _HEIGHT * _POINTS / (view.high[1] - view.low[1])
    alpha = 0.45 if view.near else 1.0
    edge = [patheffects.Stroke(linewidth=width + 1.4, foreground=_BONE_EDGE), patheffects.Normal()]
    for plate in () if view.near else scene.plates:
        axes.fill(
            *_hull(view.flat(plate)).T,
            facecolor=_PLATE,
            edgecolor=_BONE_EDGE,
            linewidth=0.7,
            zorder=1.0,
        )
    bones = np.array([bone for bone in scene.bones if not view.near or _is_near(bone, view)])
    bones = bones.reshape(-1, 2, 3)
    for rank, index in enumerate(np.argsort(view.depth(bones.mean(axis=1)))):
        (stick,) = axes.plot(
            *view.flat(bones[index]).T,
            color=_BONE,
            linewidth=width,
            alpha=alpha,
            solid_capstyle="round",
            zorder=1.1 + 0.001 * rank,
        )
        if not view.near:
            stick.set_path_effects(edge)
    if not view.near and len(scene.joints):
        flat = view.flat(scene.joints)
        axes.scatter(
            flat[:, 0], flat[:, 1], s=width**2 / 4, color=_BONE_EDGE, linewidths=0, zorder=1.9
        )


def _is_near(bone: Array, view: View) -> bool:
    """Whether a bone passes the close view's centre, and not the other leg's knee behind it."""
    start, along = bone[0], bone[1] - bone[0]
    length = float(along @ along)
    share = float(np.clip((view.centre - start) @ along / length, 0.0, 1.0)) if length > 0 else 0.0
    return float(np.linalg.norm(start + share * along - view.centre)) < _NEAR_BONE


def _hull(points: Array) -> Array:
    """Corners of the convex hull, in order (Andrew's monotone chain)."""
    ordered = points[np.lexsort((points[:, 1], points[:, 0]))]

    def half(sequence: Array) -> list[Array]:
        corners: list[Array] = []
        for p in sequence:
            while len(corners) > 1:
                a, b = corners[-1] - corners[-2], p - corners[-2]
                if a[0] * b[1] - a[1] * b[0] > 0:
                    break
                corners.pop()
            corners.append(p)
        return corners[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _patches(surface: Surface, colour: str, view: View) -> PolyCollection:
    """A mesh in the light of a lamp beside who looks, far triangles first."""
    step = 1 if view.near else max(1, -(-len(surface.faces) // _FEW_TRIANGLES))
    corners = surface.vertices[surface.faces[::step]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    lamp = np.array([-0.35, 0.6, 0.72]) @ view.axes
    # Open surfaces are seen from behind too.
    light = 0.45 + 0.55 * np.abs(normals @ lamp)
    base = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    order = np.argsort(view.depth(corners.mean(axis=1)))
    colours = np.clip(base * light[order, None], 0.0, 1.0)
    return PolyCollection(
        list(view.flat(corners[order])),
        facecolors=list(colours),
        edgecolors=list(colours),
        linewidths=0.25,
        zorder=3.0,
    )


def _draw_lines(
    axes: Axes, lines: tuple[Polyline, ...], view: View, middle: float, thick: float, look: Any
) -> None:
    """Pieces beyond the middle go below the surfaces, the others above; dark ones last."""
    for nearer in (False, True):
        pieces, colours, widths = [], [], []
        for line in sorted(lines, key=lambda line: np.nan_to_num(line.amount, nan=0.0)):
            colour, width = look(line.amount)
            ends = np.stack([line.points[:-1], line.points[1:]], axis=1)
            chosen = ends[(view.depth(ends.mean(axis=1)) >= middle) == nearer]
            pieces += list(view.flat(chosen))
            colours += [colour] * len(chosen)
            widths += [thick * width] * len(chosen)
        axes.add_collection(
            LineCollection(
                pieces,
                colors=colours,
                linewidths=widths,
                capstyle="round",
                zorder=4.0 if nearer else 2.5,
            )
        )


def _muscle_look(activity: float) -> tuple[Any, float]:
    if np.isnan(activity):
        return _MUSCLE, 1.4
    share = min(max(activity / _MOST_ACTIVITY, 0.0), 1.0)
    return ACTIVITY(share), 1.0 + 2.6 * share


def _ligament_look(strain: float) -> tuple[Any, float]:
    if np.isnan(strain):
        return _LIGAMENT, 0.8
    if strain <= 0.0:
        return SLACK, 0.5
    share = min(strain / _MOST_STRAIN, 1.0)
    return STRAIN(share), 0.8 + 0.8 * share


def _draw_forces(axes: Axes, scene: ModelScene, view: View) -> None:
    for point, force in scene.forces:
        tail, head = view.flat(point), view.flat(point + force / _FORCE_SCALE)
        axes.annotate(
            "",
            xy=(head[0], head[1]),
            xytext=(tail[0], tail[1]),
            arrowprops={
                "arrowstyle": "-|>",
                "color": _FORCE,
                "linewidth": 2.2,
                "shrinkA": 0,
                "shrinkB": 0,
            },
            zorder=5,
        )
        axes.annotate(
            f"{np.linalg.norm(force):.0f} N",
            xy=(head[0], head[1]),
            xytext=(7, 0),
            textcoords="offset points",
            color=_FORCE,
            fontsize=8,
            fontweight="bold",
            path_effects=[patheffects.withStroke(linewidth=2.5, foreground="white")],
            zorder=7,
        )


def _frame(axes: Axes, view: View) -> None:
    """Equal scales, no ticks, a bar that says how long things are."""
    axes.set_xlim(view.low[0], view.high[0])
    axes.set_ylim(view.low[1], view.high[1])
    axes.set_aspect("equal")
    axes.set_axis_off()
    width, height = view.high - view.low
    length = next((bar for bar in _BARS if bar <= 0.4 * width), _BARS[-1])
    label = f"{length:g} m" if length >= 0.1 else f"{1e3 * length:.0f} mm"
    x, y = view.low + 0.02 * height
    halo = [patheffects.withStroke(linewidth=2.5, foreground="white")]
    axes.plot([x, x + length], [y, y], color="#444444", linewidth=1.5, zorder=8)
    axes.text(
        x + length / 2,
        y + 0.008 * height,
        label,
        ha="center",
        fontsize=7,
        path_effects=halo,
        zorder=8,
    )


def _draw_legend(figure: Figure, place: Any, scene: ModelScene) -> None:
    """What the colours mean: words, then a scale for each that is known."""
    active = any(not np.isnan(line.amount) for line in scene.muscles)
    strained = any(not np.isnan(line.amount) for line in scene.ligaments)
    scales = [("muscle activity", ACTIVITY, _MOST_ACTIVITY)] if active else []
    scales += [("ligament strain, %", STRAIN, 100.0 * _MOST_STRAIN)] if strained else []
    cells = place.subgridspec(1, 3, width_ratios=[2.0, 1.0, 1.0])
    words = figure.add_subplot(cells[0, 0])
    words.set_axis_off()
    words.legend(handles=_handles(scene, active, strained), loc="center left", ncols=3, fontsize=8)
    for column, (label, colours, most) in enumerate(scales, start=1):
        inside = figure.add_subplot(cells[0, column])
        inside.set_axis_off()
        bar = figure.colorbar(
            ScalarMappable(Normalize(0.0, most), colours),
            cax=inside.inset_axes((0.06, 0.55, 0.88, 0.22)),
            orientation="horizontal",
        )
        bar.set_label(label, fontsize=8)
        bar.ax.tick_params(labelsize=7)


def _handles(scene: ModelScene, active: bool, strained: bool) -> list[Line2D]:
    def line(label: str, colour: str, width: float, **more: Any) -> Line2D:
        return Line2D([], [], color=colour, linewidth=width, label=label, **more)

    handles = []
    if scene.muscles and not active:
        handles.append(line("muscle", _MUSCLE, 1.6))
    if strained:
        handles.append(line("ligament, slack", SLACK, 1.4))
        handles.append(line("ligament, taut", _LIGAMENT, 1.6))
    elif scene.ligaments:
        handles.append(line("ligament", _LIGAMENT, 1.2))
    if len(scene.forces):
        handles.append(line("external force", _FORCE, 2.2))
    if len(scene.markers):
        handles.append(
            line("model marker", _MARKER, 0.0, marker="o", markersize=3.5, markerfacecolor="none")
        )
    for index, surface in enumerate(scene.surfaces):
        handles.append(line(surface.name, _SURFACES[index % len(_SURFACES)], 5.0))
    return handles
