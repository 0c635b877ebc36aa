# SPDX-License-Identifier: Apache-2.0
"""Reading a dataset of samples: arrays for training, candidates for a map of rejections.

The files need no Condyle: ``pandas.read_parquet("DIRECTORY/samples")`` gives the same rows, units
in manifest.json.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from condyle.conventions import POSE_COLUMNS
from condyle.errors import InputDataError
from condyle.sampling.candidate_store import CANDIDATES_FOLDER
from condyle.sampling.equilibrium_protocol import GIVEN_COLUMNS, PRESCRIBED_COLUMNS
from condyle.sampling.manifest import MANIFEST_NAME, check_same, read_manifest
from condyle.sampling.part_files import (
    PRESCRIBED_LOADS,
    columns_array,
    damaged,
    read_part,
    read_part_record,
    wrench_array,
)
from condyle.sampling.sample_parts import read_sample_part


@dataclass(frozen=True)
class Dataset:
    """The samples of a dataset, in candidate order, domain by domain.

    Attributes:
        poses: (n, 6) [m, rad].
        wrenches: (n, 2, 6) on the femur at Fo, expressed in T, sides (medial, lateral) [N, Nm].
        domain: (n,) the paper's numbers.
        split: (n,) ``train`` or ``test``.
        candidate: (n,) ids.
        source: (n,) the candidate whose hash decided the split: of a raised copy, its point's.
        two_sided: (n,) whether both sides carry Fy > 0.
        prescribed_loads: (n, 2) the total Fy [N] and Mx [Nm] that were asked for, NaN where θx or
            the pose was.
        max_depth: (n,) greatest penetration [m], NaN where the solver did not say.
        evaluations: (n,) contact evaluations spent on the sample.
        manifest: The manifest.
    """

    poses: NDArray[np.float64]
    wrenches: NDArray[np.float64]
    domain: NDArray[np.int64]
    split: NDArray[np.str_]
    candidate: NDArray[np.uint64]
    source: NDArray[np.uint64]
    two_sided: NDArray[np.bool_]
    prescribed_loads: NDArray[np.float64]
    max_depth: NDArray[np.float64]
    evaluations: NDArray[np.int64]
    manifest: Mapping[str, Any]

    def __len__(self) -> int:
        """Samples."""
        return len(self.poses)

    @classmethod
    def read(cls, directory: Path, *, identity: Mapping[str, Any] | None = None) -> Self:
        """Read a complete dataset, every part checked against the manifest.

        Args:
            directory: The dataset's.
            identity: When given, what the manifest's identity must say in these fields.

        Raises:
            InputDataError: Not a dataset, not complete, of something else, or a part is missing or
                damaged.
        """
        directory = Path(directory)
        manifest = read_manifest(directory)
        path = directory / MANIFEST_NAME
        if not manifest["complete"]:
            raise InputDataError(
                f"{path}: sampling is not complete; sample into {directory} again to finish it"
            )
        for name, value in (identity or {}).items():
            found = manifest["identity"].get(name)
            check_same(
                path, f"identity.{name}", found, value, "these are samples of something else"
            )
        table = pa.concat_tables(read_sample_part(directory, part) for part in manifest["parts"])
        return cls(
            poses=columns_array(table, POSE_COLUMNS),
            wrenches=wrench_array(table),
            domain=table.column("domain").to_numpy().astype(np.int64),
            split=np.array(table.column("split").to_pylist(), dtype=np.str_),
            candidate=table.column("candidate").to_numpy(),
            source=table.column("source").to_numpy(),
            two_sided=table.column("two_sided").to_numpy(),
            prescribed_loads=columns_array(table, PRESCRIBED_LOADS),
            max_depth=table.column("max_depth").to_numpy(),
            evaluations=table.column("evaluations").to_numpy().astype(np.int64),
            manifest=manifest,
        )

    def select(
        self, *, split: Literal["train", "test"] | None = None, domain: int | None = None
    ) -> Self:
        """The samples of a split, a domain or both."""
        rows = np.ones(len(self), dtype=bool)
        if split is not None:
            rows &= self.split == split
        if domain is not None:
            rows &= self.domain == domain
        arrays = {name: value[rows] for name, value in vars(self).items() if name != "manifest"}
        return type(self)(**arrays, manifest=self.manifest)


@dataclass(frozen=True)
class Candidates:
    """All candidates of one domain, accepted or not, the pilot left out.

    Attributes:
        prescribed: (n, 6), columns PRESCRIBED_COLUMNS; NaN where y or θx was prescribed instead.
        sensitive: (n, 2), columns SENSITIVE_COLUMNS (y [m], θx [rad]); NaN where it was solved for.
        status: (n,) ``accepted`` or the reason of the rejection.
        candidate: (n,) ids.
    """

    prescribed: NDArray[np.float64]
    sensitive: NDArray[np.float64]
    status: NDArray[np.str_]
    candidate: NDArray[np.uint64]


def read_candidates(directory: Path, domain: int) -> Candidates:
    """The candidates of a domain, for a map of where they are rejected.

    Raises:
        InputDataError: Not a dataset, no candidates of this domain, or a part is damaged.
    """
    directory = Path(directory)
    manifest = read_manifest(directory)
    if "design_hash" not in manifest:
        raise InputDataError(f"{directory}: its samples were imported, without candidates")
    design_hash = manifest["design_hash"]
    folder = directory / CANDIDATES_FOLDER / f"domain-{domain}"
    paths = [
        path
        for path in sorted(folder.glob("round-*/part-*.parquet"))
        if path.parent.name != "round-00"
    ]
    if not paths:
        raise InputDataError(f"{folder} holds no evaluated candidates")
    names = tuple(f"prescribed_{name}" for name in GIVEN_COLUMNS)
    for path in paths:
        found = read_part_record(path).get("design")
        if found != design_hash:
            raise damaged(path, f"its design is {found!r}, {design_hash!r} belongs here")
    table = pa.concat_tables(read_part(path, ["candidate", "status", *names]) for path in paths)
    given = columns_array(table, names)
    return Candidates(
        prescribed=given[:, : len(PRESCRIBED_COLUMNS)],
        sensitive=given[:, len(PRESCRIBED_COLUMNS) :],
        status=np.array(table.column("status").to_pylist(), dtype=np.str_),
        candidate=table.column("candidate").to_numpy(),
    )
