# SPDX-License-Identifier: Apache-2.0
"""The sampled domains, and how well a surrogate reproduces held-out samples."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.report.style import COLOURS, DOMAIN_COLOURS

#: The sampled variables: (label, column of a combined pose + total wrench array, factor to the unit shown).
_VARIABLES = (
    ("x [mm]", 0, 1e3),
    ("y [mm]", 1, 1e3),
    ("z [mm]", 2, 1e3),
    ("θx [deg]", 3, 180 / np.pi),
    ("θy [deg]", 4, 180 / np.pi),
    ("θz [deg]", 5, 180 / np.pi),
    ("Fy [N]", 7, 1.0),
    ("Mx [Nm]", 9, 1.0),
)


def _points(poses: NDArray[np.float64], wrenches: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.hstack([poses, wrenches.sum(axis=1)])


def domain_figure(
    poses: NDArray[np.float64],
    wrenches: NDArray[np.float64],
    domains: NDArray[np.int64],
    curves: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]],
    most_points: int = 1500,
) -> Figure:
    """Pair plots of load and pose: samples in their domain's colour, reference curves (poses, wrenches) in black."""
    count = len(_VARIABLES)
    figure = Figure(figsize=(12, 12), layout="constrained")
    axes = figure.subplots(count, count)
    points = _points(poses, wrenches)
    # Every k-th row: a figure needs no random draw, and rows are in candidate order, which is already well spread.
    step = max(1, len(points) // most_points)
    shown, shown_domains = points[::step], domains[::step]
    curve_points = {name: _points(*curve) for name, curve in curves.items()}
    for row, (row_label, r, r_factor) in enumerate(_VARIABLES):
        for column, (column_label, c, c_factor) in enumerate(_VARIABLES):
            axis = axes[row, column]
            axis.tick_params(labelsize=6)
            if column > row:
                axis.set_visible(False)
                continue
            for domain in sorted(set(domains.tolist())):
                colour = DOMAIN_COLOURS.get(domain, "#000000")
                chosen = shown[shown_domains == domain]
                if row == column:
                    axis.hist(c_factor * chosen[:, c], bins=30, color=colour, alpha=0.6)
                else:
                    axis.plot(
                        c_factor * chosen[:, c], r_factor * chosen[:, r], ".", color=colour, ms=1.5,
                        alpha=0.6, rasterized=True,
                    )  # fmt: skip
            if row != column:
                for curve in curve_points.values():
                    axis.plot(c_factor * curve[:, c], r_factor * curve[:, r], "k-", lw=0.9)
            if row == count - 1:
                axis.set_xlabel(column_label)
            if column == 0:
                axis.set_ylabel(row_label)
    handles = [
        figure.axes[0].plot(
            [], [], "o", color=DOMAIN_COLOURS.get(d, "#000000"), label=f"domain {d}"
        )[0]
        for d in sorted(set(domains.tolist()))
    ]
    handles += figure.axes[0].plot([], [], "k-", label="reference curves: " + ", ".join(curves))
    figure.legend(handles=handles, loc="upper right", bbox_to_anchor=(0.98, 0.9), fontsize=11)
    shown_text = f"{len(points)} samples" + ("" if step == 1 else f", one in {step} shown")
    figure.suptitle(f"Sampled domains: pose and total load ({shown_text})", x=0.02, ha="left")
    return figure


def parity_figure(
    reference: NDArray[np.float64],
    surrogate: NDArray[np.float64],
    statistics: list[dict[str, object]],
) -> Figure:
    """Surrogate against reference for every load of both sides over held-out samples.

    Args:
        reference: wrenches (n, 2, 6) [N, Nm].
        surrogate: wrenches at the same poses.
        statistics: rows of the sample error table; those of domain ``all`` label the panels.
    """
    labels = {(r["side"], r["load"]): r for r in statistics if r["domain"] == "all"}
    figure = Figure(figsize=(12, 4.8), layout="constrained")
    axes = figure.subplots(2, 6)
    for s, side in enumerate(SIDES):
        for i, load in enumerate(LOAD_COLUMNS):
            axis = axes[s, i]
            x, y = reference[:, s, i], surrogate[:, s, i]
            low, high = float(min(x.min(), y.min())), float(max(x.max(), y.max()))
            axis.plot([low, high], [low, high], color="#888888", lw=0.8)
            axis.plot(x, y, ".", ms=2, color=COLOURS[side], alpha=0.5, rasterized=True)
            row = labels.get((side, load))
            if row is not None:
                r2 = row["loaded_r2"]
                shown = f"R² {r2:.5f}\n" if isinstance(r2, float) else ""
                text = f"{shown}RMSE {row['rmse']:.3g} {LOAD_UNITS[i]}"
                axis.text(0.04, 0.96, text, transform=axis.transAxes, va="top", fontsize=7)
            axis.set_title(f"{side} {load} [{LOAD_UNITS[i]}]", fontsize=8)
            axis.tick_params(labelsize=6)
    figure.supxlabel("reference")
    figure.supylabel("surrogate")
    figure.suptitle(f"Held-out samples ({len(reference)}): surrogate against reference")
    return figure
