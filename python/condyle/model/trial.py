# SPDX-License-Identifier: Apache-2.0
"""A recorded activity of a model: its motion, the loads on it, and paths that another engine found."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from condyle._core.fdk import loads_in_ground
from condyle._core.io import (
    ExternalLoadsSettings,
    PathSnapshots,
    read_external_loads,
    read_motion,
    read_path_snapshots,
)
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel

Array = NDArray[np.float64]
#: Times of motion and snapshots that differ by less are the same [s].
_SAME_TIME = 1e-5


@dataclass(frozen=True)
class Trial:
    """Motion and loads, one row a time frame.

    Attributes:
        times: (T,) [s].
        q: (T, coordinates) in the model's order [rad, m].
        qd: Its rate.
        qdd: The rate of that.
        load_bodies: (L,) indices of the bodies with external loads; -1: ground.
        loads: (T, L, 9) force [N], point [m] and free moment [Nm], in ground.
        snapshots: Paths found elsewhere.
        snapshot_rows: (T,) which of the snapshots' times a time frame takes.
    """

    times: Array
    q: Array
    qd: Array
    qdd: Array
    load_bodies: tuple[int, ...]
    loads: Array
    snapshots: PathSnapshots | None = None
    snapshot_rows: tuple[int, ...] = ()

    def __len__(self) -> int:
        """Time frames."""
        return len(self.times)


def make_trial(
    model: MusculoskeletalModel,
    times: Array,
    q: Array,
    qd: Array | None = None,
    qdd: Array | None = None,
    *,
    load_bodies: tuple[str, ...] = (),
    loads: Array | None = None,
) -> Trial:
    """A trial from arrays; without rates it is a series of postures at rest.

    Args:
        model: that moves.
        times: (T,) [s].
        q: (T, coordinates) in the model's order [rad, m].
        qd: its rate.
        qdd: the rate of that.
        load_bodies: (L,) names of the bodies with external loads.
        loads: (T, L, 9) force [N], point [m] and free moment [Nm], in ground.

    Raises:
        ValueError: shapes that do not fit, by name.
    """
    q = np.ascontiguousarray(q, dtype=np.float64)
    shape = (len(times), len(model.coordinate_names))
    if q.shape != shape:
        raise InputDataError(
            f"q has shape {q.shape}; it must have {shape} (time frames, coordinates)"
        )
    bodies = tuple(-1 if name == "ground" else model.body(name) for name in load_bodies)
    if loads is None:
        loads = np.zeros((len(times), len(bodies), 9))
    if loads.shape != (len(times), len(bodies), 9):
        raise InputDataError(
            f"loads have shape {loads.shape}; they must have {(len(times), len(bodies), 9)} "
            "(time frames, bodies, force point moment)"
        )
    still = np.zeros_like(q)
    return Trial(
        np.asarray(times, dtype=np.float64),
        q,
        still if qd is None else np.ascontiguousarray(qd, dtype=np.float64),
        still if qdd is None else np.ascontiguousarray(qdd, dtype=np.float64),
        bodies,
        np.ascontiguousarray(loads, dtype=np.float64),
    )


def read_trial(
    model: MusculoskeletalModel,
    motion: Path | str,
    *,
    external_loads: Path | str | None = None,
    snapshots: Path | str | None = None,
    start: float | None = None,
    end: float | None = None,
    negligible_force: float = 0.0,
) -> Trial:
    """Reads a trial from OpenSim's files.

    Coordinates are differentiated as OpenSim's inverse dynamics does: by the natural quintic spline through
    all rows of the file. Filter before, if the coordinates are raw.

    Args:
        model: that moves.
        motion: STO or MOT file with a column a coordinate, in radians or degrees as its header says.
            Coordinates without a column are an error, unless they are locked or follow another.
        external_loads: OpenSim's XML file; its table is found beside it.
        snapshots: file of paths (docs/model_files.md) whose times include the motion's.
        start: first time taken [s].
        end: last time taken [s].
        negligible_force: a force without a point of application counts as none up to this [N].

    Raises:
        ValueError: a file cannot be read, columns do not match, a gap in the loads, times that no snapshot has;
            the message names file, column and time.
    """
    table = read_motion(Path(motion), allow_nan=False)
    columns = _match_columns(model, [_coordinate_of(name) for name in table.names], str(motion))
    rotational = dict(zip(model.coordinate_names, model.core.coordinate_is_rotational, strict=True))
    table.convert_to_radians(lambda label: rotational.get(_coordinate_of(label), False))
    chosen = _window(np.asarray(table.times), start, end, str(motion))
    times = np.asarray(table.times)[chosen]
    spline = table.spline()
    q, qd, qdd = (_in_model_order(model, spline(times, k), columns, k) for k in range(3))
    bodies: tuple[int, ...] = ()
    loads = np.zeros((len(times), 0, 9))
    if external_loads is not None:
        settings = ExternalLoadsSettings()
        settings.negligible_force = negligible_force
        found = read_external_loads(Path(external_loads), settings)
        found.require_bodies(model.core.description)
        indices, loads = loads_in_ground(found, model.core, times, q)
        bodies = tuple(indices)
    trial = Trial(times, q, qd, qdd, bodies, loads)
    return trial if snapshots is None else with_snapshots(model, trial, snapshots)


def with_snapshots(model: MusculoskeletalModel, trial: Trial, snapshots: Path | str) -> Trial:
    """The trial with paths from a file.

    Raises:
        ValueError: the file cannot be read, or has no snapshot at a time of the trial.
    """
    found = read_path_snapshots(Path(snapshots), model.core.description)
    known = np.asarray(found.times)
    rows = np.clip(np.searchsorted(known, trial.times - _SAME_TIME), 0, len(known) - 1)
    far = np.abs(known[rows] - trial.times) > _SAME_TIME
    if far.any():
        raise InputDataError(
            f"{snapshots}: no snapshot at {trial.times[far][0]:g} s; it has {len(known)} from "
            f"{known[0]:g} to {known[-1]:g} s"
        )
    return Trial(
        trial.times,
        trial.q,
        trial.qd,
        trial.qdd,
        trial.load_bodies,
        trial.loads,
        found,
        tuple(int(row) for row in rows),
    )


def _coordinate_of(label: str) -> str:
    """``/jointset/knee_r/knee_flex_r/value`` is OpenSim's long form of ``knee_flex_r``."""
    parts = label.split("/")
    return parts[-2] if len(parts) > 2 and parts[-1] == "value" else label


