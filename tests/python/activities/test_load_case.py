# SPDX-License-Identifier: Apache-2.0
"""Reading load cases: one conversion, and errors that name file, line, column and value."""

from pathlib import Path

import numpy as np
import pytest

from condyle.activities import LoadCase, load_case
from condyle.errors import InputDataError

HEADER = "time_s,flexion_deg,axial_force_N,ap_force_N,ie_torque_Nm"


def write(folder: Path, *lines: str) -> Path:
    file = folder / "own.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def test_degrees_become_radians_and_columns_may_be_in_any_order(tmp_path: Path) -> None:
    file = write(
        tmp_path,
        "# my own",
        "flexion_deg,note,time_s,ie_torque_Nm,ap_force_N,axial_force_N",
        "10,7,0,0.3,-20,400",
        "30,8,0.5,-0.7,25,900",
    )
    case = load_case(file)
    assert case.name == "own"
    np.testing.assert_allclose(case.flexion, [np.pi / 18.0, np.pi / 6.0], rtol=1e-15)
    np.testing.assert_array_equal(case.time, [0.0, 0.5])
    np.testing.assert_array_equal(case.axial_force, [400.0, 900.0])
    np.testing.assert_array_equal(case.ap_force, [-20.0, 25.0])
    np.testing.assert_array_equal(case.ie_torque, [0.3, -0.7])


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ((HEADER, "0,1,2,3,4", "1,x,2,3,4"), "line 3, column flexion_deg: 'x' is not a number"),
        ((HEADER, "0,1,nan,3,4"), "line 2, column axial_force_N is nan: must be finite"),
        ((HEADER, "0,1,2,3"), "line 2 has 4 values; the header has 5"),
        (
            (HEADER.replace("ap_force_N", "ap"), "0,1,2,3,4"),
            "column ap_force_N is missing; found time_s",
        ),
        (
            (HEADER, "0,1,2,3,4", "0,1,2,3,4"),
            "time_s in row 1 is 0.0: must be above the row before",
        ),
        ((HEADER, "0,1,-2,3,4"), "axial_force_N in row 0 is -2.0: must be at least 0"),
        ((HEADER, "0,400,2,3,4"), "flexion_deg in row 0 is 400.0: must lie within"),
        ((HEADER,), "has no rows"),
        (("# nothing",), "has no header line"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, lines: tuple[str, ...], message: str) -> None:
    file = write(tmp_path, *lines)
    with pytest.raises(InputDataError) as caught:
        load_case(file)
    assert message in str(caught.value)
    assert str(file) in str(caught.value)


def test_unknown_name_lists_the_built_in_ones() -> None:
    with pytest.raises(
        InputDataError,
        match="'hop': no such file, and not one of iso_like_gait, turn_like_gait, leg_swing_like, "
        "chair_rise_like, squat_like",
    ):
        load_case("hop")


def test_arrays_of_different_length_are_refused() -> None:
    with pytest.raises(
        InputDataError, match=r"'mine': ap_force has shape \(3,\); \(2,\) is needed"
    ):
        LoadCase("mine", *[np.zeros(2)] * 3, np.zeros(3), np.zeros(2))
