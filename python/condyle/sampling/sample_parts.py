# SPDX-License-Identifier: Apache-2.0
"""From candidates to samples: the chosen rows, in candidate order, in the parts that users read.

    DIRECTORY/samples/domain-2-part-00000.parquet

One part at a time is in memory, however large the dataset.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa

from condyle.sampling.candidate_store import CandidateStore
from condyle.sampling.domain_run import DomainRun
from condyle.sampling.part_files import SAMPLE_SCHEMA, damaged, encode_part, read_part
from condyle.sampling.selection import DROPPED, SPLIT_NAMES
from condyle.whole_files import content_hash, write_whole

SAMPLES_FOLDER: Final = "samples"
PART_ROWS: Final = 8192


def write_sample_parts(
    directory: Path, design_hash: str, store: CandidateStore, runs: Sequence[DomainRun]
) -> list[dict[str, Any]]:
    """Select, split and write the samples of complete runs.

    Returns:
        The manifest's ``parts``: file, rows and sha256 of each.
    """
    parts: list[dict[str, Any]] = []
    for run in runs:
        domain = run.target.domain
        for number, table in enumerate(_of_rows(_sample_tables(run, store), PART_ROWS)):
            file = f"{SAMPLES_FOLDER}/domain-{domain}-part-{number:05d}.parquet"
            content = encode_part(table, {"design": design_hash, "domain": domain, "part": number})
            write_whole(directory / file, content)
            parts.append({"file": file, "rows": table.num_rows, "sha256": content_hash(content)})
    return parts


def check_sample_parts(directory: Path, manifest: Mapping[str, Any]) -> bool:
    """Whether all parts of a complete dataset are there.

    Raises:
        InputDataError: One is there and is not what the manifest says.
    """
    there = [
        directory / part["file"]
        for part in manifest["parts"]
        if (directory / part["file"]).exists()
    ]
    for part in manifest["parts"]:
        if directory / part["file"] in there:
            read_sample_part(directory, part)
    return len(there) == len(manifest["parts"])


def read_sample_part(directory: Path, part: Mapping[str, Any]) -> pa.Table:
    """A part of the manifest, its content checked against the manifest's hash.

    Raises:
        InputDataError: It is missing or damaged.
    """
    path = directory / part["file"]
    try:
        found = content_hash(path.read_bytes())
    except OSError as error:
        raise damaged(path, error.strerror) from error
    if found != part["sha256"]:
        raise damaged(path, "its SHA-256 is not the manifest's")
    return read_part(path)


def _sample_tables(run: DomainRun, store: CandidateStore) -> Iterator[pa.Table]:
    """The samples of each chunk, columns of SAMPLE_SCHEMA."""
    names = np.array(SPLIT_NAMES, dtype=object)
    splits = run.splits()
    for chunk in run.chunks:
        table = store.accepted(chunk)
        here, splits = np.split(splits, [table.num_rows])
        kept = here != DROPPED
        table = table.filter(pa.array(kept))
        extra = {
            "domain": pa.array(np.full(table.num_rows, run.target.domain), pa.int8()),
            "split": pa.array(names[here[kept]].tolist(), pa.string()),
        }
        columns = [
            extra.get(name, table[name] if name in table.column_names else None)
            for name in SAMPLE_SCHEMA.names
        ]
        yield pa.table(columns, schema=SAMPLE_SCHEMA)


def _of_rows(tables: Iterator[pa.Table], rows: int) -> Iterator[pa.Table]:
    """The same rows in tables of ``rows`` rows, the last one shorter; always at least one table."""
    held = SAMPLE_SCHEMA.empty_table()
    for table in tables:
        held = pa.concat_tables([held, table])
        while held.num_rows >= rows:
            yield held.slice(0, rows).combine_chunks()
            held = held.slice(rows)
    if held.num_rows:
        yield held.combine_chunks()
