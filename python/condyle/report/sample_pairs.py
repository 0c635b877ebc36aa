# SPDX-License-Identifier: Apache-2.0
"""Pair plots of samples: every variable against every other, domains in colour, outlines, curves."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from condyle.report.sample_space import (
    VARIABLES,
    SampleSpace,
    colour_of,
    convex_hull,
    given_columns,
    name_of,
)
from condyle.sampling import Outline

#: Domains whose loads are the activities' own, and those at the edge of contact, whose loads would
#: be a line on the same axes.
LOADED: Final = (1, 2)
AT_THE_EDGE: Final = (3, 4, 5, 6)
LOADED_VARIABLES: Final = ("x", "Fy", "z", "Mx", "theta_y", "theta_z")
EDGE_VARIABLES: Final = ("x", "y", "z", "theta_x", "theta_y", "theta_z", "Fy", "Mx")
#: Share of a compressed axis that the values beyond its knee are given.
_BEYOND_KNEE: Final = 0.25
#: How far beyond the samples an axis reaches for the sake of an outline, in ranges of the samples.
_OUTLINE_ROOM: Final = 0.3
_MASK_CELLS: Final = 240
_LEGEND_WIDTH: Final = 48
#: Margins for the labels [in].
_LEFT: Final = 0.8
_BOTTOM: Final = 0.55


def pair_figure(
    space: SampleSpace,
    domains: Sequence[int],
    variables: Sequence[str] = LOADED_VARIABLES,
    most_points: int = 1000,
) -> Figure:
    """Lower triangle of scatter plots, histograms on the diagonal.

    Args:
        space: the dataset.
        domains: those to show, the first one at the bottom.
        variables: names of VARIABLES.
        most_points: of each domain.
    """
    count = len(variables)
    width, height = 1.9 * count + _LEFT, 1.75 * count + _BOTTOM
    figure = Figure(figsize=(width, height))
    # Margins by hand: a layout engine would measure every panel several times.
    figure.subplots_adjust(
        left=_LEFT / width, right=1 - 0.1 / width, bottom=_BOTTOM / height, top=1 - 0.3 / height,
        wspace=0.12, hspace=0.24,
    )  # fmt: skip
    axes = figure.subplots(count, count, sharex="col", squeeze=False)
    shown = {domain: space.shown(domain, most_points) for domain in domains}
    ranges = {name: _axis_range(space, name, domains) for name in variables}
    for r, row in enumerate(variables):
        for c, column in enumerate(variables):
            axis = axes[r, c]
            if c > r:
                axis.set_visible(False)
                continue
            if c == r:
                _draw_histograms(axis, space, column, domains, ranges[column])
            else:
                _draw_outlines(axis, space, (column, row), domains, ranges)
                _draw_points(axis, space, (column, row), shown)
                _draw_curves(axis, space, (column, row), domains)
                ranges[row].apply(axis, "y")
            ranges[column].apply(axis, "x")
            _label(axis, row, column, first=c == 0, last=r == count - 1)
    figure.legend(
        handles=_handles(space, domains, shown),
        loc="upper right",
        bbox_to_anchor=(0.99, 0.97),
        fontsize=11,
        title_fontsize=11,
        alignment="left",
    )
    figure.align_ylabels()
    return figure


@dataclass(frozen=True)
class _AxisRange:
    """Limits of a variable's axis; beyond ``knee``, if any, the scale is compressed."""

    low: float
    high: float
    knee: float | None = None

    def apply(self, axis: Axes, which: str) -> None:
        set_scale = axis.set_xscale if which == "x" else axis.set_yscale
        set_limits = axis.set_xlim if which == "x" else axis.set_ylim
        if self.knee is not None:
            slope = _BEYOND_KNEE / (1 - _BEYOND_KNEE) * (self.knee - self.low)
            slope /= self.high - self.knee
            set_scale("function", functions=_compression(self.knee, slope))
            ticks = [*_round_ticks(self.low, self.knee), round(self.high)]
            set_ticks = axis.set_xticks if which == "x" else axis.set_yticks
            set_ticks(ticks, [f"{tick:g}" for tick in ticks])
            line = axis.axvline if which == "x" else axis.axhline
            line(self.knee, color="#444444", lw=0.7, ls=(0, (1, 2)), zorder=0)
        set_limits(self.low, self.high + (self.knee is not None) * 0.02 * (self.high - self.low))


