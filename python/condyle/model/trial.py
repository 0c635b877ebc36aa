# SPDX-License-Identifier: Apache-2.0
"""A recorded activity of a model: its motion, the loads on it, and paths that another engine found."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace
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
from condyle._core.model import Kinematics
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel

Array = NDArray[np.float64]
#: Times of motion and snapshots that differ by less are the same [s].
_SAME_TIME = 1e-5
#: Ends of held and computed paths that differ by less are the same [m]: files carry 8 digits, and a point
#: that moves with a coordinate may be evaluated a rounding of that coordinate away.
_SAME_POINT = 1e-4
#: A narrow range says little: no value within this many half-widths of these is refused [rad, m].
_LEAST_HALF_WIDTH = {True: 0.5, False: 0.05}


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
        at_default: Force-dependent coordinates that the motion says nothing of: they are at their default.
    """

    times: Array
    q: Array
    qd: Array
    qdd: Array
    load_bodies: tuple[int, ...]
    loads: Array
    snapshots: PathSnapshots | None = None
    snapshot_rows: tuple[int, ...] = ()
    at_default: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Time frames."""
        return len(self.times)

    def nearest(self, time: float) -> int:
        """Index of the time frame nearest to a time [s].

        Raises:
            InputDataError: the time is beyond the trial's.
        """
        if not self.times[0] - _SAME_TIME <= time <= self.times[-1] + _SAME_TIME:
            raise InputDataError(
                f"no time frame at {time:g} s; the trial has {self.times[0]:g} to {self.times[-1]:g} s"
            )
        return int(np.abs(self.times - time).argmin())

    def only(self, frame: int) -> Trial:
        """One time frame of it."""
        one = slice(frame, frame + 1)
        return replace(
            self,
            times=self.times[one],
            q=self.q[one],
            qd=self.qd[one],
            qdd=self.qdd[one],
            loads=self.loads[one],
            snapshot_rows=self.snapshot_rows[one],
        )


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
    range_factor: float = 3.0,
) -> Trial:
    """Reads a trial from OpenSim's files.

    Coordinates are differentiated as OpenSim's inverse dynamics does: by the natural quintic spline through
    all rows of the file. Filter before, if the coordinates are raw.

    Args:
        model: that moves.
        motion: STO or MOT file with a column a coordinate, in radians or degrees as its header says.
            Coordinates without a column are an error, unless they are locked, follow another or are
            force-dependent: inverse kinematics may know nothing of these (``at_default``).
        external_loads: OpenSim's XML file; its table is found beside it.
        snapshots: file of paths (docs/model_files.md) whose times include the motion's.
        start: first time taken [s].
        end: last time taken [s].
        negligible_force: a force without a point of application counts as none up to this [N].
        range_factor: a coordinate farther than this many half-widths from the middle of its range is taken for
            one in other units; inf: never.

    Raises:
        ValueError: a file cannot be read, columns do not match, values far beyond a coordinate's range, a gap in
            the loads, snapshots of another trial or model; the message names file, column and time.
    """
    table = read_motion(Path(motion), allow_nan=False)
    columns = _match_columns(model, [_coordinate_of(name) for name in table.names], str(motion))
    rotational = dict(zip(model.coordinate_names, model.core.coordinate_is_rotational, strict=True))
    table.convert_to_radians(lambda label: rotational.get(_coordinate_of(label), False))
    chosen = _window(np.asarray(table.times), start, end, str(motion))
    times = np.asarray(table.times)[chosen]
    _require_plausible(
        model, times, np.asarray(table.data)[chosen], columns, range_factor, str(motion)
    )
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
    at_default = tuple(name for name in model.force_dependent if name not in columns)
    trial = Trial(times, q, qd, qdd, bodies, loads, at_default=at_default)
    return trial if snapshots is None else with_snapshots(model, trial, snapshots)


def with_snapshots(model: MusculoskeletalModel, trial: Trial, snapshots: Path | str) -> Trial:
    """The trial with paths from a file.

    Raises:
        ValueError: the file cannot be read, has no snapshot at a time of the trial, or holds paths that end
            elsewhere than the model's.
    """
    found = read_path_snapshots(Path(snapshots), model.core.description)
    known = np.asarray(found.times)
    rows = np.clip(np.searchsorted(known, trial.times - _SAME_TIME), 0, len(known) - 1)
    far = np.abs(known[rows] - trial.times) > _SAME_TIME
    if far.any():
        raise InputDataError(
            f"{snapshots}: no snapshot at {trial.times[far][0]:g} s; it has {len(known)} from "
            f"{known[0]:g} to {known[-1]:g} s: snapshots are made of the motion that they go with"
        )
    _require_same_ends(model, trial.q[0], found, int(rows[0]), str(snapshots))
    return replace(trial, snapshots=found, snapshot_rows=tuple(int(row) for row in rows))


def _require_same_ends(
    model: MusculoskeletalModel, q: Array, snapshots: PathSnapshots, row: int, source: str
) -> None:
    """Held paths begin and end where the model's own do, or they are another model's."""
    now = Kinematics(model.core, q)
    for kind, names, line in (
        ("muscle", model.muscle_names, now.muscle_line),
        ("ligament", model.ligament_names, now.ligament_line),
    ):
        held = set(snapshots.paths)
        for index in (i for i, name in enumerate(names) if name in held):
            ends = line(index, None, 0)[[0, -1]]
            off = np.linalg.norm(line(index, snapshots, row)[[0, -1]] - ends, axis=1)
            if off.max() > _SAME_POINT:
                which = ("begins", "ends")[int(off.argmax())]
                raise InputDataError(
                    f"{source}: {kind} {names[index]!r} {which} {1e3 * off.max():.3g} mm from where model "
                    f"{model.name!r} has it: snapshots of another model"
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
        if needed and name not in columns and name not in model.force_dependent
    ]
    if missing:
        raise InputDataError(
            f"{source}: no column for {', '.join(missing[:5])}"
            + (f" and {len(missing) - 5} more" if len(missing) > 5 else "")
            + f"; model {model.name!r} neither locks nor couples them"
        )
    return columns


def _require_plausible(
    model: MusculoskeletalModel,
    times: Array,
    values: Array,
    columns: dict[str, int],
    factor: float,
    source: str,
) -> None:
    """Degrees that are said to be radians, and millimetres, are far out of any joint's range."""
    core = model.core
    for index, name in enumerate(model.coordinate_names):
        low, high = core.coordinate_minima[index], core.coordinate_maxima[index]
        if name not in columns or not low < high:
            continue
        rotational = core.coordinate_is_rotational[index]
        allowed = factor * max((high - low) / 2, _LEAST_HALF_WIDTH[rotational])
        column = values[:, columns[name]]
        away = np.abs(column - (low + high) / 2)
        worst = int(away.argmax())
        if away[worst] > allowed:
            unit = "rad" if rotational else "m"
            asked = "degrees, with inDegrees=no in the header" if rotational else "millimetres"
            raise InputDataError(
                f"{source}: column {name!r} is {column[worst]:.4g} {unit} at {times[worst]:g} s; its range in "
                f"model {model.name!r} is {low:.4g} to {high:.4g} {unit}: are these {asked}?"
            )


def _window(times: Array, start: float | None, end: float | None, source: str) -> NDArray[np.bool_]:
    first = -np.inf if start is None else start - _SAME_TIME
    last = np.inf if end is None else end + _SAME_TIME
    chosen = (times >= first) & (times <= last)
    if not chosen.any():
        asked = [f"{word} {t:g} s" for word, t in (("from", start), ("to", end)) if t is not None]
        raise InputDataError(
            f"{source}: no time frame {' '.join(asked)}; it has {times[0]:g} to {times[-1]:g} s"
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
