# SPDX-License-Identifier: Apache-2.0
"""Knee kinematics over flexion or over an activity's percent, several curves, such as beside fluoroscopy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.evaluation.simulation_errors import KINEMATICS
from condyle.report.style import MEASURED_COLOUR

Array = NDArray[np.float64]
#: What a knee does besides flexing.
SECONDARY: Final = tuple(name for name, _, _ in KINEMATICS if name != "flexion")
#: Of computed curves, told apart by dashes as well as by colour.
_LOOKS: Final[tuple[dict[str, Any], ...]] = (
    {"color": "#0072B2", "linestyle": "-"},
    {"color": "#D55E00", "linestyle": "--"},
    {"color": "#009E73", "linestyle": "-."},
    {"color": "#CC79A7", "linestyle": (0, (1, 1))},
    {"color": "#E69F00", "linestyle": (0, (5, 1, 1, 1, 1, 1))},
    {"color": "#56B4E9", "linestyle": (0, (8, 2))},
)
_COLUMNS: Final = 3


@dataclass(frozen=True)
class KinematicsCurve:
    """Clinical kinematics along something.

    Attributes:
        label: what the legend says.
        along: (n,) flexion [deg] or percent, as the figure's axis says.
        kinematics: (n, 6) [rad, m] in the order of KINEMATICS; not a number leaves a gap.
        band: (low, high), each (n, 6) [rad, m], a shade behind the curve; then ``along`` increases.
        measured: drawn in black with a grey band, behind those computed.
    """

    label: str
    along: Array
    kinematics: Array
    band: tuple[Array, Array] | None = None
    measured: bool = False

    def __post_init__(self) -> None:
        """A row a point; a band over a loop would be a tangle."""
        needed = (len(self.along), len(KINEMATICS))
        for name, values in [
            ("kinematics", self.kinematics),
            *(("band", edge) for edge in self.band or ()),
        ]:
            if values.shape != needed:
                raise InputDataError(
                    f"curve '{self.label}': {name} has shape {values.shape}; {needed} is needed"
                )
        if self.band is not None and not np.all(np.diff(self.along) > 0.0):
            raise InputDataError(f"curve '{self.label}': with a band, along must increase")


def comparison_figure(
    title: str,
    curves: Sequence[KinematicsCurve],
    *,
    along: str = "flexion [deg]",
    quantities: Sequence[str] = SECONDARY,
) -> Figure:
    """A panel for every quantity, all curves in each.

    Args:
        title: above all.
        curves: the measured ones are drawn first, behind the others.
        along: the label of the horizontal axis.
        quantities: names of KINEMATICS to show; all but flexion by default.

    Raises:
        InputDataError: nothing to show, an unknown quantity, or more computed curves than can be told apart.
    """
    names = [name for name, _, _ in KINEMATICS]
    unknown = [quantity for quantity in quantities if quantity not in names]
    if unknown:
        raise InputDataError(f"quantity '{unknown[0]}': must be one of {', '.join(names)}")
    computed = sum(not curve.measured for curve in curves)
    if not curves or not quantities or computed > len(_LOOKS):
        raise InputDataError(
            f"{len(curves)} curves ({computed} of them computed) of {len(quantities)} quantities: at least 1 of both "
            f"and at most {len(_LOOKS)} computed ones are shown"
        )
    columns = min(_COLUMNS, len(quantities))
    rows = -(-len(quantities) // columns)
    figure = Figure(figsize=(0.6 + 3.2 * columns, 1.1 + 2.4 * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    for axis, quantity in zip(axes.flat, quantities, strict=False):
        column = names.index(quantity)
        name, unit, factor = KINEMATICS[column]
        for curve, look in _looks(curves):
            if curve.band is not None:
                low, high = (factor * edge[:, column] for edge in curve.band)
                shade = MEASURED_COLOUR if curve.measured else look["color"]
                alpha = 0.6 if curve.measured else 0.2
                axis.fill_between(curve.along, low, high, color=shade, alpha=alpha, linewidth=0)
            values = factor * curve.kinematics[:, column]
            axis.plot(curve.along, values, linewidth=1.8, label=curve.label, **look)
        axis.set_title(f"{name.replace('_', ' ')} [{unit}]")
        axis.set_xlabel(along)
        axis.margins(x=0.02)
        axis.ticklabel_format(axis="y", useOffset=False)
    for axis in axes.flat[len(quantities) :]:
        axis.remove()
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(4, len(curves)))
    figure.suptitle(title)
    return figure


def _looks(curves: Sequence[KinematicsCurve]) -> list[tuple[KinematicsCurve, dict[str, Any]]]:
    """The curves in the order of drawing, measured ones first, each with its look."""
    measured = [(curve, {"color": "black", "linestyle": "-"}) for curve in curves if curve.measured]
    computed = [curve for curve in curves if not curve.measured]
    return [*measured, *zip(computed, _LOOKS, strict=False)]
