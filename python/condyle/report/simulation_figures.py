# SPDX-License-Identifier: Apache-2.0
"""Simulated activities: kinematics and loads over time, reference against surrogate."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.evaluation.simulation_errors import KINEMATICS
from condyle.report.style import COLOURS


@dataclass(frozen=True)
class Trace:
    """One simulation for plotting: time (n,) [s], wrenches (n, 2, 6) [N, Nm], clinical kinematics (n, 6) [rad, m]."""

    label: str
    time: NDArray[np.float64]
    wrenches: NDArray[np.float64]
    kinematics: NDArray[np.float64]


_LINES = ("-", "--")


def loads_figure(activity: str, traces: list[Trace]) -> Figure:
    """Medial and lateral loads over time, six panels; the first trace solid, the second dashed."""
    figure = Figure(figsize=(10, 5.6), layout="constrained")
    axes = figure.subplots(2, 3, sharex=True)
    for i, axis in enumerate(axes.flat):
        for trace, line in zip(traces, _LINES, strict=False):
            for s, side in enumerate(SIDES):
                axis.plot(
                    trace.time,
                    trace.wrenches[:, s, i],
                    line,
                    color=COLOURS[side] if line == "-" else "black",
                    linewidth=2.2 if line == "-" else 1.0,
                    # All dashed lines are black: one entry says what they are.
                    label=f"{side}, {trace.label}"
                    if line == "-"
                    else trace.label
                    if s == 0
                    else None,
                )
        axis.set_title(f"{LOAD_COLUMNS[i]} [{LOAD_UNITS[i]}]")
        if i >= 3:
            axis.set_xlabel("time [s]")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    figure.suptitle(f"{activity}: contact loads on the femoral component, in the tibial frame")
    return figure


def kinematics_figure(activity: str, traces: list[Trace]) -> Figure:
    """Clinical kinematics over time, six panels."""
    figure = Figure(figsize=(10, 5.6), layout="constrained")
    axes = figure.subplots(2, 3, sharex=True)
    for i, axis in enumerate(axes.flat):
        name, unit, factor = KINEMATICS[i]
        for trace, line in zip(traces, _LINES, strict=False):
            axis.plot(
                trace.time,
                factor * trace.kinematics[:, i],
                line,
                color=COLOURS["medial"] if line == "-" else "black",
                linewidth=2.2 if line == "-" else 1.0,
                label=trace.label,
            )
        axis.set_title(f"{name.replace('_', ' ')} [{unit}]")
        if i >= 3:
            axis.set_xlabel("time [s]")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    figure.suptitle(f"{activity}: knee kinematics (Grood and Suntay)")
    return figure
