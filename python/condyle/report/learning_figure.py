# SPDX-License-Identifier: Apache-2.0
"""Learning curves as a figure: held-out RMSE against the number of samples, and against training time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.report.learning_curves import SHOWN, errors_over_all
from condyle.report.style import COLOURS


def learning_figure(table: Mapping[str, Any]) -> Figure:
    """RMSE of Fy and Mx, both sides; logarithmic axes.

    Args:
        table: as for :func:`condyle.report.learning_curves.render_learning_curves`.
    """
    points = table["points"]
    curves = [("training samples", [p["samples"] for p in points], [p["errors"] for p in points])]
    if timed := points[-1]["over_time"]:
        minutes = [row["seconds"] / 60 for row in timed]
        curves.append(("training time [min]", minutes, [row["errors"] for row in timed]))
    figure = Figure(figsize=(9, 3.2 * len(curves)), layout="constrained")
    axes = figure.subplots(len(curves), len(SHOWN), squeeze=False)
    for row, (label, along, errors) in zip(axes, curves, strict=True):
        for axis, load in zip(row, SHOWN, strict=True):
            for side in SIDES:
                values = [errors_over_all(rows)[side, load]["rmse"] for rows in errors]
                axis.plot(along, values, "o-", color=COLOURS[side], markersize=3, label=side)
            axis.set_xscale("log")
            axis.set_yscale("log")
            for scale in (axis.xaxis, axis.yaxis):
                # Plain numbers: a curve often spans less than a decade.
                scale.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
                scale.set_major_formatter("{x:g}")
                scale.set_minor_formatter(NullFormatter())
            axis.set_xlabel(label)
            axis.set_ylabel(f"RMSE {load} [{LOAD_UNITS[LOAD_COLUMNS.index(load)]}]")
            axis.grid(visible=True, which="both")
    axes[0][0].legend()
    figure.suptitle(f"Held-out errors, {table['architecture']}")
    return figure
