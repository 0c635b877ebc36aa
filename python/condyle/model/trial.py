# SPDX-License-Identifier: Apache-2.0
"""A recorded activity of a model: its motion, the loads on it, and paths that another engine found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from condyle._core.io import PathSnapshots, TrialReading, read_trial_snapshots
from condyle._core.io import read_trial as _read_trial
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel

Array = NDArray[np.float64]
#: A time that is asked for may lie this far beyond a trial's [s].
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
    reading = TrialReading()
    reading.start = -np.inf if start is None else start
    reading.end = np.inf if end is None else end
    reading.negligible_force = negligible_force
    reading.range_factor = range_factor
    loads = "" if external_loads is None else Path(external_loads)
    found = _read_trial(model.core, Path(motion), loads, reading)
    trial = Trial(
        found.times,
        found.q,
        found.qd,
        found.qdd,
        tuple(found.load_bodies),
        found.loads,
        at_default=tuple(found.at_default),
    )
    return trial if snapshots is None else with_snapshots(model, trial, snapshots)


def with_snapshots(model: MusculoskeletalModel, trial: Trial, snapshots: Path | str) -> Trial:
    """The trial with paths from a file.

    Raises:
        ValueError: the file cannot be read, has no snapshot at a time of the trial, or holds paths that end
            elsewhere than the model's.
    """
    found = read_trial_snapshots(Path(snapshots), model.core, trial.times, trial.q[0])
    return replace(trial, snapshots=found.snapshots, snapshot_rows=tuple(found.rows))
