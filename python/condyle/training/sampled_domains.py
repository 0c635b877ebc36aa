# SPDX-License-Identifier: Apache-2.0
"""Whether a pose lies in one of the domains that a surrogate was sampled in.

A domain is a convex cell in

    v = (pose, wrench of both sides as the surrogate predicts it, h),

where h = y − q(x, z, θx, θy, θz), a quadratic fitted to the loaded samples, is the height above
where contact is: contact ties y to the others within a millimetre or two, on a surface too curved
for a flat-sided cell. A pose is inside where some cell has

    m = max_k |a_k·v + b_k| ≤ 1.

The rows of a cell are the scores of the domain's own box (its axes and limits are in the dataset's
manifest; a box in {x, Fy, z, Mx, θy, θz} needs the predicted loads, hence v), and the ranges that
the domain's samples have in every other coordinate, in h, and in each side's Fy. Where no box is
known (domain 1's envelopes, samples from elsewhere) the principal axes of the samples serve.

Loads alone would not do: beyond its samples a network may predict anything, also something usual.
Poses alone would not either: 50 µm make the difference between a load seen and one never seen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES
from condyle.training.input_data import FY

Array = NDArray[np.float64]
_N_POSE, _N_WRENCH = len(POSE_COLUMNS), len(SIDES) * len(LOAD_COLUMNS)
#: Length of v.
N_FEATURES: Final = _N_POSE + _N_WRENCH + 1
_HEIGHT: Final = N_FEATURES - 1
_Y: Final = POSE_COLUMNS.index("y")
#: A range narrower than this is a coordinate that never moved [m, rad].
_LEAST_HALF_RANGE: Final = 1e-6
#: A side that is lifted in all samples of a cell may carry this share of its greatest Fy.
_LEAST_LOAD: Final = 0.01
#: Share of a cell's predicted samples that each of its rows leaves inside.
_COVERED: Final = 0.998
#: Fewest samples whose ranges say anything.
_LEAST_ROWS: Final = 20


@dataclass(frozen=True)
class SampledDomains:
    """See the module docstring. Build with :meth:`around`.

    Attributes:
        names: One a cell.
        matrix: (cells, rows, N_FEATURES), a_k; rows of zeros where a cell has fewer.
        offset: (cells, rows), b_k.
        height_matrix: (6, 6) symmetric, height_vector: (6,), height_offset: h = pᵀ·matrix·p +
            vector·p + offset [m].
    """

    names: tuple[str, ...]
    matrix: Array
    offset: Array
    height_matrix: Array
    height_vector: Array
    height_offset: float

    @classmethod
    def around(
        cls,
        poses: Array,
        wrenches: Array,
        domain: NDArray[np.int64] | None = None,
        definitions: Sequence[Mapping[str, Any]] = (),
        predicted: Array | None = None,
    ) -> SampledDomains:
        """The cells of samples.

        Args:
            poses: (n, 6) training poses.
            wrenches: (n, 2, 6) their wrenches.
            domain: (n,) the samples' domains; one domain of all if not given.
            definitions: The manifest's ``domains``.
            predicted: (n, 2, 6) the surrogate's own wrenches, which will be asked about; the samples'
                if not given.
        """
        loaded = (wrenches[:, :, FY] > 0).any(axis=1)
        height = _height_above_contact(poses[loaded])
        values = _features(poses, wrenches, height)
        asked = values if predicted is None else _features(poses, predicted, height)
        domain = np.zeros(len(poses), np.int64) if domain is None else domain
        boxes = _boxes(definitions)
        least_load = _LEAST_LOAD * wrenches[:, :, FY].max(axis=0)
        names, cells = [], []
        for number in np.unique(domain):
            mine = domain == number
            # Contact and flight have other loads and heights: a cell each.
            for what, rows in (("loaded", mine & loaded), ("lifted", mine & ~loaded)):
                if rows.sum() >= _LEAST_ROWS:
                    names.append(f"domain {number}, {what}" if number else what)
                    cell = _cell(values[rows], boxes.get(int(number)), least_load)
                    cells.append(_with_room(cell, asked[rows]))
        most = max(len(cell) for cell in cells)
        matrix = np.zeros((len(cells), most, N_FEATURES))
        offset = np.zeros((len(cells), most))
        for index, cell in enumerate(cells):
            matrix[index, : len(cell)] = cell[:, :-1]
            offset[index, : len(cell)] = cell[:, -1]
        return cls(tuple(names), matrix, offset, *height)

    def excess(self, poses: Array, wrenches: Array) -> Array:
        """Least m over the cells (n,), at poses (n, 6) with predicted wrenches (n, 2, 6)."""
        height = (self.height_matrix, self.height_vector, self.height_offset)
        values = _features(poses, wrenches, height)
        flat = values @ self.matrix.reshape(-1, N_FEATURES).T + self.offset.reshape(-1)
        sizes = np.abs(flat).reshape(len(poses), *self.offset.shape)
        result: Array = sizes.max(axis=2).min(axis=1)
        return result


def _features(poses: Array, wrenches: Array, height: tuple[Array, Array, float]) -> Array:
    """The points v (n, N_FEATURES)."""
    matrix, vector, offset = height
    h = ((poses @ matrix + vector) * poses).sum(axis=1) + offset
    return np.column_stack([poses, wrenches.reshape(len(poses), -1), h])


def _boxes(definitions: Sequence[Mapping[str, Any]]) -> dict[int, Array]:
    """The scores' rows [a | b] of every domain whose box is known, in v."""
    boxes = {}
    for entry in definitions:
        definition = entry.get("definition", {})  # none of samples from elsewhere
        if "score_low" in definition:
            boxes[int(entry["domain"])] = _box_rows(definition)
    if 4 in boxes:
        boxes.setdefault(5, boxes[4])  # raised copies of domain 4's points
    return boxes


