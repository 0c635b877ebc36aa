# SPDX-License-Identifier: Apache-2.0
"""How far a surrogate can be trusted at a pose: a 95 % bound on each load, a number in [0, 1].

**error.** For each side and load, a bound that grows with the side's predicted compression,

    error = a + b·max(Fy, 0),

so that a lightly loaded pose is not given a 4 kN pose's bound. The ratio b/a is fitted to one half
of the held-out residuals by quantile (pinball) regression; the other half then scales the bound so
that it covers ``level`` of exchangeable samples whatever the residuals' distribution (split
conformal prediction, Lei et al. 2018, with the usual (n + 1) correction). Only samples in which the
side is truly loaded take part: those in which it is lifted are mostly exact zeros and would flatter
the bound.

**trust.** With m how far a pose is out of the sampled domains (1 on the edge of one; see
:mod:`condyle.training.sampled_domains`),

    trust = clip(1/2 − (m − edge) / (2·ramp), 0, 1),

where ``edge`` lets ``false_alarms`` of the loaded held-out samples be out, and is 1 to 1.1. Gaps inside
the domains are not noticed.

References: Lei, G'Sell, Rinaldo, Tibshirani & Wasserman (2018), J Am Stat Assoc 113(523):1094-1111,
doi:10.1080/01621459.2017.1307116. Koenker & Bassett (1978), Econometrica 46(1):33-50,
doi:10.2307/1913643.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES
from condyle.errors import InputDataError
from condyle.training.input_data import FY, as_poses, as_wrenches
from condyle.training.sampled_domains import SampledDomains

#: Candidates for b/a in units of 1/Fy_max: from a constant bound to one that all but vanishes with
#: the load.
_SLOPE_RATIOS = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
#: Held-out samples further out than this are not of the domains that the training's are.
_WIDEST_EDGE = 1.1
#: Fewest loaded held-out rows a side that say anything about a 95 % quantile in each half.
_MIN_HELD_OUT = 50


class WrenchModel(Protocol):
    """Anything that predicts wrenches (n, 2, 6) at poses (n, 6)."""

    def wrench(self, poses: ArrayLike) -> NDArray[np.float64]:
        """Wrench (n, 2, 6) [N, Nm]."""
        ...


@dataclass(frozen=True)
class TrustModel:
    """See the module docstring. Build with :meth:`calibrate`.

    Attributes:
        level: Share of samples that the bound covers.
        error_offset: a (2, 6) [N, Nm].
        error_slope: b (2, 6) [-, m].
        coverage: Share (2, 6) of all held-out loaded rows within the bound.
        held_out_rmse: Root mean square residual (2, 6) of held-out loaded rows [N, Nm].
        held_out_max: Largest residual (2, 6) of held-out loaded rows [N, Nm].
        n_held_out: Held-out rows in which the (medial, lateral) side is loaded.
        domains: Where the training samples lie.
        max_fy: Largest Fy of each side in training (2,) [N].
        pose_min: Smallest training pose, per coordinate (6,) [m, rad].
        pose_max: Largest (6,).
        edge: See the module docstring.
        ramp: Half width of the ramp of trust.
    """

    level: float
    error_offset: NDArray[np.float64]
    error_slope: NDArray[np.float64]
    coverage: NDArray[np.float64]
    held_out_rmse: NDArray[np.float64]
    held_out_max: NDArray[np.float64]
    n_held_out: tuple[int, int]
    domains: SampledDomains
    max_fy: NDArray[np.float64]
    pose_min: NDArray[np.float64]
    pose_max: NDArray[np.float64]
    edge: float
    ramp: float = 0.05

    @classmethod
    def calibrate(
        cls,
        model: WrenchModel,
        train_poses: ArrayLike,
        train_wrenches: ArrayLike,
        held_out_poses: ArrayLike,
        held_out_wrenches: ArrayLike,
        *,
        train_domain: NDArray[np.int64] | None = None,
        definitions: Sequence[Mapping[str, Any]] = (),
        level: float = 0.95,
        false_alarms: float = 0.015,
        seed: int = 1,
    ) -> TrustModel:
        """Bounds and domain from samples.

        Args:
            model: The surrogate.
            train_poses: (n, 6) poses it learned from, for the domain.
            train_wrenches: (n, 2, 6) their wrenches.
            held_out_poses: (m, 6) poses it has not seen, from the same domains.
            held_out_wrenches: (m, 2, 6) their wrenches.
            train_domain: (n,) the training samples' domains, if they are known.
            definitions: What the dataset's manifest says of them (``domains``).
            level: Coverage of ``error``.
            false_alarms: Share of loaded held-out samples that may be called outside.
            seed: Of the split of the held-out rows into two halves.

        Raises:
            InputDataError: Wrong shapes, values not finite, a side loaded in too few held-out rows.
        """
        if not 0.0 < level < 1.0:
            raise InputDataError(f"level is {level}; it must lie between 0 and 1")
        train_poses = as_poses(train_poses, "train_poses")
        train_wrenches = as_wrenches(train_wrenches, len(train_poses), "train_wrenches")
        held_out_poses = as_poses(held_out_poses, "held_out_poses")
        truth = as_wrenches(held_out_wrenches, len(held_out_poses), "held_out_wrenches")
        predicted = model.wrench(held_out_poses)
        max_fy = train_wrenches[:, :, FY].max(axis=0)
        tables, counts = _error_tables(predicted, truth, max_fy, level, seed)
        domains = SampledDomains.around(
            train_poses, train_wrenches, train_domain, definitions, model.wrench(train_poses)
        )
        # Loaded samples only: raised copies, which most samples are, lie well inside.
        loaded = (truth[:, :, FY] > 0).any(axis=1)
        outside = np.sort(domains.excess(held_out_poses[loaded], predicted[loaded]))
        rank = min(math.ceil((len(outside) + 1) * (1 - false_alarms)), len(outside))
        return cls(
            level=level,
            error_offset=tables["offset"],
            error_slope=tables["slope"],
            coverage=tables["coverage"],
            held_out_rmse=tables["rmse"],
            held_out_max=tables["max"],
            n_held_out=counts,
            domains=domains,
            edge=min(max(1.0, float(outside[rank - 1])), _WIDEST_EDGE),
            max_fy=max_fy,
            pose_min=train_poses.min(axis=0),
            pose_max=train_poses.max(axis=0),
        )

    def error(self, wrenches: NDArray[np.float64]) -> NDArray[np.float64]:
        """Bound [N, Nm] on the error of each load, from predicted wrenches; both (n, 2, 6)."""
        fy = np.maximum(wrenches[:, :, FY], 0.0)
        return self.error_offset + self.error_slope * fy[:, :, None]

    def trust(self, poses: ArrayLike, wrenches: NDArray[np.float64]) -> NDArray[np.float64]:
        """Trust (n,) at poses (n, 6) with predicted wrenches (n, 2, 6); below 0.5: do not use."""
        poses = as_poses(poses)
        outside = self.domains.excess(poses, wrenches) - self.edge
        ramp: NDArray[np.float64] = 0.5 - outside / (2 * self.ramp)
        return ramp.clip(0.0, 1.0)

    def error_table(self) -> dict[str, Any]:
        """JSON-able error table: per side and load a, b, coverage, RMSE and largest error."""
        columns = {
            "offset": self.error_offset,
            "slope_per_N": self.error_slope,
            "coverage": self.coverage,
            "rmse": self.held_out_rmse,
            "max": self.held_out_max,
        }
        table: dict[str, Any] = {
            "level": self.level,
            "formula": "offset + slope_per_N * max(Fy, 0)",
        }
        for side, name in enumerate(SIDES):
            loads = {
                load: {column: float(values[side, index]) for column, values in columns.items()}
                for index, load in enumerate(LOAD_COLUMNS)
            }
            table[name] = {"n_held_out": self.n_held_out[side], "loads": loads}
        return table

    def domain_bounds(self) -> dict[str, Any]:
        """JSON-able bounds of the training poses and loads, and the cells of ``trust``."""
        return {
            "pose_min": dict(zip(POSE_COLUMNS, self.pose_min.tolist(), strict=True)),
            "pose_max": dict(zip(POSE_COLUMNS, self.pose_max.tolist(), strict=True)),
            "max_Fy": dict(zip(SIDES, self.max_fy.tolist(), strict=True)),
            "cells": list(self.domains.names),
            "edge": self.edge,
            "ramp": self.ramp,
        }


def _error_tables(
    predicted: NDArray[np.float64],
    truth: NDArray[np.float64],
    max_fy: NDArray[np.float64],
    level: float,
    seed: int,
) -> tuple[dict[str, NDArray[np.float64]], tuple[int, int]]:
    """Tables (2, 6) of a, b, coverage, RMSE and largest error; loaded rows of (medial, lateral)."""
    generator = np.random.default_rng(seed)
    shape = (len(SIDES), len(LOAD_COLUMNS))
    tables = {name: np.zeros(shape) for name in ("offset", "slope", "coverage", "rmse", "max")}
    counts = []
    for side, name in enumerate(SIDES):
        rows = np.flatnonzero(truth[:, side, FY] > 0)
        if len(rows) < _MIN_HELD_OUT:
            raise InputDataError(
                f"held_out_wrenches: the {name} side is loaded in {len(rows)} rows; "
                f"at least {_MIN_HELD_OUT} are needed"
            )
        counts.append(len(rows))
        rows = generator.permutation(rows)
        residuals = np.abs(predicted[rows, side] - truth[rows, side])
        load = np.maximum(predicted[rows, side, FY], 0.0) / max_fy[side]
        for index in range(len(LOAD_COLUMNS)):
            ratio, scale = _fit_bound(residuals[:, index], load, level)
            tables["offset"][side, index] = scale
            tables["slope"][side, index] = scale * ratio / max_fy[side]
            bound = scale * (1 + ratio * load)
            tables["coverage"][side, index] = (residuals[:, index] <= bound).mean()
        tables["rmse"][side] = np.sqrt((residuals**2).mean(axis=0))
        tables["max"][side] = residuals.max(axis=0)
    return tables, (counts[0], counts[1])


def _fit_bound(
    residuals: NDArray[np.float64], load: NDArray[np.float64], level: float
) -> tuple[float, float]:
    """(ratio, scale) of the bound scale·(1 + ratio·load) on residuals (n,); load (n,) in [0, 1]."""
    half = len(residuals) // 2
    best_ratio, best_loss = 0.0, math.inf
    for ratio in _SLOPE_RATIOS:
        shape = 1 + ratio * load[:half]
        scale = float(np.quantile(residuals[:half] / shape, level))
        difference = residuals[:half] - scale * shape
        loss = float(np.where(difference > 0, level * difference, (level - 1) * difference).mean())
        if loss < best_loss:
            best_ratio, best_loss = ratio, loss
    scores = np.sort(residuals[half:] / (1 + best_ratio * load[half:]))
    # Conformal quantile: the ceil((n + 1)·level)-th smallest of n scores, or the largest where
    # there is none.
    rank = min(math.ceil((len(scores) + 1) * level), len(scores))
    return best_ratio, float(scores[rank - 1])
