# SPDX-License-Identifier: Apache-2.0
"""Load cases: reading them from CSV, degrees becoming radians here and nowhere else."""

from __future__ import annotations

import csv
import math
import os
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError

#: Columns of a load case file, in any order; further columns are passed over.
LOAD_CASE_COLUMNS: Final = ("time_s", "flexion_deg", "axial_force_N", "ap_force_N", "ie_torque_Nm")
#: Load cases that come with the package.
BUILT_IN: Final = (
    "iso_like_gait",
    "turn_like_gait",
    "leg_swing_like",
    "chair_rise_like",
    "squat_like",
)

_FOLDER: Final = Path(__file__).parent


@dataclass(frozen=True)
class LoadCase:
    """A load case over n time frames.

    Attributes:
        name: The built-in name, or the file's name without its ending.
        time: (n,) [s], strictly increasing.
        flexion: (n,) [rad].
        axial_force: (n,) [N] ≥ 0, pressing the femur onto the tibia.
        ap_force: (n,) [N] on the tibia, positive anterior.
        ie_torque: (n,) [Nm] on the tibia, positive inward (internal rotation).

    Raises:
        InputDataError: An array is not a vector, has another length than time, or holds a value that is not finite.
    """

    name: str
    time: NDArray[np.float64]
    flexion: NDArray[np.float64]
    axial_force: NDArray[np.float64]
    ap_force: NDArray[np.float64]
    ie_torque: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Every array becomes a contiguous float64 vector of one length."""
        for field in fields(self)[1:]:
            values = np.ascontiguousarray(getattr(self, field.name), dtype=np.float64)
            if values.ndim != 1 or len(values) != np.size(self.time):
                raise InputDataError(
                    f"load case '{self.name}': {field.name} has shape {values.shape}; "
                    f"({np.size(self.time)},) is needed, as time has"
                )
            bad = np.flatnonzero(~np.isfinite(values))
            if len(bad):
                raise InputDataError(
                    f"load case '{self.name}': {field.name} in row {bad[0]} is {values[bad[0]]}: must be finite"
                )
            object.__setattr__(self, field.name, values)

    def __len__(self) -> int:
        """Number of time frames."""
        return len(self.time)


def load_case_file(name_or_path: str | os.PathLike[str]) -> Path:
    """The CSV file of a built-in load case, or the path itself.

    Raises:
        InputDataError: Neither a built-in name nor a file.
    """
    if str(name_or_path) in BUILT_IN:
        return _FOLDER / f"{name_or_path}.csv"
    path = Path(name_or_path)
    if not path.is_file():
        raise InputDataError(
            f"activity '{name_or_path}': no such file, and not one of {', '.join(BUILT_IN)}"
        )
    return path


def load_case(name_or_path: str | os.PathLike[str]) -> LoadCase:
    """Reads a load case.

    Args:
        name_or_path: One of BUILT_IN, or a CSV file with the columns LOAD_CASE_COLUMNS; lines that
            begin with ``#`` are comments.

    Raises:
        InputDataError: The message names the file and, where they apply, line, column and value.
    """
    path = load_case_file(name_or_path)
    columns = _read_columns(path)
    time = columns["time_s"]
    late = np.flatnonzero(np.diff(time) <= 0.0)
    if len(late):
        row = int(late[0]) + 1
        raise InputDataError(
            f"{path}: time_s in row {row} is {time[row]}: must be above the row before"
        )
    low = np.flatnonzero(columns["axial_force_N"] < 0.0)
    if len(low):
        value = columns["axial_force_N"][low[0]]
        raise InputDataError(
            f"{path}: axial_force_N in row {low[0]} is {value}: must be at least 0 (compression is positive)"
        )
    flexion = columns["flexion_deg"]
    wide = np.flatnonzero((flexion < -34.0) | (flexion > 171.0))
    if len(wide):
        raise InputDataError(
            f"{path}: flexion_deg in row {wide[0]} is {flexion[wide[0]]}: must lie within -34 and 171 deg"
        )
    return LoadCase(
        path.stem,
        time,
        flexion * (math.pi / 180.0),
        columns["axial_force_N"],
        columns["ap_force_N"],
        columns["ie_torque_Nm"],
    )


def _read_columns(path: Path) -> dict[str, NDArray[np.float64]]:
    with path.open(encoding="utf-8", newline="") as file:
        try:
            numbered = [
                (number, line)
                for number, line in enumerate(file, start=1)
                if line.strip() and not line.lstrip().startswith("#")
            ]
        except UnicodeDecodeError as error:
            raise InputDataError(f"{path}: is not a text file") from error
    if not numbered:
        raise InputDataError(f"{path}: has no header line")
    rows = [[cell.strip() for cell in row] for row in csv.reader(line for _, line in numbered)]
    header = rows[0]
    for column in LOAD_CASE_COLUMNS:
        if header.count(column) != 1:
            what = "is missing" if column not in header else "appears twice"
            raise InputDataError(f"{path}: column {column} {what}; found {', '.join(header)}")
    if len(rows) == 1:
        raise InputDataError(f"{path}: has no rows")
    table = {}
    for column in LOAD_CASE_COLUMNS:
        position = header.index(column)
        values = np.empty(len(rows) - 1)
        for i, row in enumerate(rows[1:]):
            line = numbered[i + 1][0]
            if len(row) != len(header):
                raise InputDataError(
                    f"{path}: line {line} has {len(row)} values; the header has {len(header)}"
                )
            try:
                values[i] = float(row[position])
            except ValueError as error:
                raise InputDataError(
                    f"{path}: line {line}, column {column}: '{row[position]}' is not a number"
                ) from error
            if not math.isfinite(values[i]):
                raise InputDataError(
                    f"{path}: line {line}, column {column} is {row[position]}: must be finite"
                )
        table[column] = values
    return table
