# SPDX-License-Identifier: Apache-2.0
"""The regions that a dataset was drawn from, rebuilt from its manifest: for figures.

A domain's outline in a plane is the convex hull of its points there; only domain 1 is a union of
many boxes, one a time frame.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from condyle.sampling.domain_envelopes import EnvelopeDomain
from condyle.sampling.equilibrium_protocol import GIVEN_COLUMNS
from condyle.sampling.principal_axes import PrincipalAxes, PrincipalBox
from condyle.sampling.reference_curves import ReferenceCurves


@dataclass(frozen=True)
class Outline:
    """What a domain was drawn from.

    Attributes:
        boxes: (k, m, 8) m points that span each of k convex regions, columns GIVEN_COLUMNS
            [m, rad, N, Nm]; NaN where the domain prescribes nothing.
    """

    boxes: NDArray[np.float64]


def domain_outlines(
    manifest: Mapping[str, Any], curves: ReferenceCurves | None = None
) -> dict[int, Outline]:
    """The outlines of a dataset's domains.

    Domain 5 has none: its points are domain 4's samples, raised. Samples from elsewhere have none.

    Args:
        manifest: The dataset's.
        curves: The reference curves, which domain 1 needs; without them it is left out.
    """
    outlines = {}
    for entry in manifest["domains"]:
        definition = entry.get("definition", {})
        if "axes" in definition:
            outlines[entry["domain"]] = Outline(_box_points(definition)[None])
        elif entry["domain"] == EnvelopeDomain.number and curves is not None:
            frames = sum(activity["time_frames"] for activity in definition["activities"])
            drawn = EnvelopeDomain.around(curves, frames, tuple(definition["columns"]))
            boxes = np.full((frames, 2, len(GIVEN_COLUMNS)), np.nan)
            places = [GIVEN_COLUMNS.index(name) for name in drawn.columns]
            boxes[:, 0, places] = drawn.centres - drawn.half_widths
            boxes[:, 1, places] = drawn.centres + drawn.half_widths
            outlines[entry["domain"]] = Outline(boxes)
    return outlines


def _box_points(definition: Mapping[str, Any]) -> NDArray[np.float64]:
    """Corners (m, 8) of a box in principal scores, and of the ranges drawn beside it."""
    axes = PrincipalAxes(
        tuple(definition["columns"]),
        *(np.array(definition[name]) for name in ("mean", "scale", "axes")),
    )
    box = PrincipalBox(axes, np.array(definition["score_low"]), np.array(definition["score_high"]))
    columns = dict(zip(axes.columns, box.corners().T, strict=True))
    ranges = {name: definition[name] for name in GIVEN_COLUMNS if name in definition}
    for name in [name for name in ranges if name in columns]:
        # Domain 3 stretches its box in θx to this range.
        low, high = ranges.pop(name)
        own = columns[name]
        columns[name] = low + (high - low) * (own - own.min()) / (own.max() - own.min())
    ends = np.array(list(itertools.product(*ranges.values())))
    corners = len(next(iter(columns.values())))
    points = np.full((len(ends) * corners, len(GIVEN_COLUMNS)), np.nan)
    for name, values in columns.items():
        points[:, GIVEN_COLUMNS.index(name)] = np.tile(values, len(ends))
    for name, values in zip(ranges, ends.T, strict=True):
        points[:, GIVEN_COLUMNS.index(name)] = np.repeat(values, corners)
    return points