def _compression(knee: float, slope: float) -> Any:
    def forward(values: Any) -> Any:
        values = np.asarray(values, dtype=float)
        return np.where(values <= knee, values, knee + slope * (values - knee))

    def inverse(values: Any) -> Any:
        values = np.asarray(values, dtype=float)
        return np.where(values <= knee, values, knee + (values - knee) / slope)

    return forward, inverse


def _round_ticks(low: float, high: float) -> list[float]:
    steps = [step for step in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0) if (high - low) / step <= 3]
    step = steps[0] if steps else (high - low) / 3
    first = np.ceil(low / step)
    return [step * i for i in range(int(first), int(high // step) + 1)]


def _axis_range(space: SampleSpace, name: str, domains: Sequence[int]) -> _AxisRange:
    """Around the samples, and the curves where they show domains of the activities."""
    near = [d for d in domains if d != 6] if name == "y" else list(domains)
    values = space.columns[name]
    parts = [values[space.domain == domain] for domain in near or domains]
    if name not in ("Fy", "Mx") or _has_activity_loads(domains):
        parts += [curve[name] for curve in space.curves.values()]
    everything = np.concatenate(parts)
    low, high = float(everything.min()), float(everything.max())
    margin = 0.06 * (high - low) or 1.0
    if near != list(domains) and near:
        top = float(values[space.domain == 6].max())
        return _AxisRange(low - margin, top, high + 0.2 * margin)
    room = _OUTLINE_ROOM * (high - low)
    for domain in set(domains) & set(space.outlines):
        outline = given_columns(space.outlines[domain].boxes)[name]
        if not np.isnan(outline).any():
            low = min(low, max(float(outline.min()), float(everything.min()) - room))
            high = max(high, min(float(outline.max()), float(everything.max()) + room))
    return _AxisRange(low - margin, high + margin)


def _has_activity_loads(domains: Sequence[int]) -> bool:
    return not set(domains) <= set(AT_THE_EDGE)


def _draw_histograms(
    axis: Axes, space: SampleSpace, name: str, domains: Sequence[int], limits: _AxisRange
) -> None:
    """Of all samples, each domain scaled to its own highest bin."""
    top = limits.high if limits.knee is None else limits.knee
    edges = np.linspace(limits.low, top, 41)
    for domain in domains:
        values = space.columns[name][space.domain == domain]
        beyond = limits.knee is not None and domain == 6
        edges_here = np.linspace(limits.knee or 0.0, limits.high, 9) if beyond else edges
        counts, _ = np.histogram(values, edges_here)
        if counts.max() > 0:
            height = counts / counts.max()
            colour = colour_of(domain)
            axis.stairs(height, edges_here, fill=True, color=colour, alpha=0.18)
            axis.stairs(height, edges_here, color=colour, lw=1.1)
    axis.set_ylim(0, 1.08)
    axis.set_yticks([])


def _draw_points(
    axis: Axes, space: SampleSpace, names: tuple[str, str], shown: dict[int, NDArray[np.int64]]
) -> None:
    for domain, rows in shown.items():
        x, y = (space.columns[name][rows] for name in names)
        axis.plot(
            x, y, ".", color=colour_of(domain), ms=2.8, mew=0, alpha=0.55, rasterized=True, zorder=2
        )


def _draw_curves(
    axis: Axes, space: SampleSpace, names: tuple[str, str], domains: Sequence[int]
) -> None:
    # The activities' loads are far off the axes of domains at the edge of contact.
    wanted = _has_activity_loads(domains) or not set(names) & {"Fy", "Mx"}
    for curve in space.curves.values() if wanted else ():
        x, y = (curve[name] for name in names)
        # A white edge keeps a curve readable over the points.
        axis.plot(x, y, "-", color="white", lw=2.4, zorder=3)
        axis.plot(x, y, "-", color="black", lw=1.1, zorder=4)


def _draw_outlines(
    axis: Axes,
    space: SampleSpace,
    names: tuple[str, str],
    domains: Sequence[int],
    ranges: dict[str, _AxisRange],
) -> None:
    for domain in domains:
        outline = space.outlines.get(domain)
        if outline is None:
            continue
        columns = given_columns(outline.boxes)
        x, y = (columns[name] for name in names)
        if np.isnan(x).any() or np.isnan(y).any():
            continue
        style = {"colors": [colour_of(domain)], "linewidths": 1.0, "zorder": 2.5}
        if len(outline.boxes) == 1:
            corners = convex_hull(np.column_stack([x.ravel(), y.ravel()]))
            closed = np.vstack([corners, corners[:1]])
            axis.plot(*closed.T, "-", color=colour_of(domain), lw=1.0, zorder=2.5)
        else:
            axis.contour(*_union(outline, x, y), levels=[0.5], **style)


def _union(
    outline: Outline, x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """A grid (x, y) and, on it, whether any of the upright boxes is there (1 or 0)."""
    grids, spans = [], []
    for values in (x, y):
        low, high = values.min(axis=1), values.max(axis=1)
        margin = 0.02 * float(high.max() - low.min())
        grid = np.linspace(low.min() - margin, high.max() + margin, _MASK_CELLS)
        grids.append(grid)
        spans.append((np.searchsorted(grid, low), np.searchsorted(grid, high)))
    mask = np.zeros((_MASK_CELLS, _MASK_CELLS))
    for box in range(len(outline.boxes)):
        (left, right), (bottom, top) = ((low[box], high[box]) for low, high in spans)
        mask[bottom:top, left:right] = 1.0
    return grids[0], grids[1], mask


def _label(axis: Axes, row: str, column: str, *, first: bool, last: bool) -> None:
    axis.tick_params(labelsize=7, labelbottom=last, labelleft=first and row != column)
    if last:
        axis.set_xlabel(VARIABLES[column].label)
    if first and row != column:
        axis.set_ylabel(VARIABLES[row].label)
    if row == column:
        axis.grid(visible=False, axis="y")
        axis.text(
            1.0, 1.02, VARIABLES[row].label, transform=axis.transAxes, ha="right", va="bottom",
            fontsize=9, fontweight="bold",
        )  # fmt: skip


def _handles(
    space: SampleSpace, domains: Sequence[int], shown: dict[int, NDArray[np.int64]]
) -> list[Line2D]:
    handles = []
    for domain in domains:
        total = int((space.domain == domain).sum())
        drawn = len(shown[domain])
        label = f"{name_of(domain)}: {total} samples"
        if drawn < total:
            label += f", {drawn} shown"
        handles.append(
            Line2D([], [], ls="", marker="o", ms=6, color=colour_of(domain), label=label)
        )
    if any(domain in space.outlines for domain in domains):
        handles.append(
            Line2D([], [], color="#888888", lw=1.2, label="outline of what was drawn from")
        )
    if space.curves:
        names = textwrap.fill("reference curves: " + ", ".join(space.curves), _LEGEND_WIDTH)
        handles.append(Line2D([], [], color="black", lw=1.2, label=names))
    if 6 in domains:
        handles.append(
            Line2D([], [], color="#444444", lw=0.8, ls=(0, (1, 2)), label="y is compressed beyond")
        )
    handles.append(
        Line2D([], [], ls="", label="diagonal: all samples, each domain to its own height")
    )
    return handles
