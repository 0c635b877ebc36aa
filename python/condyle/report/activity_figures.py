# SPDX-License-Identifier: Apache-2.0
"""Activities side by side, one column each: compressive forces and kinematics, as the paper's Figures 3 and 4.

In both, the reference is dotted over the surrogate's solid line (the paper's Figure 4 has them the other way round). A
time frame that is not a number leaves a gap.

Source: Marra et al. (2017), J. Biomech. Eng. 139(8), doi:10.1115/1.4036605.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.errors import InputDataError
from condyle.evaluation.paper_activities import PAPER_KINEMATICS_COLUMNS
from condyle.evaluation.simulation_errors import KINEMATICS
from condyle.report.simulation_figures import Trace
from condyle.report.style import COLOURS, MEASURED_COLOUR

Array = NDArray[np.float64]
#: Of a computed line, and of the reference over it.
SOLID: Final[dict[str, Any]] = {"linestyle": "-", "linewidth": 2.4}
DOTTED: Final[dict[str, Any]] = {"linestyle": ":", "linewidth": 1.5, "color": "black"}
#: Room of a column [in], and beside all of them for labels.
_COLUMN_WIDTH: Final = 2.7
_SIDE_WIDTH: Final = 1.2
#: Longest line of a column's title.
_TITLE_WIDTH: Final = 22


@dataclass(frozen=True)
class MeasuredForces:
    """Compressive forces measured inside the knee.

    Attributes:
        time: (n,) [s], of the same clock as the traces.
        compression: (n, 2) [N], medial, lateral.
        label: what the legend says.
    """

    time: Array
    compression: Array
    label: str = "measured"

    def __post_init__(self) -> None:
        """One row a time."""
        if self.compression.shape != (len(self.time), 2):
            raise InputDataError(
                f"measured forces: compression has shape {self.compression.shape}; ({len(self.time)}, 2) is needed"
            )


@dataclass(frozen=True)
class ActivityTraces:
    """A column of the figures.

    Attributes:
        name: of the activity.
        surrogate: solid.
        reference: dotted; None: not shown.
        measured: shaded; None: not shown.
    """

    name: str
    surrogate: Trace
    reference: Trace | None = None
    measured: MeasuredForces | None = None


def compressive_forces_figure(
    activities: Sequence[ActivityTraces], *, body_weight: float | None = None
) -> Figure:
    """Medial (top) and lateral (bottom) compressive force over time, all panels to one scale.

    Args:
        activities: one column each.
        body_weight: [N]; given, a second axis on the right shows multiples of it.

    Raises:
        InputDataError: no activity, or a body weight that is not positive.
    """
    if body_weight is not None and not body_weight > 0.0:
        raise InputDataError(f"body_weight is {body_weight:g} N: must be positive")
    figure, axes = _columns(activities, rows=2, row_height=2.3, sharey="all")
    for j, activity in enumerate(activities):
        for s, side in enumerate(SIDES):
            axis = axes[s, j]
            if activity.measured is not None:
                measured = activity.measured
                axis.fill_between(
                    measured.time,
                    measured.compression[:, s],
                    color=MEASURED_COLOUR,
                    linewidth=0,
                    label=measured.label,
                )
            _draw_compression(axis, activity.surrogate, s, SOLID | {"color": COLOURS[side]})
            if activity.reference is not None:
                _draw_compression(axis, activity.reference, s, DOTTED)
    for s, side in enumerate(SIDES):
        axes[s, 0].set_ylabel(f"{side} [N]")
        if body_weight is not None:
            in_weights = axes[s, -1].secondary_yaxis(
                "right", functions=(lambda n: n / body_weight, lambda w: w * body_weight)
            )
            in_weights.set_ylabel("[BW]")
    _legend(figure, axes)
    figure.suptitle("Compressive contact forces")
    return figure


def knee_kinematics_figure(activities: Sequence[ActivityTraces]) -> Figure:
    """Clinical kinematics (Grood and Suntay) over time: a row each, to one scale a row.

    Args:
        activities: one column each.

    Raises:
        InputDataError: no activity.
    """
    figure, axes = _columns(activities, rows=6, row_height=1.45, sharey="row")
    names = [name for name, _, _ in KINEMATICS]
    for i, quantity in enumerate(PAPER_KINEMATICS_COLUMNS):
        column = names.index(quantity)
        _, unit, factor = KINEMATICS[column]
        for j, activity in enumerate(activities):
            lines = [(activity.surrogate, SOLID | {"color": COLOURS["medial"]})]
            if activity.reference is not None:
                lines.append((activity.reference, DOTTED))
            for trace, look in lines:
                values = factor * trace.kinematics[:, column]
                axes[i, j].plot(trace.time, values, label=trace.label, **look)
        axes[i, 0].set_ylabel(_wrapped(f"{quantity.replace('_', ' ')} [{unit}]", 18))
    figure.align_ylabels(axes[:, 0])
    _legend(figure, axes)
    figure.suptitle("Knee kinematics (Grood and Suntay)")
    return figure


def _columns(
    activities: Sequence[ActivityTraces],
    rows: int,
    row_height: float,
    sharey: Literal["all", "row"],
) -> tuple[Figure, NDArray[Any]]:
    """A figure of rows × activities, with titles above and time below."""
    if not activities:
        raise InputDataError("a figure of activities needs at least one")
    count = len(activities)
    size = (_SIDE_WIDTH + _COLUMN_WIDTH * max(count, 1.5), 1.2 + row_height * rows)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, count, sharex="col", sharey=sharey, squeeze=False)
    for j, activity in enumerate(activities):
        axes[0, j].set_title(_wrapped(activity.name, _TITLE_WIDTH))
        axes[-1, j].set_xlabel("time [s]")
    for axis in axes.flat:
        axis.margins(x=0.02)
        axis.locator_params(axis="x", nbins=5)
        # A translation near 42 mm reads 42.1, not 0.1 with an offset somewhere else.
        axis.ticklabel_format(axis="y", useOffset=False)
    return figure, axes


def _draw_compression(axis: Axes, trace: Trace, side: int, look: dict[str, Any]) -> None:
    dotted = look["linestyle"] == ":"
    # The solid lines have a colour a side, the dotted ones are alike.
    label = trace.label if dotted else f"{trace.label}, {SIDES[side]}"
    axis.plot(trace.time, trace.wrenches[:, side, LOAD_COLUMNS.index("Fy")], label=label, **look)


def _legend(figure: Figure, axes: NDArray[Any]) -> None:
    """Below all panels, each label once: shades, solid lines, dotted lines."""
    known: dict[str, Any] = {}
    for axis in axes.flat:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            known.setdefault(label, handle)
    entries = sorted(known.items(), key=lambda entry: _order(entry[1]))
    # A single column of panels has no room for four entries side by side.
    figure.legend(
        [handle for _, handle in entries],
        [label for label, _ in entries],
        loc="outside lower center",
        ncols=4 if axes.shape[1] > 1 else 2,
    )


def _order(handle: Any) -> int:
    if not isinstance(handle, Line2D):
        return 0
    return 2 if handle.get_linestyle() == ":" else 1


def _wrapped(text: str, width: int) -> str:
    """Lines of at most ``width``; a name with underscores breaks after one."""
    lines = textwrap.wrap(text.replace("_", "_ "), width)
    return "\n".join(line.replace("_ ", "_") for line in lines)
