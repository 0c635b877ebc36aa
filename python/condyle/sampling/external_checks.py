# SPDX-License-Identifier: Apache-2.0
"""Whether samples from elsewhere can be what their owner says: units, signs, sides, repetitions.

Another program has its own axes, signs and units; what is read in the wrong ones trains a surrogate
that looks fine against its own test samples. So the checks refuse what no knee does.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import (
    LOAD_COLUMNS,
    POSE_COLUMNS,
    SIDES,
    WRENCH_COLUMNS,
    SideOfBody,
    medial_direction,
)
from condyle.errors import InputDataError
from condyle.sampling.external_table import ExternalTable, TableUnits

#: Fewest rows that a surrogate could be trained and tested on.
MIN_ROWS: Final = 200
#: Greatest absolute values: origins of a knee's components lie within a metre, and ten times the
#: load of jumping is not a load.
MAX_LENGTH: Final = 1.0
MAX_ANGLE: Final = float(np.pi)
MAX_FORCE: Final = 5e4
MAX_MOMENT: Final = 5e3
#: Contact acts within a metre of the origin: |M| ≤ this · |F| + MOMENT_FLOOR.
MAX_ARM: Final = 1.0
MOMENT_FLOOR: Final = 1.0
#: A pose column must vary by more than this [m, rad].
_LEAST_SPAN: Final = 1e-9
#: y of poses in contact and out of it varies by far more than this [m]; metres read as millimetres
#: do not.
_LEAST_HEIGHT_SPAN: Final = 1e-5

_FY, _MX = (LOAD_COLUMNS.index(name) for name in ("Fy", "Mx"))


def check_external(table: ExternalTable, units: TableUnits, side_of_body: SideOfBody) -> None:
    """Refuse a table that cannot be right.

    Raises:
        InputDataError: Names file, row, column, value (in the file's unit) and limit.
    """
    if len(table.poses) < MIN_ROWS:
        raise InputDataError(
            f"{table.path}: has {len(table.poses)} rows of samples; at least {MIN_ROWS} are needed"
        )
    _check_limits(table, units)
    _check_spans(table, units)
    _check_repetitions(table)
    _check_loads(table)
    _check_sides(table, side_of_body)


def _check_limits(table: ExternalTable, units: TableUnits) -> None:
    n = len(table.poses)
    values = np.hstack([table.poses, table.wrenches.reshape(n, -1)])
    for index, name in enumerate((*POSE_COLUMNS, *WRENCH_COLUMNS)):
        limit = _limit(name)
        bad = np.abs(values[:, index]) > limit
        if bad.any():
            row = int(np.argmax(bad))
            factor, unit = units.factor(name), units.of(name)
            raise InputDataError(
                f"{table.path}, {table.row(row)}: {name} is {values[row, index] / factor:.6g} {unit}; "
                f"at most {limit / factor:.6g} {unit} either way is plausible ({int(bad.sum())} of "
                f"{n} rows are beyond): is {unit} the file's unit?"
            )
    force = np.linalg.norm(table.wrenches[:, :, :3], axis=2)
    moment = np.linalg.norm(table.wrenches[:, :, 3:], axis=2)
    bad = moment > MAX_ARM * force + MOMENT_FLOOR
    if bad.any():
        row, side = np.argwhere(bad)[0]
        raise InputDataError(
            f"{table.path}, {table.row(int(row))}: the {SIDES[side]} moment is "
            f"{moment[row, side]:.6g} Nm with a force of {force[row, side]:.6g} N; contact within "
            f"{MAX_ARM:g} m of the femoral origin gives at most "
            f"{MAX_ARM * force[row, side] + MOMENT_FLOOR:.6g} Nm: is {units.moment} the file's unit?"
        )


def _limit(name: str) -> float:
    if name in POSE_COLUMNS:
        return MAX_ANGLE if name.startswith("theta") else MAX_LENGTH
    return MAX_FORCE if "_F" in name else MAX_MOMENT


def _check_spans(table: ExternalTable, units: TableUnits) -> None:
    spans = np.ptp(table.poses, axis=0)
    for name, span, value in zip(POSE_COLUMNS, spans, table.poses[0], strict=True):
        if span <= _LEAST_SPAN:
            raise InputDataError(
                f"{table.path}: {name} is {value / units.factor(name):.6g} {units.of(name)} in every "
                "row; a surrogate cannot learn what does not vary"
            )
    height = spans[POSE_COLUMNS.index("y")]
    if height < _LEAST_HEIGHT_SPAN:
        raise InputDataError(
            f"{table.path}: y varies by {1e3 * height:.3g} mm over all rows; at least "
            f"{1e3 * _LEAST_HEIGHT_SPAN:g} mm is plausible: is {units.length} the file's unit?"
        )


def _check_repetitions(table: ExternalTable) -> None:
    _, first, inverse = np.unique(table.poses, axis=0, return_index=True, return_inverse=True)
    repeated = len(table.poses) - len(first)
    if repeated:
        firsts = first[inverse.reshape(-1)]
        row = int(np.flatnonzero(firsts != np.arange(len(firsts)))[0])
        raise InputDataError(
            f"{table.path}, {table.row(row)}: the pose is that of {table.row(int(firsts[row]))}; "
            f"each pose must be there once ({repeated} are repeated)"
        )


def _check_loads(table: ExternalTable) -> None:
    for side, name in enumerate(SIDES):
        wrench = table.wrenches[:, side]
        loaded = np.any(wrench != 0.0, axis=1)
        if not loaded.any():
            raise InputDataError(
                f"{table.path}: the {name} side's loads are zero in all {len(wrench)} rows; "
                "samples with contact on each side are needed"
            )
        pulls = int((wrench[:, _FY] < 0.0).sum())
        if 2 * pulls > int(loaded.sum()):
            row = int(np.argmax(wrench[:, _FY] < 0.0))
            raise InputDataError(
                f"{table.path}, {table.row(row)}: {name}_Fy is {wrench[row, _FY]:.6g} N, and negative "
                f"in {pulls} of the {int(loaded.sum())} rows with a load on that side; loads act on "
                "the femur, where compression is Fy > 0"
            )


def _check_sides(table: ExternalTable, side_of_body: SideOfBody) -> None:
    """The medial force must lie medially: Mx ≈ −z·Fy, and z points medially in a left knee."""
    arms = _arms(table.wrenches)
    if np.isnan(arms).any():
        return
    apart = medial_direction(side_of_body) * (arms[0] - arms[1])
    if apart <= 0.0:
        medial, lateral = (1e3 * arm for arm in arms)
        raise InputDataError(
            f"{table.path}: by their Mx, the medial forces act at z = {medial:.3g} mm and the "
            f"lateral ones at {lateral:.3g} mm (medians, from the femoral origin); in a {side_of_body} "
            f"knee medial is z {'>' if side_of_body == 'left' else '<'} lateral: is side_of_body right, "
            "or are the columns of the sides swapped?"
        )


def _arms(wrenches: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2,) median z of each side's force from Fo, were it along y; NaN without a clear load."""
    arms = np.full(2, np.nan)
    for side in range(2):
        Fy, Mx = wrenches[:, side, _FY], wrenches[:, side, _MX]
        clear = Fy > 0.01 * Fy.max()
        if Fy.max() > 0.0 and clear.any():
            arms[side] = float(np.median(-Mx[clear] / Fy[clear]))
    return arms
