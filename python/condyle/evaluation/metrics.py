# SPDX-License-Identifier: Apache-2.0
"""Error measures, as Marra et al. 2017 report them: RMSE, maximum error, coefficient of determination."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ErrorStatistics:
    """Errors of predictions against targets, in the targets' unit.

    Attributes:
        count: number of pairs.
        rmse: root-mean-square error; 0 for no pairs.
        max_error: largest absolute error; 0 for no pairs.
        r2: 1 - residual sum of squares / total sum of squares about the mean; None where the targets do not vary.
    """

    count: int
    rmse: float
    max_error: float
    r2: float | None


def error_statistics(
    targets: NDArray[np.float64], predictions: NDArray[np.float64]
) -> ErrorStatistics:
    """Compares predictions (n,) with targets (n,), pair by pair.

    Raises:
        ValueError: the two differ in shape.
    """
    if targets.shape != predictions.shape:
        raise ValueError(f"targets {targets.shape} and predictions {predictions.shape} must match")
    if targets.size == 0:
        return ErrorStatistics(0, 0.0, 0.0, None)
    errors = predictions - targets
    residual = float(np.sum(errors**2))
    total = float(np.sum((targets - targets.mean()) ** 2))
    return ErrorStatistics(
        count=int(targets.size),
        rmse=float(np.sqrt(residual / targets.size)),
        max_error=float(np.abs(errors).max()),
        r2=1.0 - residual / total if total > 0.0 else None,
    )
