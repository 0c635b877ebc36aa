# SPDX-License-Identifier: Apache-2.0

import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.sampling import CURVE_COLUMNS, PRESCRIBED_COLUMNS, ReferenceCurve, ReferenceCurves


def activity(count: int = 17) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    wrenches = rng.normal(size=(count, 2, 6)) * 300.0
    return np.linspace(0.3, 1.4, count), rng.normal(size=(count, 6)) * 0.1, wrenches


def test_simulated_activities_carry_the_pose_and_the_total_loads() -> None:
    time, poses, wrenches = activity()
    curves = ReferenceCurves.from_activities({"walk": (time, poses, wrenches)})
    (curve,) = curves.curves
    assert np.array_equal(curve.values[:, :6], poses)
    assert np.array_equal(curve.column("Fy"), wrenches[:, 0, 1] + wrenches[:, 1, 1])
    assert np.array_equal(curve.column("Mx"), wrenches[:, 0, 3] + wrenches[:, 1, 3])
    table = curves.table(PRESCRIBED_COLUMNS)
    assert np.array_equal(table[:, 0], poses[:, 0])
    assert np.array_equal(table[:, 5], poses[:, 5])


def test_content_hash_depends_on_names_and_values(curves: ReferenceCurves) -> None:
    walk, squat = curves.curves
    moved = squat.values.copy()
    moved[3, 2] = np.nextafter(moved[3, 2], 1)
    others = [
        ReferenceCurves((walk,)),
        ReferenceCurves((squat, walk)),
        ReferenceCurves((walk, ReferenceCurve("squat", squat.time, moved))),
        ReferenceCurves((walk, ReferenceCurve("chair", squat.time, squat.values))),
    ]
    assert len({curves.content_hash(), *(other.content_hash() for other in others)}) == 5


@pytest.mark.parametrize("frames", [903, 17, 4])
def test_resampled_curves_share_the_time_frames_and_stay_on_the_curve(
    curves: ReferenceCurves, frames: int
) -> None:
    resampled = curves.resampled(frames)
    assert sum(len(curve.time) for curve in resampled.curves) == frames
    for before, after in zip(curves.curves, resampled.curves, strict=True):
        assert (after.time[0], after.time[-1]) == (before.time[0], before.time[-1])
        assert np.array_equal(after.values[[0, -1]], before.values[[0, -1]])
        for column in range(len(CURVE_COLUMNS)):
            expected = np.interp(after.time, before.time, before.values[:, column])
            np.testing.assert_array_equal(after.values[:, column], expected)


def test_longer_activities_get_more_of_the_time_frames() -> None:
    time, poses, wrenches = activity()
    curves = ReferenceCurves.from_activities(
        {"short": (time, poses, wrenches), "long": (3 * time, poses, wrenches)}
    )
    assert [len(curve.time) for curve in curves.resampled(804).curves] == [202, 602]


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        (0, np.nan, "'walk': x is nan at time frame 5; a finite value of at most 1 m"),
        (1, 31.0, "'walk': y is 31 at time frame 5; a finite value of at most 1 m"),
        (5, -35.0, "'walk': theta_z is -35 at time frame 5; a finite value of at most 3.14159 rad"),
        (6, np.inf, "'walk': Fy is inf at time frame 5; a finite value of at most 100000 N"),
    ],
)
def test_values_that_are_not_a_knees_are_named(column: int, value: float, message: str) -> None:
    values = np.full((9, 8), 0.1)
    values[5, column] = value
    with pytest.raises(InputDataError, match=message):
        ReferenceCurve("walk", np.arange(9.0), values)


def test_time_that_turns_back_is_named() -> None:
    time = np.arange(9.0)
    time[6] = 4.5
    with pytest.raises(InputDataError, match=r"time does not increase at time frame 6 \(4\.5 s\)"):
        ReferenceCurve("walk", time, np.full((9, 8), 0.1))


def test_wrong_shapes_and_sets_are_refused() -> None:
    time, poses, wrenches = activity()
    with pytest.raises(InputDataError, match=r"\(17, 6\) and \(17, 2, 6\) are needed"):
        ReferenceCurves.from_activities({"walk": (time, poses[:-1], wrenches)})
    with pytest.raises(InputDataError, match=r"\(n,\) and \(n, 8\) are needed"):
        ReferenceCurve("walk", time, poses)
    with pytest.raises(InputDataError, match="at least one activity is needed"):
        ReferenceCurves(())
    curve = ReferenceCurve("walk", time, np.full((17, 8), 0.1))
    with pytest.raises(InputDataError, match="'walk' is there twice"):
        ReferenceCurves((curve, curve))
    with pytest.raises(InputDataError, match="1 time frames; at least 2 are needed"):
        ReferenceCurve("walk", time[:1], np.full((1, 8), 0.1))
    with pytest.raises(InputDataError, match="cannot share 1 time frames"):
        ReferenceCurves((curve,)).resampled(1)
