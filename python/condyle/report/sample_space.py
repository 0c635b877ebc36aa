# SPDX-License-Identifier: Apache-2.0
"""What figures of a dataset are drawn from: its variables in readable units, and who is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS
from condyle.errors import InputDataError
from condyle.report.style import DOMAIN_COLOURS, OTHER_COLOUR
from condyle.sampling import (
    DOMAIN_NAMES,
    Candidates,
    Dataset,
    Outline,
    ReferenceCurves,
    domain_outlines,
    keyed_hash,
    read_candidates,
)
from condyle.sampling.equilibrium_protocol import GIVEN_COLUMNS


@dataclass(frozen=True)
class Variable:
    """How a variable is shown.

    Attributes:
        label: with its unit.
        factor: from SI to that unit.
    """

    label: str
    factor: float


_MM, _DEG = 1e3, 180 / np.pi
VARIABLES: Final = {
    "x": Variable("x [mm]", _MM),
    "y": Variable("y [mm]", _MM),
    "z": Variable("z [mm]", _MM),
    "theta_x": Variable("θx [deg]", _DEG),
    "theta_y": Variable("θy [deg]", _DEG),
    "theta_z": Variable("θz [deg]", _DEG),
    "Fy": Variable("Fy [N]", 1.0),
    "Mx": Variable("Mx [Nm]", 1.0),
}
Columns = dict[str, NDArray[np.float64]]
#: Key of the hash that chooses who is shown, any constant: the same dataset gives the same figure.
_SHOWN_KEY: Final = 0


@dataclass(frozen=True)
class SampleSpace:
    """A dataset as its figures see it. All columns are by name, in the units of VARIABLES.

    Attributes:
        columns: (n,) each, of the samples; Fy and Mx are summed over the sides.
        domain: (n,) of the samples.
        ids: (n,) of the samples.
        curves: reference curves: activity → columns over time.
        outlines: see :func:`condyle.sampling.domain_outlines`.
        candidates: all candidates of each domain; none of a dataset from elsewhere.
    """

    columns: Columns
    domain: NDArray[np.int64]
    ids: NDArray[np.uint64]
    curves: Mapping[str, Columns]
    outlines: Mapping[int, Outline]
    candidates: Mapping[int, Candidates] = field(default_factory=dict)

    @classmethod
    def read(cls, directory: Path, curves: ReferenceCurves | None = None) -> SampleSpace:
        """Of a complete dataset, and the curves that it was sampled around, if any.

        Raises:
            InputDataError: not a complete dataset, or a part is damaged.
        """
        data = Dataset.read(directory)
        numbers = [entry["domain"] for entry in data.manifest["domains"]]
        candidates = {}
        if "design_hash" in data.manifest:
            candidates = {number: read_candidates(directory, number) for number in numbers}
        return cls(
            sample_columns(data.poses, data.wrenches),
            data.domain,
            data.candidate,
            {} if curves is None else _curve_columns(curves),
            domain_outlines(data.manifest, curves),
            candidates,
        )

    @property
    def domains(self) -> list[int]:
        """Numbers of the domains that have samples."""
        return sorted(set(self.domain.tolist()))

    def shown(self, domain: int, most: int) -> NDArray[np.int64]:
        """Rows of at most ``most`` samples of a domain, see :func:`spread`."""
        rows = np.flatnonzero(self.domain == domain)
        return rows[spread(self.ids[rows], most)]


def sample_columns(poses: NDArray[np.float64], wrenches: NDArray[np.float64]) -> Columns:
    """Columns of poses (n, 6) and wrenches (n, 2, 6)."""
    total = wrenches.sum(axis=1)
    values = dict(zip((*POSE_COLUMNS, *LOAD_COLUMNS), np.hstack([poses, total]).T, strict=True))
    return {name: variable.factor * values[name] for name, variable in VARIABLES.items()}


def given_columns(values: NDArray[np.float64]) -> Columns:
    """Columns of values (..., 8) as GIVEN_COLUMNS."""
    return {
        name: VARIABLES[name].factor * values[..., GIVEN_COLUMNS.index(name)]
        for name in GIVEN_COLUMNS
    }


def candidate_columns(candidates: Candidates) -> Columns:
    """What candidates prescribe; NaN where they do not."""
    # GIVEN_COLUMNS are PRESCRIBED_COLUMNS, then SENSITIVE_COLUMNS.
    return given_columns(np.hstack([candidates.prescribed, candidates.sensitive]))


def spread(ids: NDArray[np.uint64], most: int) -> NDArray[np.int64]:
    """Places (≤ most,) of the ids with the smallest hashes, in the hashes' order.

    Every k-th row would be another region, not a sample of it: a Hammersley set's digits repeat
    with the powers of its bases.
    """
    if most < 1:
        raise InputDataError(f"a figure with {most} samples a domain: at least 1 is needed")
    return np.argsort(keyed_hash(ids, _SHOWN_KEY), kind="stable")[:most]


def convex_hull(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners (m, 2) of the convex hull of points (n, 2), anticlockwise (Andrew's monotone chain)."""
    ordered = np.unique(points, axis=0)
    if len(ordered) < 3:
        return ordered

    def half(chain_points: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        chain: list[NDArray[np.float64]] = []
        for point in chain_points:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _turn(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def colour_of(domain: int) -> str:
    """A domain's colour."""
    return DOMAIN_COLOURS.get(domain, OTHER_COLOUR)


def name_of(domain: int) -> str:
    """What a domain is called in a legend."""
    name = DOMAIN_NAMES.get(domain)
    return f"{domain} {name}" if name else ("from elsewhere" if domain == 0 else f"domain {domain}")


def _curve_columns(curves: ReferenceCurves) -> dict[str, Columns]:
    return {
        curve.name: {
            name: variable.factor * curve.column(name) for name, variable in VARIABLES.items()
        }
        for curve in curves.curves
    }
