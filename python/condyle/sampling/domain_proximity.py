# SPDX-License-Identifier: Apache-2.0
"""Domain 5, proximity: points of the contact boundary, raised by 0.5, 1, 1.5 and 2 mm.

The pose is prescribed and the contact only evaluated there: the wrench is zero, or nearly so. A
copy takes its point's split.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import POSE_COLUMNS
from condyle.sampling.chunk import Chunk
from condyle.sampling.equilibrium_protocol import PRESCRIBED_COLUMNS, Prescribed

#: How far each copy of a point is raised [m].
RAISES: Final = (0.5e-3, 1.0e-3, 1.5e-3, 2.0e-3)


@dataclass(frozen=True)
class ProximityDomain:
    """See the module docstring.

    Attributes:
        poses: (m, 6) of boundary points [m, rad].
        ids: (m,) of these candidates.
    """

    poses: NDArray[np.float64]
    ids: NDArray[np.uint64]

    number: ClassVar[int] = 5
    contact_free: ClassVar[bool] = False

    @property
    def copies(self) -> int:
        """Candidates of a round: each point's copies, one after the other."""
        return len(self.poses) * len(RAISES)

    def draw(self, chunk: Chunk, seed: int) -> Prescribed:
        """The chunk's copies; nothing is left to the seed."""
        del seed
        return Prescribed.from_poses(self._raised(chunk.rows()))

    def sources(self, chunk: Chunk) -> NDArray[np.uint64]:
        """The points that the copies are of."""
        return self.ids[chunk.rows() // len(RAISES)]

    def envelope(self) -> NDArray[np.float64]:
        """All copies, (4 m, 6), columns PRESCRIBED_COLUMNS; Fy and Mx NaN."""
        raised = self._raised(np.arange(self.copies))
        unknown = np.full(len(raised), np.nan)
        return np.column_stack(
            [
                raised[:, POSE_COLUMNS.index(name)] if name in POSE_COLUMNS else unknown
                for name in PRESCRIBED_COLUMNS
            ]
        )

    def describe(self) -> dict[str, object]:
        """The raises."""
        return {"kind": "raised copies of contact boundary points", "raises": list(RAISES)}

    def _raised(self, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        poses = self.poses[rows // len(RAISES)].copy()
        poses[:, POSE_COLUMNS.index("y")] += np.array(RAISES)[rows % len(RAISES)]
        return poses
