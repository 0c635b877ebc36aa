# SPDX-License-Identifier: Apache-2.0
"""The implant at a pose, and the contact pressure on the insert seen from above."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from condyle.report.style import PRESSURE_MAP

Floats = NDArray[np.float64]
Faces = NDArray[np.int32]

_METAL = np.array([0.62, 0.66, 0.72])
_POLYETHYLENE = np.array([0.93, 0.92, 0.88])
# Towards the viewer's upper left, in plot axes (z right, x anterior, y up).
_LIGHT = np.array([-0.35, -0.45, 0.82])


def _to_plot_axes(points: Floats) -> Floats:
    """(x anterior, y up, z right) in m to plot axes (right, anterior, up) in mm."""
    moved: Floats = 1e3 * points[..., [2, 0, 1]]
    return moved


def _shaded(triangles: Floats, base: Floats) -> Floats:
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    # Plot axes are a rotation of the model's, so normals keep their sense; an open surface is lit from both sides.
    brightness = 0.42 + 0.58 * np.abs(normals @ (_LIGHT / np.linalg.norm(_LIGHT)))
    shades: Floats = np.clip(base * brightness[:, None], 0.0, 1.0)
    return shades


def implant_figure(
    femur: tuple[Floats, Faces],
    inserts: list[tuple[Floats, Faces]],
    pressures: list[Floats],
    rotation_TF: Floats,
    p_TFo_T: Floats,
    title: str,
) -> Figure:
    """The femoral component on the insert, and the pressure map.

    Args:
        femur: vertices (n, 3) in F [m] and faces (m, 3).
        inserts: vertices in T and faces of the compartments.
        pressures: pressure of each compartment's faces [Pa].
        rotation_TF: R_TF (3, 3).
        p_TFo_T: femoral origin in T (3,) [m].
        title: of the figure.
    """
    figure = Figure(figsize=(11, 5.2), layout="constrained")
    peak = max((float(p.max()) for p in pressures if p.size), default=0.0)
    scale = Normalize(0.0, max(peak, 1.0) * 1e-6)
    colours = ScalarMappable(scale, PRESSURE_MAP)

    view = figure.add_subplot(1, 2, 1, projection="3d")
    vertices = femur[0] @ rotation_TF.T + p_TFo_T
    groups = [(_to_plot_axes(vertices)[femur[1]], _METAL)]
    groups += [(_to_plot_axes(v)[f], _POLYETHYLENE) for v, f in inserts]
    # One collection, so that faces of all parts are sorted by depth together.
    triangles = np.concatenate([t for t, _ in groups])
    shades = np.concatenate([_shaded(t, base) for t, base in groups])
    view.add_collection3d(
        Poly3DCollection(triangles, facecolors=shades, edgecolors=shades, linewidths=0.3)
    )
    everything = triangles.reshape(-1, 3)
    low, high = everything.min(axis=0), everything.max(axis=0)
    view.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    view.set_box_aspect(high - low, zoom=1.25)
    view.view_init(elev=10, azim=35)  # from the front and the right
    view.set_axis_off()
    view.set_title(title)

    top = figure.add_subplot(1, 2, 2)
    for (v, f), pressure in zip(inserts, pressures, strict=True):
        triangles = _to_plot_axes(v)[f][:, :, :2]
        face_colours = colours.to_rgba(pressure * 1e-6)
        face_colours[pressure <= 0.0, :3] = _POLYETHYLENE
        top.add_collection(
            PolyCollection(
                list(triangles), facecolors=face_colours, edgecolors="face", linewidths=0.1
            )
        )
    top.autoscale_view()
    top.set_aspect("equal")
    top.grid(visible=False)
    top.set(xlabel="z, to the right [mm]", ylabel="x, anterior [mm]")
    top.set_title("pressure on the insert, from above (p = K·d)")
    figure.colorbar(colours, ax=top, label="pressure [MPa]", shrink=0.8)
    return figure
