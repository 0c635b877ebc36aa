# SPDX-License-Identifier: Apache-2.0
"""Marker trajectories from TRC and C3D files, in metres and in the model's axes."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from condyle.errors import InputDataError

Array = npt.NDArray[np.float64]

_METRES: Final = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}


@dataclass(frozen=True)
class Markers:
    """Markers over time.

    Attributes:
        source: The file, for messages.
        times: (T) [s].
        names: n labels.
        positions: (T, n, 3) [m]; NaN where a marker is missing.
    """

    source: str
    times: Array
    names: tuple[str, ...]
    positions: Array

    def between(self, start: float | None, end: float | None) -> Markers:
        """The time frames from ``start`` to ``end`` [s], both included.

        Raises:
            InputDataError: No time frame is left.
        """
        # A file's times are rounded; half a microsecond is less than any step.
        keep = np.ones(len(self.times), dtype=bool)
        keep &= self.times >= (-np.inf if start is None else start - 5e-7)
        keep &= self.times <= (np.inf if end is None else end + 5e-7)
        if not keep.any():
            raise InputDataError(
                f"{self.source}: no time frame from {start} to {end} s: it holds "
                f"{self.times[0]:g} to {self.times[-1]:g} s"
            )
        return Markers(self.source, self.times[keep], self.names, self.positions[keep])


def read_markers(file: Path, axes: str = "x,y,z") -> Markers:
    """Reads a .trc or .c3d file; a marker that is blank, or at exactly 0 0 0, is missing.

    Args:
        file: Markers.
        axes: What the model's x, y and z are in the file's axes: ``x,z,-y`` for a laboratory whose z
            is up (its y then points to the subject's left where x is forward).

    Raises:
        InputDataError: A file that cannot be read or is neither, or axes that are no rotation.
    """
    readers = {".trc": _read_trc, ".c3d": _read_c3d}
    if file.suffix.lower() not in readers:
        raise InputDataError(f"{file}: markers are read from .trc and .c3d files")
    if not file.is_file():
        raise InputDataError(f"{file}: no such file")
    times, names, positions = readers[file.suffix.lower()](file)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputDataError(f"{file}: marker {', '.join(twice)} is there more than once")
    if not len(times):
        raise InputDataError(f"{file}: no time frames")
    positions[np.all(positions == 0.0, axis=2)] = np.nan
    positions[~np.all(np.isfinite(positions), axis=2)] = np.nan
    return Markers(str(file), times, tuple(names), positions @ _rotation(axes).T)


def _rotation(axes: str) -> Array:
    R, parts = np.zeros((3, 3)), [part.strip().lower() for part in axes.split(",")]
    for row, part in enumerate(parts[:3]):
        letter = part.lstrip("+-")
        if letter in ("x", "y", "z"):
            R[row, "xyz".index(letter)] = -1.0 if part.startswith("-") else 1.0
    if len(parts) != 3 or not np.isclose(np.linalg.det(R), 1.0):
        raise InputDataError(f"axes '{axes}': must be three right-handed axes, like x,z,-y")
    return R


def _read_trc(file: Path) -> tuple[Array, list[str], Array]:
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise InputDataError(f"{file}: not a TRC file: line 1 must begin with PathFileType")
    header = dict(zip(lines[1].split(), lines[2].split(), strict=False))
    unit = header.get("Units", "mm")
    if unit not in _METRES:
        raise InputDataError(f"{file}: Units is '{unit}': must be one of {', '.join(_METRES)}")
    names = [name.strip() for name in lines[3].split("\t")[2:] if name.strip()]
    n = len(names)
    times, rows = [], []
    for number, line in enumerate(lines[4:], start=5):
        cells = line.split("\t")
        if number == 5 or not line.strip():
            continue  # X1 Y1 Z1 …, blank lines
        cells += [""] * (2 + 3 * n - len(cells))
        times.append(_number(file, number, cells[1]))
        rows.append([_number(file, number, cell) for cell in cells[2 : 2 + 3 * n]])
    positions = np.array(rows).reshape(-1, n, 3) * _METRES[unit]
    return np.array(times), names, positions


def _number(file: Path, line: int, cell: str) -> float:
    try:
        return float(cell) if cell.strip() else float("nan")
    except ValueError:
        raise InputDataError(f"{file}: line {line}: '{cell.strip()}' is not a number") from None


def _read_c3d(file: Path) -> tuple[Array, list[str], Array]:
    try:
        ezc3d: Any = importlib.import_module("ezc3d")
    except ImportError as error:
        raise InputDataError(
            f"{file}: this needs the package ezc3d, which cannot be imported ({error}): "
            "pip install 'condyle[opensim]' (or: pip install ezc3d)"
        ) from error
    try:
        c3d = ezc3d.c3d(str(file))
    except (OSError, RuntimeError, ValueError, IndexError) as error:
        raise InputDataError(f"{file}: not a C3D file: {error}") from error
    point = c3d["parameters"]["POINT"]
    data = np.asarray(c3d["data"]["points"], dtype=np.float64)  # (4, n, T)
    unit = str(point["UNITS"]["value"][0]).strip() if point["UNITS"]["value"] else "mm"
    if unit not in _METRES:
        raise InputDataError(
            f"{file}: POINT:UNITS is '{unit}': must be one of {', '.join(_METRES)}"
        )
    header = c3d["header"]["points"]
    rate = float(header["frame_rate"])
    times = (np.arange(data.shape[2]) + int(header["first_frame"])) / rate
    names = [str(label).strip() for label in point["LABELS"]["value"]][: data.shape[1]]
    return times, names, data[:3].transpose(2, 1, 0) * _METRES[unit]
