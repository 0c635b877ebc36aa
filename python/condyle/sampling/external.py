# SPDX-License-Identifier: Apache-2.0
"""Samples from elsewhere: a table of poses and loads becomes a dataset like Condyle's own.

Use it to train a surrogate of a contact model that Condyle cannot run (finite elements, elastic
foundation, an experiment). The dataset has no sampling plan, no curves and no candidates; its
manifest says instead, under ``provenance``, which file it came from (name, SHA-256), whose it is
(the user's words), which units it was converted from and how it was split.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from condyle.conventions import POSE_COLUMNS, WRENCH_COLUMNS, SideOfBody
from condyle.errors import InputDataError
from condyle.sampling.external_checks import check_external
from condyle.sampling.external_table import ExternalTable, TableUnits
from condyle.sampling.manifest import MANIFEST_NAME, external_manifest, read_manifest
from condyle.sampling.part_files import PRESCRIBED_LOADS, SAMPLE_SCHEMA, encode_part
from condyle.sampling.sample_parts import PART_ROWS, SAMPLES_FOLDER, check_sample_parts
from condyle.sampling.selection import SPLIT_NAMES, TEST, assign_splits, candidate_ids
from condyle.whole_files import content_hash, to_canonical_json, write_whole

#: Share of the rows that the keyed hash gives to the test split: the paper's 85 : 15.
TEST_SHARE: Final = 0.15
_PART_NAME: Final = "imported-part-"
_FY: Final = 1


@dataclass(frozen=True)
class ImportReport:
    """What was imported.

    Attributes:
        train: Samples for training.
        test: Samples for testing.
        loaded: (medial, lateral) samples with Fy > 0 on the side.
        pulling: (medial, lateral) samples with Fy < 0, which a surrogate takes for lifted off.
        pose_range: (2, 6) least and greatest pose [m, rad].
        unchanged: Whether the directory held this very import already.
    """

    train: int
    test: int
    loaded: tuple[int, int]
    pulling: tuple[int, int]
    pose_range: NDArray[np.float64]
    unchanged: bool


def import_samples(
    file: Path,
    directory: Path,
    *,
    source: str,
    side_of_body: SideOfBody,
    units: TableUnits | None = None,
    seed: int = 0,
    test_share: float = TEST_SHARE,
) -> ImportReport:
    """Import a CSV or Parquet table as a dataset.

    Args:
        file: See :mod:`condyle.sampling.external_table`.
        directory: For the dataset: new or empty, or this import's own.
        source: Where the samples are from, in words: program, model, author.
        side_of_body: ``left`` or ``right``.
        units: The file's; SI if not given.
        seed: Keys the hash of the rows' numbers that splits them; not used where the file has a
            column ``split``.
        test_share: Share of rows for testing, likewise.

    Raises:
        InputDataError: The file cannot be used (see :mod:`condyle.sampling.external_checks`), a
            setting is out of its limits, or the directory holds something else.
    """
    file, directory = Path(file), Path(directory)
    units = units or TableUnits()
    _check_settings(source, side_of_body, seed, test_share)
    table = ExternalTable.read(file, units)
    check_external(table, units, side_of_body)
    train, split = _split(table, seed, test_share)
    manifest = external_manifest(
        {
            "kind": "imported",
            "file": file.name,
            "sha256": content_hash(file.read_bytes()),
            "source": source,
            "units": units.to_json(),
            "split": split,
            "rows": len(table.poses),
        },
        side_of_body,
        _domain_entries(table.domain, train),
    )
    unchanged = _is_there(directory, manifest)
    if not unchanged:
        _write(directory, manifest, _samples(table, train))
    Fy = table.wrenches[:, :, _FY]
    return ImportReport(
        train=int(train.sum()),
        test=int((~train).sum()),
        loaded=_both_sides(Fy > 0),
        pulling=_both_sides(Fy < 0),
        pose_range=np.array([table.poses.min(axis=0), table.poses.max(axis=0)]),
        unchanged=unchanged,
    )


def _both_sides(flags: NDArray[np.bool_]) -> tuple[int, int]:
    medial, lateral = flags.sum(axis=0).tolist()
    return medial, lateral


def _check_settings(source: str, side_of_body: str, seed: int, test_share: float) -> None:
    if not source.strip():
        raise InputDataError("source is empty; say where the samples are from")
    if side_of_body not in ("left", "right"):
        raise InputDataError(f"side_of_body is {side_of_body!r}; it must be 'left' or 'right'")
    if not 0 <= seed < 2**63:
        raise InputDataError(f"seed is {seed}; it must be 0 to {2**63 - 1}")
    if not 0.01 <= test_share <= 0.9:
        raise InputDataError(f"test_share is {test_share!r}; it must be 0.01 to 0.9")


def _split(
    table: ExternalTable, seed: int, test_share: float
) -> tuple[NDArray[np.bool_], dict[str, Any]]:
    """Whether each row is for training, and who said so."""
    if table.split is not None:
        return np.asarray(table.split == "train"), {"by": "column split of the file"}
    rows = len(table.poses)
    test = max(1, round(test_share * rows))
    splits = assign_splits(candidate_ids(0, 0, 0, rows), seed=seed, train=rows - test, test=test)
    return splits != TEST, {"by": "keyed hash", "seed": seed, "test_share": test_share}


def _samples(table: ExternalTable, train: NDArray[np.bool_]) -> pa.Table:
    """Columns of SAMPLE_SCHEMA; a candidate's id is its row in the file, from 0."""
    rows = len(table.poses)
    ids = candidate_ids(0, 0, 0, rows)
    test_name, train_name = SPLIT_NAMES[TEST], "train"
    unknown = np.full(rows, np.nan)
    columns: dict[str, Any] = {
        "candidate": ids,
        "domain": table.domain.astype(np.int8),
        "split": [train_name if chosen else test_name for chosen in train],
        **dict.fromkeys((*PRESCRIBED_LOADS, "max_depth"), unknown),
        **dict(zip(POSE_COLUMNS, table.poses.T, strict=True)),
        **dict(zip(WRENCH_COLUMNS, table.wrenches.reshape(rows, -1).T, strict=True)),
        "evaluations": np.zeros(rows, dtype=np.int32),
        "source": ids,
        "two_sided": np.all(table.wrenches[:, :, _FY] > 0, axis=1),
    }
    return pa.table([pa.array(columns[n]) for n in SAMPLE_SCHEMA.names], schema=SAMPLE_SCHEMA)


