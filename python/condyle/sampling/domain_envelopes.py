# SPDX-License-Identifier: Apache-2.0
"""Domain 1, time-varying envelopes: each time frame of the activities, and what lies close by.

All reference curves are resampled to a number of time frames together; at each, every one of the
six variables spans its value ± one standard deviation of that variable over that activity. Each
time frame has its own Hammersley set, shifted modulo 1 by the seed, so that the frames do not
repeat one another's pattern.
"""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from condyle.sampling.chunk import Chunk
from condyle.sampling.equilibrium_protocol import PRESCRIBED_COLUMNS, Prescribed
from condyle.sampling.hammersley import hammersley, seeded_shift
from condyle.sampling.reference_curves import ReferenceCurve, ReferenceCurves

#: Equally spaced times over which an activity's standard deviations are taken.
_DEVIATION_FRAMES: Final = 1000


@dataclass(frozen=True)
class EnvelopeDomain:
    """See the module docstring.

    Attributes:
        centres: (f, 6) the curves at the f time frames.
        half_widths: (f, 6) one standard deviation of each variable over the frame's activity.
        activities: (name, time frames) of each activity, in order.
        sizes: (f,) candidates of each time frame in the round that is drawn.
        columns: The six variables: PRESCRIBED_COLUMNS, with θx for Mx where only y is sensitive.
    """

    centres: NDArray[np.float64]
    half_widths: NDArray[np.float64]
    activities: tuple[tuple[str, int], ...]
    sizes: NDArray[np.int64]
    columns: tuple[str, ...] = PRESCRIBED_COLUMNS

    number: ClassVar[int] = 1
    contact_free: ClassVar[bool] = False

    @classmethod
    def around(
        cls,
        curves: ReferenceCurves,
        frames: int,
        columns: tuple[str, ...] = PRESCRIBED_COLUMNS,
    ) -> EnvelopeDomain:
        """The domain of reference curves, at ``frames`` time frames together."""
        resampled = curves.resampled(frames).curves
        centres = [_table(curve, columns) for curve in resampled]
        # Over time, however many time frames the curve has or is given here.
        deviations = [
            _table(curve.resampled(_DEVIATION_FRAMES), columns).std(axis=0)
            for curve in curves.curves
        ]
        return cls(
            np.concatenate(centres),
            np.repeat(deviations, [len(table) for table in centres], axis=0),
            tuple((curve.name, len(curve.time)) for curve in resampled),
            np.zeros(frames, dtype=np.int64),
            columns,
        )

    def with_sizes(self, sizes: NDArray[np.int64]) -> EnvelopeDomain:
        """The same domain, about to draw a round of these sizes (f,)."""
        return dataclasses.replace(self, sizes=sizes)

    def frames_of(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """The time frames (n,) of the round's candidates."""
        return np.searchsorted(np.cumsum(self.sizes), rows, side="right")

    def draw(self, chunk: Chunk, seed: int) -> Prescribed:
        """The chunk's candidates, frame by frame."""
        ends = np.cumsum(self.sizes)
        values = []
        for frame in np.unique(self.frames_of(chunk.rows())):
            first = int(ends[frame] - self.sizes[frame])
            unit = hammersley(
                int(self.sizes[frame]),
                start=max(chunk.start - first, 0),
                stop=min(chunk.stop, int(ends[frame])) - first,
                shift=seeded_shift(seed, f"domain 1 round {chunk.round_number} frame {frame}"),
            )
            values.append(self.centres[frame] + (2 * unit - 1) * self.half_widths[frame])
        return Prescribed.from_columns(np.concatenate(values), self.columns)

    def sources(self, chunk: Chunk) -> NDArray[np.uint64]:
        """Each candidate stands for itself."""
        return chunk.ids()

    def envelope(self) -> NDArray[np.float64]:
        """The 64 corners of every time frame's box, (64 f, 6), columns PRESCRIBED_COLUMNS.

        Mx is NaN where θx is drawn.
        """
        signs = np.array(list(itertools.product((-1.0, 1.0), repeat=6)))
        corners = self.centres[:, None] + signs * self.half_widths[:, None]
        return Prescribed.from_columns(corners.reshape(-1, 6), self.columns).to_array()

    def describe(self) -> dict[str, object]:
        """Time frames and half-widths by activity."""
        firsts = np.cumsum([0] + [frames for _, frames in self.activities])[:-1]
        return {
            "kind": "at each time frame a box of ± one standard deviation over the activity",
            "columns": list(self.columns),
            "activities": [
                {
                    "name": name,
                    "time_frames": frames,
                    "standard_deviation": self.half_widths[first].tolist(),
                }
                for (name, frames), first in zip(self.activities, firsts, strict=True)
            ],
        }


def _table(curve: ReferenceCurve, columns: tuple[str, ...]) -> NDArray[np.float64]:
    return np.column_stack([curve.column(name) for name in columns])
