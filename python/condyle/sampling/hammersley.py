# SPDX-License-Identifier: Apache-2.0
"""Hammersley point sets on the unit cube.

    u_i = (i/N, φ₂(i), φ₃(i), φ₅(i), φ₇(i), φ₁₁(i)),   i = 0 … N − 1,

φ_b(i) being i's digits in base b mirrored about the point (the radical inverse). A Hammersley set
has no continuation: a further set of points is another complete set, shifted modulo 1 (a
Cranley–Patterson rotation) so that it does not repeat the first one.

Samplers return the unit cube; :mod:`condyle.sampling.domains` maps it to poses and loads.

References:
    Hammersley JM (1960), Monte Carlo methods for solving multivariable problems. Ann NY Acad Sci
    86:844-874. Cranley R, Patterson TNL (1976), Randomization of number theoretic methods for
    multiple integration. SIAM J Numer Anal 13:904-914.
"""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError

_BASES = (2, 3, 5, 7, 11, 13, 17)
MAX_DIMENSIONS = 1 + len(_BASES)


def radical_inverse(index: NDArray[np.int64], base: int) -> NDArray[np.float64]:
    """φ_base of each index (n,), in [0, 1)."""
    remaining = np.array(index, dtype=np.int64)
    inverse = np.zeros(remaining.shape)
    place = 1.0
    while np.any(remaining > 0):
        place /= base
        remaining, digit = np.divmod(remaining, base)
        inverse += digit * place
    return inverse


def hammersley(
    size: int,
    dimensions: int = 6,
    *,
    start: int = 0,
    stop: int | None = None,
    shift: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Rows ``start`` to ``stop`` of the Hammersley set of ``size`` points.

    Args:
        size: N, the number of points of the whole set.
        dimensions: d, 1 to ``MAX_DIMENSIONS``.
        start: First row; rows are computed on demand, so a large set need never be in memory.
        stop: One past the last row; N by default.
        shift: (d,) added modulo 1.

    Returns:
        (stop − start, d) in [0, 1).

    Raises:
        InputDataError: A size, dimension or row range that does not exist.
    """
    stop = size if stop is None else stop
    if size < 1:
        raise InputDataError(f"Hammersley size is {size}; at least 1 point is needed")
    if not 1 <= dimensions <= MAX_DIMENSIONS:
        raise InputDataError(
            f"Hammersley dimensions is {dimensions}; it must be 1 to {MAX_DIMENSIONS}"
        )
    if not 0 <= start <= stop <= size:
        raise InputDataError(f"Hammersley rows {start} to {stop} are not within the set of {size}")
    index = np.arange(start, stop, dtype=np.int64)
    columns = [index / size, *(radical_inverse(index, base) for base in _BASES[: dimensions - 1])]
    unit = np.column_stack(columns)
    if shift is None:
        return unit
    if np.shape(shift) != (dimensions,):
        raise InputDataError(
            f"Hammersley shift has shape {np.shape(shift)}; ({dimensions},) is needed"
        )
    return np.mod(unit + shift, 1.0)


def seeded_shift(seed: int, label: str, dimensions: int = 6) -> NDArray[np.float64]:
    """A vector (d,) in [0, 1) from a seed and a label that names its use.

    It comes from a hash and not from a random generator, so that it is the same for every numpy
    version.
    """
    words = [
        int.from_bytes(
            hashlib.blake2b(f"{seed}/{label}/{axis}".encode(), digest_size=8).digest(), "big"
        )
        for axis in range(dimensions)
    ]
    # The top 53 bits: a float64 in [0, 1) exactly, with no rounding up to 1.
    return np.array([(word >> 11) * 2.0**-53 for word in words])
