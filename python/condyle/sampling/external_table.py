# SPDX-License-Identifier: Apache-2.0
"""Tables of poses and loads that another program wrote: CSV or Parquet, in its own units.

Columns, in any order, others ignored: x, y, z, theta_x, theta_y, theta_z; medial_Fx … medial_Mz,
lateral_Fx … lateral_Mz; if the file has them, domain (0 to 6) and split (train or test).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq
from numpy.typing import NDArray

from condyle.conventions import POSE_COLUMNS, WRENCH_COLUMNS
from condyle.errors import InputDataError
from condyle.sampling.domain import DOMAIN_NAMES

LENGTH_UNITS: Final = {"m": 1.0, "mm": 1e-3}
ANGLE_UNITS: Final = {"rad": 1.0, "deg": np.pi / 180}
FORCE_UNITS: Final = {"N": 1.0, "kN": 1e3}
MOMENT_UNITS: Final = {"Nm": 1.0, "Nmm": 1e-3}
SPLITS: Final = ("train", "test")


@dataclass(frozen=True)
class TableUnits:
    """Units of a file; the default is SI and radians.

    Attributes:
        length: ``m`` or ``mm``, of x, y, z.
        angle: ``rad`` or ``deg``.
        force: ``N`` or ``kN``.
        moment: ``Nm`` or ``Nmm``.
    """

    length: str = "m"
    angle: str = "rad"
    force: str = "N"
    moment: str = "Nm"

    def __post_init__(self) -> None:
        """Checks.

        Raises:
            InputDataError: A unit that is not known; the message names those that are.
        """
        for name, known in _UNITS_OF.items():
            value = getattr(self, name)
            if value not in known:
                raise InputDataError(
                    f"{name} unit is {value!r}; it must be one of {', '.join(known)}"
                )

    def factor(self, column: str) -> float:
        """From the file's unit of a column to SI."""
        return float(_UNITS_OF[_kind(column)][getattr(self, _kind(column))])

    def of(self, column: str) -> str:
        """The file's unit of a column."""
        return str(getattr(self, _kind(column)))

    def to_json(self) -> dict[str, str]:
        """For a manifest."""
        return {name: getattr(self, name) for name in _UNITS_OF}


@dataclass(frozen=True)
class ExternalTable:
    """A table, read and converted; rows in the file's order.

    Attributes:
        path: The file.
        poses: (n, 6) [m, rad].
        wrenches: (n, 2, 6) [N, Nm].
        domain: (n,) as the file says, 0 where it does not.
        split: (n,) as the file says; None if it does not.
    """

    path: Path
    poses: NDArray[np.float64]
    wrenches: NDArray[np.float64]
    domain: NDArray[np.int64]
    split: NDArray[np.str_] | None

    def row(self, index: int) -> str:
        """How a message calls a row."""
        return row_name(self.path, index)

    @classmethod
    def read(cls, path: Path, units: TableUnits) -> ExternalTable:
        """Read a file (``.parquet``, or anything else as CSV with a header line).

        Raises:
            InputDataError: It cannot be read, a column is missing, or a value is missing or no
                finite number; the message names file, column, row and value.
        """
        path = Path(path)
        table = _read(path)
        missing = [n for n in (*POSE_COLUMNS, *WRENCH_COLUMNS) if n not in table]
        if missing:
            found = ", ".join(list(table)[:20]) or "none"
            raise InputDataError(
                f"{path}: the column {missing[0]} is missing ({len(missing)} of "
                f"{len(POSE_COLUMNS) + len(WRENCH_COLUMNS)} are); its columns are {found}"
            )
        numbers = {
            name: units.factor(name) * _numbers(path, name, table[name])
            for name in (*POSE_COLUMNS, *WRENCH_COLUMNS)
        }
        count = len(numbers["x"])
        wrenches = np.column_stack([numbers[name] for name in WRENCH_COLUMNS])
        domain = np.zeros(count, dtype=np.int64)
        if "domain" in table:
            domain = _domains(path, _numbers(path, "domain", table["domain"]))
        return cls(
            path,
            np.column_stack([numbers[name] for name in POSE_COLUMNS]),
            wrenches.reshape(count, 2, -1),
            domain,
            _splits(path, table["split"]) if "split" in table else None,
        )


