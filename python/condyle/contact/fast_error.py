# SPDX-License-Identifier: Apache-2.0
"""How far the ``fast`` evaluation of a pair is from ``exact``: measured once, and kept beside its distance field.

Poses are drawn about the pair's own seated pose, over what a knee replacement meets in gait and stairs: flexion 0-65°,
rotations ±7° about y and ±1° about x, ±4 mm along x and ±1.5 mm along z, pressed down to a total of 20-3500 N, drawn
log-uniformly. The tolerance is 0.2 % + 0.5 N of a force and 0.2 % + 0.02 Nm of a moment.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from condyle._core import contact as _contact
from condyle.errors import InputDataError
from condyle.whole_files import content_hash, to_canonical_json, write_whole

#: Raise when what is measured, or how, changes: records of other versions are then not found.
_VERSION: Final = 1
#: The 99th percentile is the fourth worst; two or three seconds, most of it the making of ``exact``.
_POSES: Final = 400


@dataclass(frozen=True)
class WrenchError:
    """Errors of all sides, or of all totals, over some poses.

    Attributes:
        count: wrenches compared, those that carry force.
        force_median, force_p99, force_worst: |ΔF|/|F|, over wrenches with at least 20 N.
        moment_median, moment_p99, moment_worst: |ΔM|/|M|, over the same.
        force_of_tolerance_p99, force_of_tolerance_worst: |ΔF| over the tolerance; at most 1 where it holds.
        moment_of_tolerance_p99, moment_of_tolerance_worst: |ΔM| over the tolerance.
        worst_pose: x, y, z [m], θx, θy, θz [rad] where error over tolerance is largest.
    """

    count: int
    force_median: float
    force_p99: float
    force_worst: float
    force_of_tolerance_p99: float
    force_of_tolerance_worst: float
    moment_median: float
    moment_p99: float
    moment_worst: float
    moment_of_tolerance_p99: float
    moment_of_tolerance_worst: float
    worst_pose: tuple[float, ...]


@dataclass(frozen=True)
class LoadRangeError:
    """Errors of the poses whose total force lies between two values [N]; the outermost ranges are open."""

    from_force: float
    to_force: float
    sides: WrenchError
    total: WrenchError


@dataclass(frozen=True)
class FastError:
    """How far a pair's ``fast`` evaluation is from its ``exact`` one.

    Attributes:
        status: "measured", or "not measured: " and why.
        spacing: of the distance field [m].
        poses: compared.
        sides: over all sides that carry force; None if not measured.
        total: over both sides together; None if not measured.
        by_load: the same by total force.
    """

    status: str
    spacing: float
    poses: int = 0
    sides: WrenchError | None = None
    total: WrenchError | None = None
    by_load: tuple[LoadRangeError, ...] = ()

    def sentence(self) -> str:
        """What a user is told, in a line."""
        if self.total is None:
            return f"fast evaluation: error against exact {self.status}"
        t = self.total
        return (
            f"fast evaluation: 99th percentile error against exact {t.force_p99:.2%} of force and "
            f"{t.moment_p99:.2%} of moment ({t.force_of_tolerance_p99:.2f} of 0.2 % + 0.5 N, "
            f"{t.moment_of_tolerance_p99:.2f} of 0.2 % + 0.02 Nm) over {self.poses} plausible poses"
        )

    def to_json(self) -> dict[str, Any]:
        """As plain values."""
        return dataclasses.asdict(self)

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> FastError:
        """The inverse of :meth:`to_json`.

        Raises:
            TypeError, KeyError: a field is missing, or one too many.
        """
        fields = dict(value)
        for part in ("sides", "total"):
            if fields[part] is not None:
                fields[part] = _wrench_error(fields[part])
        fields["by_load"] = tuple(
            LoadRangeError(
                **{
                    **row,
                    "sides": _wrench_error(row["sides"]),
                    "total": _wrench_error(row["total"]),
                }
            )
            for row in fields["by_load"]
        )
        return cls(**fields)


def _wrench_error(fields: dict[str, Any]) -> WrenchError:
    return WrenchError(**{**fields, "worst_pose": tuple(fields["worst_pose"])})


def _wrench_error_of(found: _contact.WrenchDeviations) -> WrenchError:
    numbers = {}
    for kind in ("force", "moment"):
        deviations = getattr(found, kind)
        for name in ("median", "p99", "worst"):
            numbers[f"{kind}_{name}"] = getattr(deviations, name)
        for name in ("p99", "worst"):
            numbers[f"{kind}_of_tolerance_{name}"] = getattr(deviations, f"tolerance_{name}")
    return WrenchError(count=found.count, worst_pose=tuple(found.worst_pose.tolist()), **numbers)


def measure_fast_error(
    fast: _contact.ContactModel,
    exact: Callable[[], _contact.ContactModel],
    *,
    spacing: float,
    poses: int = _POSES,
    threads: int = 0,
) -> FastError:
    """Compares two evaluations of one pair about its seated pose.

    Args:
        fast: the one to be judged.
        exact: makes the one to judge by; called only if the pair can be seated.
        spacing: of the distance field [m], for the record.
        poses: to draw.
        threads: 0 means all cores. The result does not depend on it.

    Returns:
        The error; where the pair has no seat or its poses carry no load, a record that says so.
    """
    # On the same layer, and needed only here.
    from condyle.fdk.seating import seated_pose

    seat = seated_pose(fast)
    if not seat.converged:
        return FastError(f"not measured: no seated pose ({seat.advice})", spacing)
    box = _contact.PlausiblePoses()
    box.settled, box.count = seat.pose, poses
    drawn = _contact.plausible_poses(fast, box, threads)
    if len(drawn) < poses / 2:
        reason = f"only {len(drawn)} of {poses} poses about the seat carry the load drawn"
        return FastError(f"not measured: {reason}", spacing)
    report = _contact.measure_accuracy(fast, exact(), drawn, threads)
    return FastError(
        "measured",
        spacing,
        len(drawn),
        _wrench_error_of(report.sides),
        _wrench_error_of(report.total),
        tuple(
            LoadRangeError(
                row.from_force,
                row.to_force,
                _wrench_error_of(row.sides),
                _wrench_error_of(row.total),
            )
            for row in report.by_load
        ),
    )


def stored_fast_error(
    directory: Path, pair: dict[str, Any], measure: Callable[[], FastError]
) -> FastError:
    """The record of a pair from ``directory``; measured and put there if no valid one is.

    A file is named by the content of ``pair``, says it again inside, and holds a checksum of everything else in it. One
    that is damaged or says anything else is measured anew and replaced, never used. A directory that cannot be written
    to costs the record, not the result.

    Args:
        directory: where distance fields are kept.
        pair: whatever the error depends on, as plain values: meshes and their law by content, field, integration.
        measure: measures it.
    """
    of = {"version": _VERSION, "poses": _POSES, **pair}
    file = directory / f"{content_hash(to_canonical_json(of).encode())[:32]}.fast_error.json"
    known = _read(file, of)
    if known is not None:
        return known
    error = measure()
    content = {"of": of, "fast_error": error.to_json()}
    with contextlib.suppress(InputDataError):
        write_whole(file, to_canonical_json({**content, "sha256": _checksum(content)}) + "\n")
    return error


def _checksum(content: dict[str, Any]) -> str:
    return content_hash(to_canonical_json(content).encode())


def _read(file: Path, of: dict[str, Any]) -> FastError | None:
    try:
        content = json.loads(file.read_bytes())
        checksum = content.pop("sha256")
        if content["of"] != of or checksum != _checksum(content):
            return None
        return FastError.from_json(content["fast_error"])
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return None