def _box_rows(definition: Mapping[str, Any]) -> Array:
    low, high = np.array(definition["score_low"]), np.array(definition["score_high"])
    axes = np.array(definition["axes"]) / np.array(definition["scale"])
    rows = np.zeros((len(axes), N_FEATURES + 1))
    for column, name in enumerate(definition["columns"]):
        if name == "theta_x" and "theta_x" in definition:
            # Stretched after the box was drawn: its own range, taken from the samples, bounds it.
            return np.zeros((0, N_FEATURES + 1))
        rows[:, _columns_of(name)] = axes[:, [column]]
    rows[:, -1] = -axes @ np.array(definition["mean"])
    rows[:, -1] -= (low + high) / 2
    scaled: Array = rows / ((high - low) / 2)[:, None]
    return scaled


def _columns_of(name: str) -> list[int]:
    """Where a sampled variable sits in v: a pose coordinate, or a load summed over the sides."""
    if name in POSE_COLUMNS:
        return [POSE_COLUMNS.index(name)]
    load = LOAD_COLUMNS.index(name)
    return [_N_POSE + side * len(LOAD_COLUMNS) + load for side in range(len(SIDES))]


def _cell(values: Array, box: Array | None, least_load: Array) -> Array:
    """Rows [a | b] of the cell of samples' v (n, N_FEATURES); Fy counts from least_load (2,) on."""
    rows = [] if box is None else list(box)
    if box is None or len(box) == 0:
        rows += list(_principal_rows(values))
    for column in [i for i in range(_N_POSE) if i != _Y] + [_HEIGHT]:
        low, high = values[:, column].min(), values[:, column].max()
        half = max((high - low) / 2, _LEAST_HALF_RANGE)
        row = np.zeros(N_FEATURES + 1)
        row[column], row[-1] = 1.0 / half, -(high + low) / (2 * half)
        rows.append(row)
    for side in range(len(SIDES)):
        # Loads are bounded from above; a lifted side is as usual as can be, not on an edge.
        row = np.zeros(N_FEATURES + 1)
        column = _N_POSE + side * len(LOAD_COLUMNS) + FY
        row[column] = 1.0 / max(float(values[:, column].max()), least_load[side])
        rows.append(row)
    return np.array(rows)


def _with_room(cell: Array, asked: Array) -> Array:
    """The cell with every row as wide as the predicted samples (n, N_FEATURES) make it, or wider.

    A box in loads can be narrow against the surrogate's errors in them: along Mx − lever·Fy, say.
    """
    sizes = np.abs(asked @ cell[:, :-1].T + cell[:, -1])
    room = np.maximum(np.quantile(sizes, _COVERED, axis=0), 1.0)
    wider: Array = cell / room[:, None]
    return wider


def _principal_rows(values: Array) -> Array:
    """Rows [a | b] that fill [-1, 1] on the principal axes of the poses but y."""
    columns = [i for i in range(_N_POSE) if i != _Y]
    poses = values[:, columns]
    mean, deviation = poses.mean(axis=0), np.maximum(poses.std(axis=0), _LEAST_HALF_RANGE)
    _, _, directions = np.linalg.svd((poses - mean) / deviation, full_matrices=False)
    # The sign of a singular vector is arbitrary; fix it for reproducible files.
    largest = np.abs(directions).argmax(axis=1)
    directions = directions * np.sign(directions[np.arange(len(directions)), largest])[:, None]
    scores = ((poses - mean) / deviation) @ directions.T
    low, high = scores.min(axis=0), scores.max(axis=0)
    half = np.maximum((high - low) / 2, 1e-9)
    axes = directions / deviation / half[:, None]
    rows = np.zeros((len(axes), N_FEATURES + 1))
    rows[:, columns] = axes
    rows[:, -1] = -(axes @ mean) - (high + low) / (2 * half)
    return rows


def _height_above_contact(poses: Array) -> tuple[Array, Array, float]:
    """(matrix, vector, offset) of h in metres, fitted to loaded poses (n, 6)."""
    mean, deviation = poses.mean(axis=0), np.maximum(poses.std(axis=0), _LEAST_HALF_RANGE)
    others = np.delete((poses - mean) / deviation, _Y, axis=1)
    i, j = np.triu_indices(others.shape[1])
    terms = np.column_stack([np.ones(len(poses)), others, others[:, i] * others[:, j]])
    coefficients = np.linalg.lstsq(terms, poses[:, _Y], rcond=None)[0]
    # Back from scaled coordinates to the pose: q = c + b·z + zᵀAz with z = (p − mean)/σ.
    keep = np.delete(np.arange(_N_POSE), _Y)
    linear = coefficients[1 : 1 + len(keep)]
    quadratic = np.zeros((len(keep), len(keep)))
    quadratic[i, j] = coefficients[1 + len(keep) :]
    quadratic = (quadratic + quadratic.T) / 2
    slope, curvature = np.zeros(_N_POSE), np.zeros((_N_POSE, _N_POSE))
    slope[keep] = linear / deviation[keep]
    curvature[np.ix_(keep, keep)] = quadratic / np.outer(deviation[keep], deviation[keep])
    constant = coefficients[0] - slope @ mean + mean @ curvature @ mean
    vector = 2 * curvature @ mean - slope
    vector[_Y] += 1.0
    return -curvature, vector, float(-constant)
