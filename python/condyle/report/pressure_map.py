# SPDX-License-Identifier: Apache-2.0
"""Pressure maps: the insert seen from above, coloured by contact pressure, one panel a contact and pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from numpy.typing import NDArray

from condyle.contact import CompartmentMap, ContactMap
from condyle.report.style import COLOURS

_POLYETHYLENE = "#eeece6"
_OUTLINE = "#8a877f"
#: Perceptually uniform; its dark end is left out, so that outlines and marks stay visible on it.
_COLOUR_MAP = "plasma_r"
_PANEL_WIDTH, _PANEL_HEIGHT = 2.8, 2.2  # [inch]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Panel:
    """One picture of the figure.

    Attributes:
        title: What it shows; a second line with the loads is added.
        contact: The contact there.
    """

    title: str
    contact: ContactMap


def pressure_map_figure(
    panels: list[Panel],
    *,
    columns: int = 3,
    highest_mpa: float | None = None,
    title: str | None = None,
) -> Figure:
    """Inserts from above under load: x anterior up, z to the subject's right.

    Faces are coloured by contact pressure on one scale for all panels. A cross marks each side's centre of pressure, a
    line the border of its contact.

    Args:
        panels: At least one.
        columns: Panels side by side.
        highest_mpa: End of the colour scale [MPa]; by default the highest pressure shown.
        title: Of the figure.
    """
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    peak = max(1e-6 * panel.contact.peak_pressure for panel in panels)
    colours = ScalarMappable(Normalize(0.0, highest_mpa or max(peak, 1e-3)), _COLOUR_MAP)
    scale = 1.7 if len(panels) == 1 else 1.0  # a picture by itself may be larger
    figure = Figure(
        figsize=(
            scale * _PANEL_WIDTH * columns + 0.9,
            scale * _PANEL_HEIGHT * rows + (0.5 if title else 0.15),
        ),
        layout=ConstrainedLayoutEngine(h_pad=0.09),  # a row's ticks to the next row's titles [inch]
    )
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for axis, panel in zip(axes.flat, panels, strict=False):
        _draw(axis, panel, colours)
    for axis in axes.flat[len(panels) :]:
        axis.set_axis_off()
    for axis in axes[:, 0]:
        axis.set_ylabel("x, anterior [mm]")
    for column in range(columns):
        lowest = (len(panels) - 1 - column) // columns
        axes[lowest, column].set_xlabel("z, to the right [mm]")
        axes[lowest, column].tick_params(labelbottom=True)
    clipped = highest_mpa is not None and peak > highest_mpa
    figure.colorbar(
        colours,
        ax=axes,
        label="contact pressure [MPa]",
        aspect=18 * rows,
        fraction=0.05,
        pad=0.02,
        extend="max" if clipped else "neither",
    )
    if title:
        figure.suptitle(title, fontweight="bold", fontsize=11)
    return figure


def _plan(points: Floats) -> Floats:
    """(…, 3) in T [m] to (z, x) [mm]: right across, anterior up."""
    plan: Floats = 1e3 * points[..., [2, 0]]
    return plan


def _draw(axis: Axes, panel: Panel, colours: ScalarMappable) -> None:
    contact = panel.contact
    axis.set_aspect("equal")
    axis.grid(visible=False)
    for name, side in contact.sides.items():
        _draw_side(axis, side, colours)
        z, _ = _plan(side.vertices).mean(axis=0)
        x = 1e3 * float(side.vertices[:, 0].min())
        axis.annotate(
            name, (z, x), (0, -2), textcoords="offset points", ha="center", va="top", fontsize=7.5
        )
    axis.autoscale_view()
    axis.margins(x=0.04, y=0.1)
    medial, lateral = (contact.sides[name].wrench[1] for name in ("medial", "lateral"))
    loads = f"medial {medial:.0f} N · lateral {lateral:.0f} N"
    if contact.status != "ok":
        loads += " · implausible"
    axis.set_title(f"{panel.title}\n", fontsize=9, pad=4)
    axis.annotate(
        f"{loads}, peak {1e-6 * contact.peak_pressure:.1f} MPa",
        (0.5, 1.0),
        (0, 4),
        xycoords="axes fraction",
        textcoords="offset points",
        ha="center",
        fontsize=7.5,
        color=COLOURS["total"],
    )


def _draw_side(axis: Axes, side: CompartmentMap, colours: ScalarMappable) -> None:
    plan = _plan(side.vertices)
    triangles = plan[side.faces]
    loaded = side.pressure > 0.0
    axis.add_collection(
        PolyCollection(
            list(triangles), facecolors=_POLYETHYLENE, edgecolors=_POLYETHYLENE, linewidths=0.3
        )
    )
    if loaded.any():
        faces = colours.to_rgba(1e-6 * side.pressure[loaded])
        axis.add_collection(
            PolyCollection(
                list(triangles[loaded]), facecolors=faces, edgecolors="face", linewidths=0.3
            )
        )
        axis.add_collection(
            LineCollection(
                list(plan[_border(side.faces[loaded])]), colors=COLOURS["total"], linewidths=0.5
            )
        )
        centre = _plan(side.centre_of_pressure)
        axis.plot(*centre, marker="+", color="white", markersize=8, markeredgewidth=2.6)
        axis.plot(*centre, marker="+", color="black", markersize=7, markeredgewidth=1.1)
    axis.add_collection(
        LineCollection(list(plan[_border(side.faces)]), colors=_OUTLINE, linewidths=0.7)
    )


def _border(faces: NDArray[np.int32]) -> NDArray[np.int32]:
    """(n, 2) sides that one face alone has."""
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, count = np.unique(sides, axis=0, return_counts=True)
    return np.asarray(unique[count == 1])
