# SPDX-License-Identifier: Apache-2.0
"""Where and how hard surfaces press, at poses that a simulation has found: one reference evaluation a time frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle._core.contact import DetailArrays
from condyle.contact.contact_pair import ContactPair, PairLoads
from condyle.contact.mesh_contact import MeshContact
from condyle.conventions import SIDES

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactPressures:
    """The reference contact at T poses, on c parts; NaN where a pose is not finite.

    Attributes:
        parts: ``medial`` and ``lateral``, or the names of a pair's compartments.
        wrench: (T, c, 6) on F, at Fo, in T [N, Nm].
        centre_of_pressure: (T, c, 3) in T [m]; NaN out of contact.
        peak_pressure: (T, c) [Pa].
        mean_pressure: (T, c) over the loaded faces [Pa]; None of a pair, which does not know it.
        area: (T, c) of the loaded faces [m²].
        max_depth: (T, c) [m].
        border_area: (T, c) of overlap that did not count, beyond the other surface's open border [m²].
    """

    parts: tuple[str, ...]
    wrench: Array
    centre_of_pressure: Array
    peak_pressure: Array
    mean_pressure: Array | None
    area: Array
    max_depth: Array
    border_area: Array


def contact_pressures(
    reference: MeshContact | ContactPair, poses: Array, *, threads: int = 0
) -> ContactPressures:
    """Evaluates the meshes' own contact at poses.

    Args:
        reference: of a knee's two sides, or of any pair.
        poses: (T, 6) of F in T [m, rad]; rows that are not finite are passed over.
        threads: 0 means all cores. The result does not depend on it.

    Raises:
        ValueError: poses are not (T, 6).
    """
    table = np.ascontiguousarray(poses, dtype=np.float64)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(table).all(axis=1))
    found: DetailArrays | PairLoads
    parts: tuple[str, ...] = SIDES
    mean = None
    if isinstance(reference, MeshContact):
        found = details = reference.evaluate_details(table[known], threads)
        mean = _on_rows(known, details.mean_pressure)
    else:
        found, parts = reference.evaluate(table[known], threads=threads), reference.names
    area = _on_rows(known, found.area)
    centre = _on_rows(known, found.centre_of_pressure)
    centre[area <= 0.0] = np.nan
    return ContactPressures(
        parts=parts,
        wrench=_on_rows(known, found.wrench),
        centre_of_pressure=centre,
        peak_pressure=_on_rows(known, found.peak_pressure),
        mean_pressure=mean,
        area=area,
        max_depth=_on_rows(known, found.max_depth),
        border_area=_on_rows(known, found.border_area),
    )


def _on_rows(known: NDArray[np.bool_], values: Array) -> Array:
    """The values at the known rows, NaN at the others."""
    table = np.full((len(known), *values.shape[1:]), np.nan)
    table[known] = values
    return table