_UNITS_OF: Final[Mapping[str, Mapping[str, float]]] = {
    "length": LENGTH_UNITS,
    "angle": ANGLE_UNITS,
    "force": FORCE_UNITS,
    "moment": MOMENT_UNITS,
}


def row_name(path: Path, index: int) -> str:
    """A row for a message: the line of a CSV file, else the row, counted from 0."""
    return f"row {index}" if _is_parquet(path) else f"line {index + 2}"


def _kind(column: str) -> str:
    if column in POSE_COLUMNS:
        return "angle" if column.startswith("theta") else "length"
    return "force" if "_F" in column else "moment"


def _is_parquet(path: Path) -> bool:
    return path.suffix.lower() in (".parquet", ".pq")


def _read(path: Path) -> dict[str, pa.ChunkedArray]:
    """The columns by name, names stripped of blanks."""
    try:
        if _is_parquet(path):
            with pq.ParquetFile(path) as file:
                table = file.read(use_threads=False)
        else:
            table = pyarrow.csv.read_csv(
                path,
                convert_options=pyarrow.csv.ConvertOptions(strings_can_be_null=True),
            )
    except (OSError, pa.ArrowException) as error:
        reason = str(error).splitlines()[0]
        form = "Parquet" if _is_parquet(path) else "CSV"
        raise InputDataError(f"{path}: cannot be read as {form}: {reason}") from error
    names = [name.strip() for name in table.column_names]
    if len(names) == 1 and ";" in names[0]:
        raise InputDataError(f"{path}: its header is separated by semicolons; commas are needed")
    for name in names:
        if names.count(name) > 1:
            raise InputDataError(f"{path}: the column {name} is there {names.count(name)} times")
    return dict(zip(names, table.columns, strict=True))


def _numbers(path: Path, name: str, column: pa.ChunkedArray) -> NDArray[np.float64]:
    """A column as finite numbers (n,)."""
    kind = column.type
    if not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
        # A single word makes a column of a CSV file one of text.
        values = np.empty(len(column))
        for index, text in enumerate(column.to_pylist()):
            try:
                values[index] = float(text)
            except (TypeError, ValueError):
                shown = "empty" if text is None else repr(text)
                raise InputDataError(
                    f"{path}, {row_name(path, index)}: {name} is {shown}; a number is needed"
                ) from None
    else:
        values = column.cast(pa.float64()).fill_null(np.nan).to_numpy()
    bad = ~np.isfinite(values)
    if bad.any():
        index = int(np.argmax(bad))
        shown = "empty" if column[index].as_py() is None else str(values[index])
        raise InputDataError(
            f"{path}, {row_name(path, index)}: {name} is {shown}; a finite number is needed "
            f"({int(bad.sum())} of {len(values)} rows have none)"
        )
    return np.asarray(values, dtype=np.float64)


def _domains(path: Path, values: NDArray[np.float64]) -> NDArray[np.int64]:
    bad = ~np.isin(values, (0, *DOMAIN_NAMES))
    if bad.any():
        index = int(np.argmax(bad))
        raise InputDataError(
            f"{path}, {row_name(path, index)}: domain is {values[index]:g}; it must be 1 to 6 as in "
            "Condyle's own datasets, or 0 for none of them"
        )
    return values.astype(np.int64)


def _splits(path: Path, column: pa.ChunkedArray) -> NDArray[np.str_]:
    values = column.to_pylist()
    for index, value in enumerate(values):
        if value not in SPLITS:
            raise InputDataError(
                f"{path}, {row_name(path, index)}: split is {value!r}; it must be 'train' or 'test'"
            )
    for name in SPLITS:
        if name not in values:
            raise InputDataError(f"{path}: no row has split = {name!r}; both are needed")
    return np.array(values, dtype=np.str_)
