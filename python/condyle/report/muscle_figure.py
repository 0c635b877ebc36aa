# SPDX-License-Identifier: Apache-2.0
"""The largest muscle forces of an activity over time, reference and surrogate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.report.activity_figures import DOTTED, SOLID
from condyle.report.style import COLOURS

_COLUMNS = 4


@dataclass(frozen=True)
class MuscleForces:
    """Forces of m muscles over n time frames.

    Attributes:
        label: what the legend says.
        time: (n,) [s].
        names: (m,) of the muscles.
        forces: (n, m) [N]; not a number leaves a gap.
    """

    label: str
    time: NDArray[np.float64]
    names: Sequence[str]
    forces: NDArray[np.float64]

    def __post_init__(self) -> None:
        """A column a muscle, a row a time frame."""
        needed = (len(self.time), len(self.names))
        if self.forces.shape != needed:
            raise InputDataError(
                f"muscle forces '{self.label}': forces have shape {self.forces.shape}; {needed} is needed"
            )


def muscle_forces_figure(
    activity: str,
    surrogate: MuscleForces,
    reference: MuscleForces | None = None,
    *,
    count: int = 12,
) -> Figure:
    """The muscles with the highest peaks, a panel each, the strongest first; panels of a row have one scale.

    Args:
        activity: its name.
        surrogate: solid; its peaks choose the muscles.
        reference: dotted over it.
        count: at most so many muscles.

    Raises:
        InputDataError: no muscles, no count, or a reference without one of the muscles shown.
    """
    if len(surrogate.names) == 0 or count < 1:
        raise InputDataError(
            f"muscle forces of '{activity}': {len(surrogate.names)} muscles, {count} asked for: at least 1 is needed"
        )
    # A muscle without a single number has no peak.
    peaks = np.nan_to_num(surrogate.forces, nan=-np.inf).max(axis=0, initial=-np.inf)
    shown = np.argsort(-peaks, kind="stable")[:count]
    rows = -(-len(shown) // _COLUMNS)
    figure = Figure(figsize=(10, 0.9 + 1.75 * rows), layout="constrained")
    axes = figure.subplots(rows, _COLUMNS, sharex=True, sharey="row", squeeze=False)
    for panel, muscle in enumerate(shown):
        axis, name = axes.flat[panel], surrogate.names[muscle]
        colour = COLOURS["lateral"]
        axis.plot(
            surrogate.time,
            surrogate.forces[:, muscle],
            label=surrogate.label,
            color=colour,
            **SOLID,
        )
        if reference is not None:
            column = _column(reference, name)
            axis.plot(reference.time, reference.forces[:, column], label=reference.label, **DOTTED)
        axis.set_title(name)
        axis.margins(x=0.02)
        axis.locator_params(axis="x", nbins=4)
        # The panels below may be missing in the last row.
        if panel + _COLUMNS >= len(shown):
            axis.set_xlabel("time [s]")
            axis.tick_params(labelbottom=True)
    for axis in axes[:, 0]:
        axis.set_ylabel("force [N]")
        axis.set_ylim(bottom=0.0)
    figure.align_ylabels(axes[:, 0])
    for axis in axes.flat[len(shown) :]:
        axis.remove()
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    some = len(shown) < len(surrogate.names)
    of = f", the {len(shown)} largest of {len(surrogate.names)}" if some else ""
    figure.suptitle(f"{activity}: muscle forces{of}")
    return figure


def _column(forces: MuscleForces, name: str) -> int:
    names = list(forces.names)
    if name not in names:
        raise InputDataError(f"muscle forces '{forces.label}' have no muscle '{name}'")
    return names.index(name)
