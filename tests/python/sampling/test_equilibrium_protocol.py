# SPDX-License-Identifier: Apache-2.0
import dataclasses

import numpy as np
import pytest
from spring_contact import SpringSolver

from condyle.errors import CondyleError, InputDataError
from condyle.sampling import PRESCRIBED_COLUMNS, Prescribed
from condyle.sampling.equilibrium_protocol import check_solved

VALUES = np.random.default_rng(6).normal(size=(7, 6)) * 0.01 + np.array([0, 500, 0, 2, 0, -0.4])


def test_columns_go_to_the_fields_of_their_names_and_back() -> None:
    prescribed = Prescribed.from_array(VALUES)
    assert len(prescribed) == 7
    for i, name in enumerate(PRESCRIBED_COLUMNS):
        assert np.array_equal(getattr(prescribed, name), VALUES[:, i])
    assert np.array_equal(prescribed.to_array(), VALUES)
    rows = VALUES[:, 0] > 0
    assert 0 < rows.sum() < 7
    assert np.array_equal(prescribed.select(rows).to_array(), VALUES[rows])


def test_fields_of_other_lengths_are_refused() -> None:
    with pytest.raises(InputDataError, match=r"prescribed Mx has shape \(6,\); \(7,\) is needed"):
        dataclasses.replace(Prescribed.from_array(VALUES), Mx=VALUES[1:, 3])


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("poses", np.zeros((7, 5)), r"poses of shape \(7, 5\); \(7, 6\) was expected"),
        ("wrenches", np.zeros((7, 12)), r"wrenches of shape \(7, 12\); \(7, 2, 6\)"),
        ("evaluations", np.zeros(6), r"evaluations of shape \(6,\); \(7,\)"),
        ("max_depth", np.zeros(6), r"max_depth of shape \(6,\); \(7,\)"),
        ("status", np.array(["fine"] * 7), "status 'fine'; known are converged, no_equilibrium"),
    ],
)
def test_an_answer_against_the_protocol_is_refused(
    field: str, value: np.ndarray, message: str
) -> None:
    solved = SpringSolver()(Prescribed.from_array(VALUES))
    check_solved(solved, 7)
    with pytest.raises(CondyleError, match=message):
        check_solved(dataclasses.replace(solved, **{field: value}), 7)


def test_a_pose_or_a_tilt_may_be_prescribed_instead_of_loads() -> None:
    poses = np.arange(18.0).reshape(3, 6)
    whole = Prescribed.from_poses(poses)
    assert whole.pose_given
    assert whole.theta_x_given
    assert np.array_equal(whole.to_poses(), poses)
    assert np.all(np.isnan(whole.Fy) & np.isnan(whole.Mx))
    chosen = whole.select(np.array([True, False, True]))
    assert np.array_equal(chosen.to_poses(), poses[[0, 2]])
    loads = Prescribed.from_array(poses)
    assert not loads.theta_x_given
    assert np.all(np.isnan(loads.to_poses()[:, [1, 3]]))


def test_rows_that_differ_in_what_is_prescribed_are_refused() -> None:
    one = np.ones(2)
    with pytest.raises(InputDataError, match="theta_x is NaN in row 1 and not in all"):
        Prescribed(one, one, one, one, one, one, theta_x=np.array([0.1, np.nan]))
    with pytest.raises(InputDataError, match="y is given and theta_x is not"):
        Prescribed(one, one, one, one, one, one, y=one)
