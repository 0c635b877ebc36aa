# SPDX-License-Identifier: Apache-2.0
"""The evaluated candidates of a run, one Parquet part a chunk.

Append-only, so a run goes on where it stopped:

    DIRECTORY/candidates/domain-2/round-01/part-00017.parquet

Round 0 is the pilot. The parts stay when the run is complete: they show where candidates were
rejected, and why.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from condyle.sampling.chunk import Chunk
from condyle.sampling.domain import SamplingDomain
from condyle.sampling.equilibrium_protocol import StaticEquilibriumSolver
from condyle.sampling.evaluate_chunk import ACCEPTED, INFEASIBLE, evaluate_chunk
from condyle.sampling.executors import ChunkExecutor, Done, Pending, in_flight
from condyle.sampling.part_files import damaged, encode_part, read_part, read_part_record
from condyle.sampling.plan import SamplingPlan
from condyle.whole_files import write_whole

CANDIDATES_FOLDER: Final = "candidates"
#: What evaluating a chunk gives: its table and its tally.
_Evaluated = tuple[pa.Table, dict[str, Any]]


@dataclass
class Tally:
    """Candidates and contact evaluations by status; accepted candidates with both sides loaded."""

    counts: Counter[str] = field(default_factory=Counter)
    evaluations: Counter[str] = field(default_factory=Counter)
    two_sided: int = 0

    def add(self, record: dict[str, Any]) -> None:
        """Add a part's."""
        self.counts.update(record["counts"])
        self.evaluations.update(record["evaluations"])
        self.two_sided += record["two_sided"]

    def merge(self, other: Tally) -> None:
        """Add another tally."""
        self.counts.update(other.counts)
        self.evaluations.update(other.evaluations)
        self.two_sided += other.two_sided

    @property
    def candidates(self) -> int:
        """All of them."""
        return self.counts.total()

    @property
    def accepted(self) -> int:
        """Those that can be samples."""
        return self.counts[ACCEPTED]

    @property
    def solver_evaluations(self) -> int:
        """Contact evaluations spent on candidates that statics allow."""
        return self.evaluations.total() - sum(self.evaluations[reason] for reason in INFEASIBLE)


class CandidateStore:
    """See the module docstring.

    Args:
        directory: The dataset's.
        design_hash: The manifest's; part of every record.
        plan: The sampling plan.
        solver: The static equilibrium solver.
        executor: Where chunks are evaluated; in this thread when None.
    """

    def __init__(
        self,
        directory: Path,
        design_hash: str,
        plan: SamplingPlan,
        solver: StaticEquilibriumSolver,
        executor: ChunkExecutor | None,
    ) -> None:
        self._directory = directory / CANDIDATES_FOLDER
        self._design_hash = design_hash
        self._plan = plan
        self._solver = solver
        self._executor = executor

    def path(self, chunk: Chunk) -> Path:
        """A chunk's part file."""
        folder = self._directory / f"domain-{chunk.domain}" / f"round-{chunk.round_number:02d}"
        return folder / f"part-{chunk.start // self._plan.chunk_rows:05d}.parquet"

    def accepted(self, chunk: Chunk, columns: list[str] | None = None) -> pa.Table:
        """The accepted candidates of an evaluated chunk, or some of their columns."""
        wanted = None if columns is None else [*columns, "status"]
        table = read_part(self.path(chunk), wanted)
        good = [status == ACCEPTED for status in table.column("status").to_pylist()]
        return table.filter(pa.array(good, pa.bool_()))

    def accepted_ids(self, chunk: Chunk, column: str = "candidate") -> NDArray[np.uint64]:
        """Their ids, or another column of ids."""
        ids: NDArray[np.uint64] = self.accepted(chunk, [column]).column(column).to_numpy()
        return ids

    def evaluate(
        self, chunks: Iterator[Chunk], domain: SamplingDomain
    ) -> Iterator[tuple[Chunk, dict[str, Any], bool]]:
        """Each chunk with its record, in order, and whether it was evaluated now: what is stored is not again.

        Raises:
            InputDataError: A stored part is damaged or another run's, or a part cannot be written.
            CondyleError: An executor's workers cannot go on.
        """
        pending: deque[tuple[Chunk, dict[str, Any] | Pending[_Evaluated]]] = deque()
        room = 1 if self._executor is None else in_flight(self._executor)
        try:
            for chunk in chunks:
                pending.append((chunk, self._stored(chunk) or self._start(chunk, domain)))
                # What is finished is written at once, however much room there is.
                while pending and (len(pending) >= room or _is_done(pending[0][1])):
                    yield self._finish(*pending.popleft())
            while pending:
                yield self._finish(*pending.popleft())
        finally:
            for _, work in pending:
                if not isinstance(work, dict):
                    work.cancel()

    def _stored(self, chunk: Chunk) -> dict[str, Any] | None:
        path = self.path(chunk)
        if not path.exists():
            return None
        record = read_part_record(path)
        expected = {"design": self._design_hash, **chunk.record()}
        for name, value in expected.items():
            if record.get(name) != value:
                raise damaged(path, f"its {name} is {record.get(name)!r}, {value!r} belongs here")
        return record

    def _start(self, chunk: Chunk, domain: SamplingDomain) -> Pending[_Evaluated]:
        work = (chunk, domain, self._plan, self._solver)
        if self._executor is None:
            return Done(evaluate_chunk(*work))
        return self._executor.submit(evaluate_chunk, *work)

    def _finish(
        self, chunk: Chunk, work: dict[str, Any] | Pending[_Evaluated]
    ) -> tuple[Chunk, dict[str, Any], bool]:
        if isinstance(work, dict):
            return chunk, work, False
        table, tally = work.result()
        record = {"design": self._design_hash, **chunk.record(), **tally}
        write_whole(self.path(chunk), encode_part(table, record))
        return chunk, record, True


def _is_done(work: dict[str, Any] | Pending[_Evaluated]) -> bool:
    return isinstance(work, dict) or work.done()
