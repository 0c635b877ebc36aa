# SPDX-License-Identifier: Apache-2.0
"""Contact force in body weights over the cycles of a gait, beside what instrumented knees measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from condyle.conventions import SIDES
from condyle.errors import InputDataError
from condyle.report.gait_cycles import POINTS
from condyle.report.style import COLOURS, MEASURED_COLOUR

Array = NDArray[np.float64]
#: Of the lines of single cycles, behind their mean.
_SINGLE: Final[dict[str, Any]] = {"linewidth": 0.8, "alpha": 0.45}
#: A single published value is drawn this thick [BW].
_THIN: Final = 0.015


@dataclass(frozen=True)
class PublishedPeak:
    """A peak force that was measured inside knees.

    Attributes:
        label: whose, and where it was published.
        low: lower end [body weights].
        high: upper end; the same where one value was published.
    """

    label: str
    low: float
    high: float


def cycle_force_figure(
    title: str,
    compression: Array,
    body_weight: float,
    *,
    toe_off: float | None = None,
    published: Sequence[PublishedPeak] = (),
) -> Figure:
    """Total, medial and lateral compression over percent of the gait cycle: every cycle thin, their mean thick.

    Args:
        title: above all.
        compression: (cycles, 101, 2) medial and lateral [N].
        body_weight: [N].
        toe_off: where swing begins [percent]; None: not shown.
        published: peaks of the total, as shades.

    Raises:
        InputDataError: no cycle, another shape, or a body weight that is not positive.
    """
    if not len(compression) or compression.shape[1:] != (POINTS, 2):
        raise InputDataError(
            f"compression has shape {compression.shape}: must be (cycles, {POINTS}, 2)"
        )
    if not body_weight > 0.0:
        raise InputDataError(f"body_weight is {body_weight:g} N: must be positive")
    weights = compression / body_weight
    curves = {"total": weights.sum(axis=2)} | {
        side: weights[:, :, s] for s, side in enumerate(SIDES)
    }
    percent = np.arange(POINTS)
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    axis = figure.subplots()
    for peak in published:
        middle, half = 0.5 * (peak.low + peak.high), max(0.5 * (peak.high - peak.low), _THIN)
        axis.axhspan(middle - half, middle + half, color=MEASURED_COLOUR, alpha=0.6, linewidth=0)
        axis.annotate(
            peak.label,
            (1.0, middle),
            xycoords=("axes fraction", "data"),
            xytext=(4, 0),
            textcoords="offset points",
            verticalalignment="center",
        )
    for name, lines in curves.items():
        axis.plot(percent, lines.T, color=COLOURS[name], **_SINGLE)
        axis.plot(percent, lines.mean(axis=0), color=COLOURS[name], linewidth=2.2, label=name)
    if toe_off is not None:
        axis.axvline(toe_off, color="black", linewidth=0.8, linestyle=":")
        axis.annotate(
            "toe off", (toe_off, 1.0), xycoords=("data", "axes fraction"), xytext=(4, -10),
            textcoords="offset points",
        )  # fmt: skip
    axis.set_xlim(0, 100)
    axis.set_ylim(bottom=0.0)
    axis.set_xlabel("gait cycle [%], from heel strike")
    axis.set_ylabel("compression [BW]")
    figure.legend(loc="outside lower center", ncols=len(curves))
    figure.suptitle(title)
    return figure
