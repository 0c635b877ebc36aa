# SPDX-License-Identifier: Apache-2.0
"""What a sampling domain is: a region of the design space that candidates are drawn from.

The domains' numbers are the paper's (Marra 2017, Table 1).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from condyle.sampling.chunk import Chunk, cube_points
from condyle.sampling.equilibrium_protocol import Prescribed

#: Domain number → what it is called.
DOMAIN_NAMES: Final = {
    1: "time-varying envelopes",
    2: "global",
    3: "single-sided",
    4: "contact boundary",
    5: "proximity",
    6: "far",
}

#: Published counts (training, testing) of each domain: Marra 2017, Table 1.
PAPER_COUNTS: Final = {
    1: (18_060, 0),
    2: (27_253, 3_416),
    3: (10_000, 1_765),
    4: (9_990, 1_755),
    5: (67_760, 11_958),
    6: (2_000, 353),
}


class SamplingDomain(Protocol):
    """A region of the design space."""

    @property
    def number(self) -> int:
        """The paper's number of it."""

    @property
    def contact_free(self) -> bool:
        """Whether a candidate that touches does not belong to the domain."""

    def draw(self, chunk: Chunk, seed: int) -> Prescribed:
        """The chunk's candidates."""

    def sources(self, chunk: Chunk) -> NDArray[np.uint64]:
        """For each of them the candidate whose hash decides its split: (n,)."""

    def envelope(self) -> NDArray[np.float64]:
        """Points (m, 6), columns PRESCRIBED_COLUMNS, that span the domain.

        Their convex hull in any two columns is the domain's shadow there.
        """

    def describe(self) -> dict[str, object]:
        """Everything that defines the domain, for a manifest."""


class CubeDomain(ABC):
    """A domain that is the image of the unit cube: a round is one Hammersley set."""

    contact_free: ClassVar[bool] = False

    @abstractmethod
    def prescribe(self, unit: NDArray[np.float64]) -> Prescribed:
        """The equilibria that points (n, 6) of the unit cube stand for."""

    def draw(self, chunk: Chunk, seed: int) -> Prescribed:
        """The chunk's candidates."""
        return self.prescribe(cube_points(chunk, seed))

    def sources(self, chunk: Chunk) -> NDArray[np.uint64]:
        """Each candidate stands for itself."""
        return chunk.ids()
