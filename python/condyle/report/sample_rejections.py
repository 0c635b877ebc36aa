# SPDX-License-Identifier: Apache-2.0
"""Where candidates are rejected, and why: a map of each domain in three planes."""

from __future__ import annotations

from collections import Counter
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from condyle.report.sample_space import (
    VARIABLES,
    Columns,
    SampleSpace,
    candidate_columns,
    name_of,
    spread,
)
from condyle.report.style import OUTCOME_COLOURS
from condyle.sampling import Candidates

ACCEPTED: Final = "accepted"
#: Planes (horizontal, vertical) that a domain is shown in, those it prescribes: the first of
#: _FIRST that it does, then the others.
_FIRST: Final = (("Fy", "Mx"), ("Fy", "theta_x"), ("theta_x", "y"))
_OTHERS: Final = (("theta_z", "x"), ("z", "theta_y"))
#: A reason with fewer candidates than this is drawn in full, and larger.
_RARE: Final = 60


def rejection_figure(space: SampleSpace, most_points: int = 4000) -> Figure | None:
    """A column of panels for every domain with a rejection; None if there is none.

    Candidates are shown in proportion to their outcomes, in an order that hides none behind
    another; but every one of a rare reason is.

    Args:
        space: the dataset.
        most_points: shown in a panel, in all.
    """
    domains = [
        number
        for number, candidates in sorted(space.candidates.items())
        if (candidates.status != ACCEPTED).any()
    ]
    if not domains:
        return None
    rows = 1 + len(_OTHERS)
    figure = Figure(figsize=(0.4 + 3.0 * len(domains), 0.5 + 2.7 * rows), layout="constrained")
    axes = figure.subplots(rows, len(domains), squeeze=False)
    seen: set[str] = set()
    for c, domain in enumerate(domains):
        candidates = space.candidates[domain]
        columns = candidate_columns(candidates)
        counts = Counter(candidates.status.tolist())
        seen |= set(counts)
        shown = spread(candidates.candidate, most_points)
        rare = np.isin(candidates.status, [s for s, count in counts.items() if count < _RARE])
        first = next(p for p in _FIRST if not any(np.isnan(columns[name]).any() for name in p))
        for r, plane in enumerate((first, *_OTHERS)):
            _draw_plane(axes[r, c], columns, plane, candidates, shown, np.flatnonzero(rare))
        axes[0, c].set_title(_title(domain, counts), loc="left", fontsize=8.5, fontweight="normal")
    handles = [
        Line2D([], [], ls="", marker="o", ms=6, color=colour, label=status.replace("_", " "))
        for status, colour in OUTCOME_COLOURS.items()
        if status in seen
    ]
    handles.append(Line2D([], [], ls="", label="large: all of a rare reason"))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=max(2, 3 * len(domains) // 2),
        columnspacing=1.2,
        fontsize=9,
    )
    return figure


def _draw_plane(
    axis: Axes,
    columns: Columns,
    plane: tuple[str, str],
    candidates: Candidates,
    shown: NDArray[np.int64],
    rare: NDArray[np.int64],
) -> None:
    for rows, size, alpha in ((shown, 3.0, 0.75), (rare, 14.0, 1.0)):
        colours = [OUTCOME_COLOURS[str(status)] for status in candidates.status[rows]]
        axis.scatter(
            columns[plane[0]][rows], columns[plane[1]][rows], s=size, c=colours, alpha=alpha,
            linewidths=0, rasterized=True,
        )  # fmt: skip
    axis.set_xlabel(VARIABLES[plane[0]].label, labelpad=1)
    axis.set_ylabel(VARIABLES[plane[1]].label, labelpad=1)
    axis.tick_params(labelsize=7)
    axis.xaxis.set_major_locator(MaxNLocator(5))


def _title(domain: int, counts: Counter[str]) -> str:
    total = counts.total()
    accepted = counts[ACCEPTED]
    lines = [f"{name_of(domain)}: {total} candidates", f"{100 * accepted / total:.1f} % accepted"]
    reasons = [item for item in counts.most_common() if item[0] != ACCEPTED]
    lines += [f"{count} {reason.replace('_', ' ')}" for reason, count in reasons]
    return "\n".join(lines)
