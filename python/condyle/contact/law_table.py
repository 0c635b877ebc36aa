# SPDX-License-Identifier: Apache-2.0
"""A contact law measured point by point, from a CSV file."""

import csv
import math
from os import PathLike
from pathlib import Path

from condyle.contact.laws import TableLaw
from condyle.errors import InputDataError

#: Columns that a file may have, and what one of their unit is in SI.
_DEPTH = {"depth_m": 1.0, "depth_mm": 1e-3}
_PRESSURE = {"pressure_Pa": 1.0, "pressure_MPa": 1e6}


def read_table_law(file: str | PathLike[str]) -> TableLaw:
    """Reads a law from a CSV file: columns depth_mm and pressure_MPa, or depth_m and pressure_Pa.

    Lines that begin with '#' are passed over, as are other columns. The first point is (0, 0); depths rise strictly,
    pressures never fall.

    Raises:
        InputDataError: the file cannot be read or is no such table; the text names file, line, column and value.
    """
    file = Path(file)
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise InputDataError(f"{file}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputDataError(f"{file}: is not a text file") from None
    rows = [
        (number, [text.strip() for text in next(csv.reader([line]))])
        for number, line in enumerate(lines, 1)
        if line.strip() and not line.startswith("#")
    ]
    if not rows:
        raise InputDataError(f"{file}: is empty: columns depth_mm, pressure_MPa are needed")
    names = rows.pop(0)[1]
    columns = [_find(file, names, wanted) for wanted in (_DEPTH, _PRESSURE)]
    points = []
    for number, row in rows:
        if len(row) != len(names):
            raise InputDataError(
                f"{file}: line {number} has {len(row)} values: must be {len(names)}"
            )
        points.append([_number(file, number, names[i], row[i]) * scale for i, scale in columns])
    _require_order(file, [number for number, _ in rows], points)
    try:
        return TableLaw(depth=tuple(p[0] for p in points), pressure=tuple(p[1] for p in points))
    except InputDataError as error:
        raise InputDataError(f"{file}: {error}") from None


def _find(file: Path, names: list[str], wanted: dict[str, float]) -> tuple[int, float]:
    """Index and scale of the one column of a quantity."""
    found = [name for name in names if name in wanted]
    if len(found) != 1:
        raise InputDataError(
            f"{file}: must have one column {' or '.join(wanted)} (columns: {', '.join(names)})"
        )
    return names.index(found[0]), wanted[found[0]]


def _number(file: Path, line: int, column: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputDataError(
            f"{file}: line {line}, column '{column}': '{text}' is not a number"
        ) from None


def _require_order(file: Path, lines: list[int], points: list[list[float]]) -> None:
    """The law checks the same; here the line of the file is known."""
    for i, (line, (depth, pressure)) in enumerate(zip(lines, points, strict=True)):
        where = f"{file}: line {line}: depth {depth:g} m, pressure {pressure:g} Pa:"
        if not (math.isfinite(depth) and math.isfinite(pressure)):
            raise InputDataError(f"{where} must be finite")
        if i == 0 and (depth, pressure) != (0.0, 0.0):
            raise InputDataError(f"{where} the first point must be (0, 0)")
        if i > 0 and depth <= points[i - 1][0]:
            raise InputDataError(f"{where} depth must rise from line to line")
        if i > 0 and pressure < points[i - 1][1]:
            raise InputDataError(f"{where} pressure must not fall from line to line")
