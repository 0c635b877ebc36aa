# SPDX-License-Identifier: Apache-2.0
"""Thickening of reference curves: what a curve does not vary is still to be known around it.

A curve of a well-aligned knee hardly moves in z, so a box drawn around it is a fraction of a
millimetre thin there; but a solver on its way to equilibrium, or the same knee under another load,
leaves it at once. So each time frame also counts with one variable at a time moved by ± its margin.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray


def thickened(
    values: NDArray[np.float64], columns: Sequence[str], margins: Mapping[str, float]
) -> NDArray[np.float64]:
    """Values (n, d), and below them their copies moved by ± the margin of each named column.

    Args:
        values: (n, d) in the variables' units.
        columns: The d variables' names.
        margins: Variable to margin, in its unit; those not named, or with 0, are not moved.
    """
    copies = [values]
    for column, name in enumerate(columns):
        margin = margins.get(name, 0.0)
        if margin > 0.0:
            step = np.zeros(values.shape[1])
            step[column] = margin
            copies += [values - step, values + step]
    return np.concatenate(copies)
