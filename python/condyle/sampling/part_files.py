# SPDX-License-Identifier: Apache-2.0
"""Parquet parts: named columns with units, and a record of what they hold.

Their bytes depend on that alone. There are two kinds (schemas below):

- candidate parts: every candidate of a chunk, accepted or not, with its status; a run's store;
- sample parts: the kept samples, with their domain and split; what a user reads.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, POSE_COLUMNS, WRENCH_COLUMNS
from condyle.errors import InputDataError
from condyle.sampling.equilibrium_protocol import GIVEN_COLUMNS

#: Column → unit; what is not here is a number, name or id.
UNITS: Final = {
    **dict.fromkeys(("x", "y", "z", "max_depth"), "m"),
    **dict.fromkeys(("theta_x", "theta_y", "theta_z"), "rad"),
    **{name: unit for name, unit in zip(WRENCH_COLUMNS, LOAD_UNITS * 2, strict=True)},
    **{
        f"prescribed_{name}": ("m" if name in ("x", "y", "z") else "rad")
        if name in POSE_COLUMNS
        else LOAD_UNITS[LOAD_COLUMNS.index(name)]
        for name in GIVEN_COLUMNS
    },
}
#: The loads that an equilibrium was asked for; the pose columns hold the rest of what was
#: prescribed.
PRESCRIBED_LOADS: Final = ("prescribed_Fy", "prescribed_Mx")
_METADATA_KEY: Final = b"condyle"


def _schema(columns: Mapping[str, pa.DataType]) -> pa.Schema:
    return pa.schema(
        [
            pa.field(
                name,
                kind,
                nullable=False,
                metadata={"unit": UNITS[name]} if name in UNITS else None,
            )
            for name, kind in columns.items()
        ]
    )


_SOLVED = {
    **dict.fromkeys((*POSE_COLUMNS, *WRENCH_COLUMNS, "max_depth"), pa.float64()),
    "evaluations": pa.int32(),
}
#: ``source``: the candidate whose hash decides the split; another one's for a raised copy of it.
#: ``two_sided``: both sides carry Fy > 0.
_FLAGS = {"source": pa.uint64(), "two_sided": pa.bool_()}
CANDIDATE_SCHEMA: Final = _schema(
    {
        "candidate": pa.uint64(),
        "status": pa.string(),
        **{f"prescribed_{name}": pa.float64() for name in GIVEN_COLUMNS},
        **_SOLVED,
        **_FLAGS,
    }
)
SAMPLE_SCHEMA: Final = _schema(
    {
        "candidate": pa.uint64(),
        "domain": pa.int8(),
        "split": pa.string(),
        **dict.fromkeys(PRESCRIBED_LOADS, pa.float64()),
        **_SOLVED,
        **_FLAGS,
    }
)


def encode_part(table: pa.Table, record: Mapping[str, Any]) -> bytes:
    """The bytes of a part file.

    Args:
        table: Columns of one of the schemas.
        record: What the part holds, JSON values; kept in the file's metadata.
    """
    text = json.dumps(record, sort_keys=True, separators=(",", ":"))
    buffer = io.BytesIO()
    pq.write_table(
        table.replace_schema_metadata({_METADATA_KEY: text.encode()}),
        buffer,
        compression="zstd",
        # Readers notice a damaged page, not only a missing end.
        write_page_checksum=True,
    )
    return buffer.getvalue()


def read_part_record(path: Path) -> dict[str, Any]:
    """The record of a part file, from its footer alone.

    Raises:
        InputDataError: The file is damaged or not a part.
    """
    try:
        metadata = pq.read_metadata(path).metadata or {}
        record: dict[str, Any] = json.loads(metadata[_METADATA_KEY])
    except (OSError, pa.ArrowException, KeyError, ValueError) as error:
        raise damaged(path, error) from error
    return record


def read_part(path: Path, columns: list[str] | None = None) -> pa.Table:
    """The table of a part file, or some of its columns.

    Raises:
        InputDataError: The file is damaged or not a part.
    """
    try:
        # Not pq.read_table: it takes a folder's name ("domain=2") for a column.
        with pq.ParquetFile(path, page_checksum_verification=True) as file:
            return file.read(columns=columns, use_threads=False)
    except (OSError, pa.ArrowException, KeyError) as error:
        raise damaged(path, error) from error


def damaged(path: Path, why: object) -> InputDataError:
    """The error for a part that cannot be used."""
    reason = str(why).splitlines()[0] if str(why) else type(why).__name__
    return InputDataError(
        f"{path} is damaged or not a part of this dataset ({reason}); "
        "remove this file and sample again: only its own rows are computed anew"
    )


def wrench_array(table: pa.Table) -> np.ndarray[Any, np.dtype[np.float64]]:
    """The wrench columns as (n, 2, 6)."""
    return columns_array(table, WRENCH_COLUMNS).reshape(-1, 2, len(LOAD_COLUMNS))


def columns_array(table: pa.Table, names: tuple[str, ...]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Some float columns as (n, len(names))."""
    return np.column_stack([table.column(name).to_numpy() for name in names]).astype(np.float64)
