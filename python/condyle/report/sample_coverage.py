# SPDX-License-Identifier: Apache-2.0
"""What of each domain the samples reach: every variable's distribution against what was drawn."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from condyle.report.sample_space import (
    VARIABLES,
    SampleSpace,
    candidate_columns,
    colour_of,
    name_of,
)
from condyle.sampling.equilibrium_protocol import GIVEN_COLUMNS

#: Bins of each variable, between the extremes of what was drawn.
BINS: Final = 24


def coverage_table(space: SampleSpace) -> list[dict[str, Any]]:
    """One row for every domain and prescribed variable.

    Returns:
        Rows with domain, variable, unit, low, high (of the samples, in the unit), drawn_low,
        drawn_high (of the candidates) and reached: the share of BINS equal bins of what was drawn
        that hold a sample; None where nothing was drawn (samples from elsewhere, or solved for).
    """
    rows = []
    for domain in space.domains:
        drawn = _drawn(space, domain)
        chosen = space.domain == domain
        for name, variable in VARIABLES.items():
            values = space.columns[name][chosen]
            row: dict[str, Any] = {
                "domain": domain,
                "variable": name,
                "unit": variable.label.split("[")[1].rstrip("]"),
                "low": float(values.min()),
                "high": float(values.max()),
                "drawn_low": None,
                "drawn_high": None,
                "reached": None,
            }
            if name in drawn:
                row["drawn_low"], row["drawn_high"] = map(float, _ends(drawn[name]))
                row["reached"] = _reached(values, drawn[name])
            rows.append(row)
    return rows


def coverage_figure(space: SampleSpace) -> Figure:
    """A row of panels a domain, a column a variable: samples filled, what was drawn as a line.

    Both are densities of all rows. The line is missing where a variable was solved for, and the
    number is the share of the bins drawn in that hold a sample.
    """
    domains, names = space.domains, list(VARIABLES)
    figure = Figure(figsize=(1.75 * len(names), 0.7 + 1.4 * len(domains)))
    figure.set_layout_engine(ConstrainedLayoutEngine(hspace=0.12))
    axes = figure.subplots(len(domains), len(names), squeeze=False)
    for r, domain in enumerate(domains):
        drawn = _drawn(space, domain)
        chosen = space.domain == domain
        for c, name in enumerate(names):
            axis = axes[r, c]
            _draw_panel(axis, space.columns[name][chosen], drawn.get(name), colour_of(domain))
            axis.tick_params(labelsize=7)
            if r == len(domains) - 1:
                axis.set_xlabel(VARIABLES[name].label)
        title = f"{name_of(domain)}: {int(chosen.sum())} samples"
        if drawn:
            title += f" of {len(space.candidates[domain].candidate)} candidates"
        axes[r, 0].set_title(" ")  # its room; the text itself must not widen the column
        axes[r, 0].text(
            0.0, 1.07, title, transform=axes[r, 0].transAxes, fontsize=9, fontweight="bold"
        ).set_in_layout(False)
    handles: list[Any] = [Patch(facecolor="#888888", alpha=0.4, label="samples")]
    if space.candidates:
        handles.append(Line2D([], [], color="#222222", lw=1.0, label="candidates drawn"))
        handles.append(Line2D([], [], ls="", label="%: bins drawn in that hold a sample"))
    figure.legend(handles=handles, loc="outside upper right", ncols=3, fontsize=9)
    return figure


def _drawn(space: SampleSpace, domain: int) -> dict[str, NDArray[np.float64]]:
    """What the domain's candidates prescribe, by variable."""
    if domain not in space.candidates:
        return {}
    columns = candidate_columns(space.candidates[domain])
    return {name: columns[name] for name in GIVEN_COLUMNS if not np.isnan(columns[name]).all()}


def _ends(values: NDArray[np.float64]) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > low else (low - 1.0, high + 1.0)


def _edges(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.linspace(*_ends(values), BINS + 1)


def _reached(values: NDArray[np.float64], drawn: NDArray[np.float64]) -> float:
    """Share of the bins with a candidate that hold a sample.

    A sample stands where its candidate was prescribed, up to what the solver tolerates; the outermost
    bins take what falls beside them for that reason.
    """
    edges = _edges(drawn)
    wanted = np.histogram(drawn, edges)[0] > 0
    held = np.histogram(np.clip(values, edges[0], edges[-1]), edges)[0] > 0
    return float((held & wanted).sum() / wanted.sum())


def _draw_panel(
    axis: Axes, values: NDArray[np.float64], drawn: NDArray[np.float64] | None, colour: str
) -> None:
    axis.set_yticks([])
    axis.spines["left"].set_visible(False)
    if np.ptp(values) == 0.0 and drawn is None:
        shown = f"{values[0]:.3g} in all samples"
        axis.set_xticks([])
        axis.text(0.5, 0.5, shown, transform=axis.transAxes, ha="center", fontsize=8)
        return
    edges = _edges(values if drawn is None else drawn)
    density = np.histogram(values, edges)[0] / len(values)
    axis.stairs(density, edges, fill=True, color=colour, alpha=0.4)
    axis.stairs(density, edges, color=colour, lw=0.9)
    if drawn is not None:
        axis.stairs(np.histogram(drawn, edges)[0] / len(drawn), edges, color="#222222", lw=1.0)
        share = f"{100 * _reached(values, drawn):.0f} %"
        axis.text(1.0, 0.99, share, transform=axis.transAxes, ha="right", va="top", fontsize=8)
    axis.set_ylim(0, 1.25 * axis.dataLim.ymax)