def _domain_entries(domain: NDArray[np.int64], train: NDArray[np.bool_]) -> list[dict[str, Any]]:
    return [
        {
            "domain": int(number),
            "train": int((train & (domain == number)).sum()),
            "test": int((~train & (domain == number)).sum()),
        }
        for number in np.unique(domain)
    ]


def _is_there(directory: Path, wanted: Mapping[str, Any]) -> bool:
    """Whether a directory holds this import, whole; what a killed import has left is no dataset."""
    path = directory / MANIFEST_NAME
    if not path.exists():
        others = sorted(p for p in directory.rglob("*") if p.is_file() and not _is_part(p))
        if others:
            raise InputDataError(
                f"{directory} holds {others[0].relative_to(directory)} and no {MANIFEST_NAME}; "
                "import into a new or empty directory"
            )
        return False
    found = read_manifest(directory)
    if any(found.get(name) != wanted[name] for name in ("provenance", "identity", "domains")):
        raise InputDataError(
            f"{path}: the directory holds other samples; import into another directory or remove it"
        )
    return check_sample_parts(directory, found)


def _is_part(path: Path) -> bool:
    return path.parent.name == SAMPLES_FOLDER and path.name.startswith(_PART_NAME)


def _write(directory: Path, manifest: dict[str, Any], samples: pa.Table) -> None:
    """Parts first, the manifest last: who is killed leaves no dataset."""
    for leftover in (directory / SAMPLES_FOLDER).glob("*"):
        leftover.unlink()
    parts = []
    for number, start in enumerate(range(0, samples.num_rows, PART_ROWS)):
        part = samples.slice(start, PART_ROWS).combine_chunks()
        name = f"{SAMPLES_FOLDER}/{_PART_NAME}{number:05d}.parquet"
        content = encode_part(part, {"imported": manifest["provenance"]["sha256"], "part": number})
        write_whole(directory / name, content)
        parts.append({"file": name, "rows": part.num_rows, "sha256": content_hash(content)})
    whole = {**manifest, "parts": parts, "complete": True}
    write_whole(directory / MANIFEST_NAME, (to_canonical_json(whole) + "\n").encode())
