# SPDX-License-Identifier: Apache-2.0
"""Rounds of candidates, and the chunks that they are evaluated in.

Round 0 is the pilot. Pilot and first round are Hammersley sets as they are; later rounds have their
own shift.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.sampling.hammersley import hammersley, seeded_shift
from condyle.sampling.selection import candidate_ids

PILOT_ROUND: Final = 0


@dataclass(frozen=True)
class Chunk:
    """Candidates ``start`` to ``stop`` of a round of ``round_size``."""

    domain: int
    round_number: int
    round_size: int
    start: int
    stop: int

    def record(self) -> dict[str, int]:
        """What identifies the chunk, for its part file."""
        return {
            "domain": self.domain,
            "round": self.round_number,
            "round_size": self.round_size,
            "start": self.start,
            "stop": self.stop,
        }

    def ids(self) -> NDArray[np.uint64]:
        """The candidates' ids (stop − start,)."""
        return candidate_ids(self.domain, self.round_number, self.start, self.stop)

    def rows(self) -> NDArray[np.int64]:
        """The candidates' places in the round (stop − start,)."""
        return np.arange(self.start, self.stop, dtype=np.int64)


def round_chunks(domain: int, round_number: int, round_size: int, rows: int) -> Iterator[Chunk]:
    """The chunks of a round, in order."""
    for start in range(0, round_size, rows):
        yield Chunk(domain, round_number, round_size, start, min(start + rows, round_size))


def cube_points(chunk: Chunk, seed: int) -> NDArray[np.float64]:
    """The chunk's points (n, 6) of the unit cube, its round being one Hammersley set."""
    shift = None
    if chunk.round_number > PILOT_ROUND + 1:
        shift = seeded_shift(seed, f"domain {chunk.domain} round {chunk.round_number}")
    return hammersley(chunk.round_size, start=chunk.start, stop=chunk.stop, shift=shift)
