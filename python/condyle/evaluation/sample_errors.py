# SPDX-License-Identifier: Apache-2.0
"""Errors of a surrogate over held-out samples, by domain, side and load (Marra et al. 2017, Table 2)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.evaluation.metrics import error_statistics


def sample_error_table(
    domains: NDArray[np.integer[Any]],
    reference: NDArray[np.float64],
    surrogate: NDArray[np.float64],
) -> list[dict[str, Any]]:
    """One row for every domain (and all together, named ``all``), side and load.

    RMSE and maximum are over all samples of the domain. R² is over *loaded* samples, those where the reference's side
    carries Fy > 0: a side in the air is exactly zero, and counting it would flatter the fit.

    Args:
        domains: domain of each sample, (n,).
        reference: reference wrenches, (n, 2, 6) [N, Nm].
        surrogate: surrogate wrenches at the same poses, (n, 2, 6) [N, Nm].

    Returns:
        Rows with domain, side, load, unit, count, rmse, max_error, loaded_count, loaded_rmse, loaded_r2.
    """
    rows: list[dict[str, Any]] = []
    groups: list[tuple[str, NDArray[np.bool_]]] = [
        (str(domain), domains == domain) for domain in sorted(set(domains.tolist()))
    ]
    groups.append(("all", np.ones(len(domains), dtype=bool)))
    for domain, chosen in groups:
        for s, side in enumerate(SIDES):
            loaded = chosen & (reference[:, s, 1] > 0.0)
            for i, load in enumerate(LOAD_COLUMNS):
                every = error_statistics(reference[chosen, s, i], surrogate[chosen, s, i])
                some = error_statistics(reference[loaded, s, i], surrogate[loaded, s, i])
                rows.append(
                    {
                        "domain": domain,
                        "side": side,
                        "load": load,
                        "unit": LOAD_UNITS[i],
                        "count": every.count,
                        "rmse": every.rmse,
                        "max_error": every.max_error,
                        "loaded_count": some.count,
                        "loaded_rmse": some.rmse,
                        "loaded_r2": some.r2,
                    }
                )
    return rows
