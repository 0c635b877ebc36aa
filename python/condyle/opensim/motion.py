# SPDX-License-Identifier: Apache-2.0
"""Tables over time: STO and MOT of OpenSim, CSV; written as STO in radians."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from condyle.errors import InputDataError
from condyle.whole_files import write_whole

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """Columns over time.

    Attributes:
        source: The file, for messages.
        times: (n) [s], ascending.
        names: Labels of the m columns; of /jointset/…/NAME/value only NAME is kept.
        values: (n, m), as in the file.
        in_degrees: Whether rotational columns are in degrees.
    """

    source: str
    times: Array
    names: tuple[str, ...]
    values: Array
    in_degrees: bool = False


def read_motion(file: Path) -> Motion:
    """Reads .sto, .mot (their header says degrees or not) or .csv (SI, radians; first column time).

    Raises:
        InputDataError: No such file, no column time, a row with another number of cells, a cell
            that is no finite number, times that do not ascend.
    """
    try:
        lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise InputDataError(f"{file}: cannot be read: {error.strerror or error}") from error
    in_degrees, first = False, 0
    if file.suffix.lower() != ".csv":
        in_degrees, first = _read_header(file, lines)
        rows = [(i + 1, line.split()) for i, line in enumerate(lines) if i >= first]
    else:
        rows = [(i + 1, row) for i, row in enumerate(csv.reader(lines))]
    rows = [(number, row) for number, row in rows if row]
    if len(rows) < 2 or rows[0][1][0].lower() != "time":
        raise InputDataError(f"{file}: no table with a first column 'time' and a row below it")
    names = tuple(_coordinate_name(label) for label in rows[0][1])
    values = np.array([_numbers(file, number, row, names) for number, row in rows[1:]])
    late = np.flatnonzero(np.diff(values[:, 0]) <= 0)
    if late.size:
        line = rows[int(late[0]) + 2][0]
        raise InputDataError(f"{file}: line {line}: time does not ascend")
    return Motion(str(file), values[:, 0], names[1:], values[:, 1:], in_degrees)


def write_sto(
    file: Path, title: str, notes: Sequence[str], times: Array, names: Sequence[str], values: Array
) -> None:
    """Writes a .sto in SI and radians, numbers to 15 digits (values are (n, m)).

    Args:
        file: To write.
        title: First line.
        notes: Lines of the header, for people.
        times: (n) [s].
        names: m labels.
        values: (n, m).
    """
    head = [title, "version=1", f"nRows={len(times)}", f"nColumns={len(names) + 1}", "inDegrees=no"]
    body = ["\t".join(["time", *names])]
    for time, row in zip(times, values, strict=True):
        body.append("\t".join(f"{value:.15g}" for value in (time, *row)))
    write_whole(file, "\n".join([*head, "", *notes, "", "endheader", *body]) + "\n")


def _read_header(file: Path, lines: list[str]) -> tuple[bool, int]:
    in_degrees = False
    for i, line in enumerate(lines):
        key, _, value = line.strip().lower().partition("=")
        if key == "indegrees":
            in_degrees = value.strip() in ("yes", "true", "1")
        if key == "endheader":
            return in_degrees, i + 1
    raise InputDataError(
        f"{file}: no line 'endheader': not a .sto or .mot (a .csv must end in .csv)"
    )


def _coordinate_name(label: str) -> str:
    parts = label.strip().split("/")
    return parts[-2] if len(parts) > 2 and parts[-1] == "value" else label.strip()


def _numbers(file: Path, line: int, row: list[str], names: Sequence[str]) -> list[float]:
    if len(row) != len(names):
        raise InputDataError(f"{file}: line {line}: {len(row)} cells, must be {len(names)}")
    numbers = []
    for name, cell in zip(names, row, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = float("nan")
        if not np.isfinite(number):
            raise InputDataError(
                f"{file}: line {line}, column {name}: '{cell}' is not a finite number"
            )
        numbers.append(number)
    return numbers
