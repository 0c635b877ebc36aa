# SPDX-License-Identifier: Apache-2.0
"""Reference curves: activities over time, pose and loads. They say where the design space is.

They come from simulated activities (:meth:`ReferenceCurves.from_activities`), from a user's tables
(:mod:`condyle.sampling.curve_files`) or, where there are none, from the implant's conformity
(:mod:`condyle.sampling.conformity_curves`): the same kind of object, and whatever is drawn around it
does not know which.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS
from condyle.errors import InputDataError

#: What a curve holds at each time frame: the pose and the loads in the sensitive directions.
CURVE_COLUMNS: Final = (*POSE_COLUMNS, "Fy", "Mx")
#: Beyond these a value is in another unit (mm, degrees, N mm), not a knee's.
_PLAUSIBLE: Final = {
    **dict.fromkeys(("x", "y", "z"), (1.0, "m")),
    **dict.fromkeys(("theta_x", "theta_y", "theta_z"), (np.pi, "rad")),
    "Fy": (1e5, "N"),
    "Mx": (1e4, "Nm"),
}


@dataclass(frozen=True)
class ReferenceCurve:
    """One activity over time.

    Attributes:
        name: The activity.
        time: (n,) strictly increasing [s].
        values: (n, 8), columns CURVE_COLUMNS [m, rad, N, Nm].
    """

    name: str
    time: NDArray[np.float64]
    values: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Checks.

        Raises:
            InputDataError: Wrong shapes, too few time frames, time that does not increase, a value
                that is not finite or plainly in another unit; the message names activity, column,
                time frame and value.
        """
        time = np.ascontiguousarray(self.time, dtype=np.float64)
        values = np.ascontiguousarray(self.values, dtype=np.float64)
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "values", values)
        where = f"reference curve {self.name!r}"
        if time.ndim != 1 or values.shape != (len(time), len(CURVE_COLUMNS)):
            raise InputDataError(
                f"{where}: time has shape {time.shape} and values {values.shape}; "
                "(n,) and (n, 8) are needed"
            )
        if len(time) < 2:
            raise InputDataError(f"{where}: {len(time)} time frames; at least 2 are needed")
        steps = np.diff(time)
        if not np.all(steps > 0):
            frame = int(np.argmin(steps > 0)) + 1
            raise InputDataError(
                f"{where}: time does not increase at time frame {frame} ({time[frame]:.6g} s)"
            )
        for column, name in enumerate(CURVE_COLUMNS):
            limit, unit = _PLAUSIBLE[name]
            bad = ~(np.abs(values[:, column]) <= limit)
            if np.any(bad):
                frame = int(np.argmax(bad))
                raise InputDataError(
                    f"{where}: {name} is {values[frame, column]:.6g} at time frame {frame}; "
                    f"a finite value of at most {limit:.6g} {unit} is needed"
                )

    def column(self, name: str) -> NDArray[np.float64]:
        """One of CURVE_COLUMNS over time: (n,)."""
        return self.values[:, CURVE_COLUMNS.index(name)]

    def resampled(self, frames: int) -> ReferenceCurve:
        """The same activity at ``frames`` equally spaced times, interpolated linearly."""
        time = np.linspace(self.time[0], self.time[-1], frames)
        values = np.column_stack([np.interp(time, self.time, column) for column in self.values.T])
        return ReferenceCurve(self.name, time, values)


@dataclass(frozen=True)
class ReferenceCurves:
    """The activities that a sampling plan starts from, each name once."""

    curves: tuple[ReferenceCurve, ...]

    def __post_init__(self) -> None:
        """Checks.

        Raises:
            InputDataError: No curve, or a name twice.
        """
        names = self.names
        if not names:
            raise InputDataError("reference curves: there is none; at least one activity is needed")
        for name in names:
            if names.count(name) > 1:
                raise InputDataError(f"reference curves: the activity {name!r} is there twice")

    @classmethod
    def from_activities(
        cls,
        activities: Mapping[
            str, tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
        ],
    ) -> ReferenceCurves:
        """From simulated activities.

        Args:
            activities: name → (time (n,) [s], poses (n, 6) [m, rad], wrenches (n, 2, 6) [N, Nm]).
                Time frames that did not converge are the caller's to leave out.
        """
        fy, mx = LOAD_COLUMNS.index("Fy"), LOAD_COLUMNS.index("Mx")
        curves = []
        for name, (time, poses, wrenches) in activities.items():
            poses, wrenches = np.asarray(poses, np.float64), np.asarray(wrenches, np.float64)
            if poses.shape != (len(time), 6) or wrenches.shape != (len(time), 2, 6):
                raise InputDataError(
                    f"reference curve {name!r}: poses have shape {poses.shape} and "
                    f"wrenches {wrenches.shape}; "
                    f"({len(time)}, 6) and ({len(time)}, 2, 6) are needed"
                )
            total = wrenches.sum(axis=1)
            curves.append(
                ReferenceCurve(name, time, np.column_stack([poses, total[:, fy], total[:, mx]]))
            )
        return cls(tuple(curves))

    @property
    def names(self) -> tuple[str, ...]:
        """The activities."""
        return tuple(curve.name for curve in self.curves)

    def table(self, columns: Sequence[str]) -> NDArray[np.float64]:
        """All curves' time frames, one below the other: (n, len(columns))."""
        return np.concatenate(
            [np.column_stack([curve.column(name) for name in columns]) for curve in self.curves]
        )

    def resampled(self, frames: int) -> ReferenceCurves:
        """All curves at ``frames`` time frames together, shared by duration (at least 2 each).

        Raises:
            InputDataError: Fewer than 2 time frames a curve.
        """
        if frames < 2 * len(self.curves):
            raise InputDataError(
                f"{len(self.curves)} reference curves cannot share {frames} time frames, "
                "2 each at least"
            )
        durations = np.array([curve.time[-1] - curve.time[0] for curve in self.curves])
        exact = 2 + (frames - 2 * len(self.curves)) * durations / durations.sum()
        shares = np.floor(exact).astype(int)
        # Largest remainders take what rounding down left over; a stable sort settles ties by the
        # curves' order.
        leftover = frames - int(shares.sum())
        shares[np.argsort(-(exact - shares), kind="stable")[:leftover]] += 1
        return ReferenceCurves(
            tuple(
                curve.resampled(int(share))
                for curve, share in zip(self.curves, shares, strict=True)
            )
        )

    def content_hash(self) -> str:
        """SHA-256 of names and values: what a dataset says it was sampled around."""
        digest = hashlib.sha256()
        for curve in self.curves:
            digest.update(f"{curve.name}\0{len(curve.time)}\0".encode())
            digest.update(curve.time.astype("<f8").tobytes())
            digest.update(curve.values.astype("<f8").tobytes())
        return digest.hexdigest()