def _match_columns(model: MusculoskeletalModel, labels: list[str], source: str) -> dict[str, int]:
    unknown = [label for label in labels if label not in model.coordinate_names]
    if unknown:
        near = difflib.get_close_matches(unknown[0], model.coordinate_names, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InputDataError(
            f"{source}: column {unknown[0]!r} is no coordinate of model {model.name!r}{hint}"
            + (f" ({len(unknown)} such columns)" if len(unknown) > 1 else "")
        )
    columns = {label: index for index, label in enumerate(labels)}
    free = model.core.coordinate_needs_motion
    missing = [
        name
        for name, needed in zip(model.coordinate_names, free, strict=True)
        if needed and name not in columns
    ]
    if missing:
        raise InputDataError(
            f"{source}: no column for {', '.join(missing[:5])}"
            + (f" and {len(missing) - 5} more" if len(missing) > 5 else "")
            + f"; model {model.name!r} neither locks nor couples them"
        )
    return columns


def _window(times: Array, start: float | None, end: float | None, source: str) -> NDArray[np.bool_]:
    first = -np.inf if start is None else start - _SAME_TIME
    last = np.inf if end is None else end + _SAME_TIME
    chosen = (times >= first) & (times <= last)
    if not chosen.any():
        raise InputDataError(
            f"{source}: no time frame from {start} to {end} s; it has {times[0]:g} to {times[-1]:g} s"
        )
    return chosen


def _in_model_order(
    model: MusculoskeletalModel, values: Array, columns: dict[str, int], derivative: int
) -> Array:
    if derivative == 0:
        ordered = np.tile(model.default_q(), (len(values), 1))
    else:
        ordered = np.zeros((len(values), len(model.coordinate_names)))
    for index, name in enumerate(model.coordinate_names):
        if name in columns:
            ordered[:, index] = values[:, columns[name]]
    return ordered
