# SPDX-License-Identifier: Apache-2.0
"""Contact loads at the poses of a table, as a table."""

from os import PathLike
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import contact as _contact
from condyle.contact.contact_pair import ContactPair
from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES
from condyle.errors import InputDataError
from condyle.whole_files import write_whole

Columns = dict[str, NDArray[np.float64] | list[str]]

#: Beside the loads of each side: overlap volume [m³], area of loaded faces [m²], maximum depth [m].
_DETAILS: Final = ("volume", "area", "max_depth")


def evaluate_table(contact: _contact.MeshContact, poses: ArrayLike, *, threads: int = 0) -> Columns:
    """Evaluates a mesh contact at many poses.

    Args:
        contact: the contact.
        poses: (n, 6) [m, rad].
        threads: 0 means all cores. The result does not depend on it.

    Returns:
        Columns of n values in file order: the pose; for each side its loads [N, Nm] as ``medial_Fx`` … ``medial_Mz``,
        ``medial_volume`` [m³], ``medial_area`` [m²] and ``medial_max_depth`` [m]; and ``status``, "ok" or a warning.

    Raises:
        ValueError: poses are not (n, 6), or one is not finite; the text names the row and the coordinate.
    """
    table = np.ascontiguousarray(poses, dtype=np.float64)
    if table.ndim != 2 or table.shape[1] != len(POSE_COLUMNS):
        raise InputDataError(f"poses of shape {table.shape}: must be (n, 6)")
    detail = contact.evaluate_details(table, threads)
    columns: Columns = {name: table[:, i] for i, name in enumerate(POSE_COLUMNS)}
    wrench = np.asarray(detail.wrench)
    for i, side in enumerate(SIDES):
        for j, load in enumerate(LOAD_COLUMNS):
            columns[f"{side}_{load}"] = wrench[:, i, j]
        for name in _DETAILS:
            columns[f"{side}_{name}"] = np.asarray(getattr(detail, name))[:, i]
    columns["status"] = list(detail.status)
    return columns


def evaluate_pair_table(pair: ContactPair, poses: ArrayLike, *, threads: int = 0) -> Columns:
    """Evaluates any two bodies' contact at many poses.

    Args:
        pair: the contact.
        poses: (n, 6) [m, rad].
        threads: 0 means all cores. The result does not depend on it.

    Returns:
        Columns of n values in file order: the pose; for each compartment NAME its loads on the moving body [N, Nm] as
        ``NAME_Fx`` … ``NAME_Mz``, ``NAME_volume`` [m³], ``NAME_area`` [m²] and ``NAME_max_depth`` [m].

    Raises:
        ValueError: poses are not (n, 6), or one is not finite; the text names the row and the coordinate.
    """
    table = np.ascontiguousarray(poses, dtype=np.float64)
    loads = pair.evaluate(table, threads=threads)
    columns: Columns = {name: table[:, i] for i, name in enumerate(POSE_COLUMNS)}
    for c, compartment in enumerate(pair.names):
        for j, load in enumerate(LOAD_COLUMNS):
            columns[f"{compartment}_{load}"] = loads.wrench[:, c, j]
        for name in _DETAILS:
            columns[f"{compartment}_{name}"] = np.asarray(getattr(loads, name))[:, c]
    return columns


def write_table(file: str | PathLike[str], columns: Columns) -> None:
    """Writes columns as CSV, whole or not at all; numbers read back to the same values.

    Raises:
        InputDataError: the file cannot be written.
    """
    texts = [
        c if isinstance(c, list) else [repr(value) for value in c.tolist()]
        for c in columns.values()
    ]
    rows = [",".join(columns), *(",".join(row) for row in zip(*texts, strict=True))]
    write_whole(Path(file), "\n".join(rows) + "\n")
