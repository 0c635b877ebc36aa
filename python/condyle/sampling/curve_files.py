# SPDX-License-Identifier: Apache-2.0
"""Reference curves in files: a CSV table of several activities, or an OpenSim STO or MOT table of one.

Columns: ``time`` [s], x, y, z [m], theta_x, theta_y, theta_z [rad], Fy [N], Mx [Nm]: the pose, and the
total contact load on the femur at Fo, expressed in T. Further columns are ignored. In a CSV file
``activity`` may name the activity of each row; otherwise the file's name does. In an STO or MOT file
the header's ``inDegrees=yes`` makes the three angles degrees.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from condyle.errors import InputDataError
from condyle.sampling.reference_curves import CURVE_COLUMNS, ReferenceCurve, ReferenceCurves

_NEEDED: Final = ("time", *CURVE_COLUMNS)
_END_OF_HEADER: Final = "endheader"


def read_table(path: Path) -> ReferenceCurves:
    """The reference curves of one file, by its ending: .csv, .sto or .mot.

    Raises:
        InputDataError: Another ending, a file that cannot be read, a column that is missing, or a
            value that is no number or out of range; the message names file, column, line or time
            frame and value.
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputDataError(
            f"{path}: a table of reference curves must end in {', '.join(_READERS)}"
        )
    try:
        # Every line end ends a line, also those of other systems.
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputDataError(
            f"{path}: cannot be read as a table of reference curves: {error}"
        ) from error
    tables = reader(path, lines)
    try:
        return ReferenceCurves(
            tuple(
                ReferenceCurve(name, np.array(rows)[:, 0], np.array(rows)[:, 1:])
                for name, rows in tables.items()
            )
        )
    except InputDataError as error:
        raise InputDataError(f"{path}: {error}") from error


def read_tables(paths: Sequence[Path]) -> ReferenceCurves:
    """The reference curves of several files together.

    Raises:
        InputDataError: As :func:`read_table`, or two files hold an activity of one name.
    """
    return ReferenceCurves(tuple(curve for path in paths for curve in read_table(path).curves))


def write_csv(curves: ReferenceCurves, path: Path) -> None:
    """Write the CSV table that :func:`read_table` reads, with every digit."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("activity", *_NEEDED))
        for curve in curves.curves:
            for time, values in zip(curve.time, curve.values, strict=True):
                writer.writerow(
                    (curve.name, repr(float(time)), *(repr(float(value)) for value in values))
                )


def _read_csv(path: Path, lines: list[str]) -> dict[str, list[list[float]]]:
    try:
        rows = list(csv.DictReader(lines, skipinitialspace=True))
    except csv.Error as error:
        raise InputDataError(
            f"{path}: cannot be read as a table of reference curves: {error}"
        ) from error
    if not rows:
        raise InputDataError(f"{path}: holds no rows of reference curves")
    _check_columns(path, list(rows[0]))
    by_activity: dict[str, list[list[float]]] = {}
    for line, row in enumerate(rows, start=2):
        name = (row.get("activity") or path.stem).strip()
        by_activity.setdefault(name, []).append(_numbers(path, line, row))
    return by_activity


def _read_storage(path: Path, lines: list[str]) -> dict[str, list[list[float]]]:
    """An OpenSim storage table: a header of ``key=value`` lines to ``endheader``, labels, rows."""
    ends = [i for i, line in enumerate(lines) if line.strip().lower() == _END_OF_HEADER]
    if not ends or ends[0] + 1 >= len(lines):
        raise InputDataError(
            f"{path}: no line '{_END_OF_HEADER}' with column labels below it: is it an OpenSim table?"
        )
    header: dict[str, str] = {}
    for line in lines[: ends[0]]:
        key, _, value = line.partition("=")
        header[key.strip().lower()] = value.strip().lower()
    labels = lines[ends[0] + 1].split()
    _check_columns(path, labels)
    rows = []
    for number, line in enumerate(lines[ends[0] + 2 :], start=ends[0] + 3):
        cells = line.split()
        if not cells:
            continue
        if len(cells) != len(labels):
            raise InputDataError(
                f"{path}, line {number}: {len(cells)} values; {len(labels)} columns are labelled"
            )
        rows.append(_numbers(path, number, dict(zip(labels, cells, strict=True))))
    _check_size(path, header, "nrows", len(rows))
    _check_size(path, header, "ncolumns", len(labels))
    if not rows:
        raise InputDataError(f"{path}: holds no rows of reference curves")
    if _in_degrees(path, header):
        angles = [_NEEDED.index(name) for name in _NEEDED if name.startswith("theta")]
        for row in rows:
            for i in angles:
                row[i] = math.radians(row[i])
    return {path.stem: rows}


def _check_size(path: Path, header: Mapping[str, str], key: str, found: int) -> None:
    """A header that counts otherwise than the table is a table cut off, or put together by hand."""
    told = header.get(key)
    if told is not None and told != str(found):
        raise InputDataError(f"{path}: the header says {key} = {told}; the table has {found}")


def _in_degrees(path: Path, header: Mapping[str, str]) -> bool:
    told = header.get("indegrees")
    if told not in ("yes", "no"):
        raise InputDataError(
            f"{path}: the header says inDegrees = {told}; yes or no is needed, or the angles' unit is a guess"
        )
    return told == "yes"


def _check_columns(path: Path, found: Sequence[str]) -> None:
    for name in _NEEDED:
        if list(found).count(name) != 1:
            what = "is there twice" if name in found else "is missing"
            raise InputDataError(
                f"{path}: the column {name} {what}; needed are {', '.join(_NEEDED)}"
            )


def _numbers(path: Path, line: int, row: Mapping[str, str | None]) -> list[float]:
    numbers = []
    for name in _NEEDED:
        text = row[name]
        try:
            numbers.append(float(text or ""))
        except ValueError:
            raise InputDataError(
                f"{path}, line {line}: {name} is {text!r}; a number is needed"
            ) from None
    return numbers


_READERS: Final[dict[str, Callable[[Path, list[str]], dict[str, list[list[float]]]]]] = {
    ".csv": _read_csv,
    ".sto": _read_storage,
    ".mot": _read_storage,
}
