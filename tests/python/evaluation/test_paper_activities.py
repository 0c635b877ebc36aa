# SPDX-License-Identifier: Apache-2.0
"""The paper's Tables 3 to 5 as data, against what its text says of them, and comparisons with them."""

import math

import pytest

from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.evaluation.paper_activities import (
    PAPER_KINEMATICS,
    PAPER_KINEMATICS_COLUMNS,
    PAPER_LOADS,
    PAPER_TIMES,
    activity_comparison,
    paper_activity,
    printed_error,
)
from condyle.evaluation.simulation_errors import KINEMATICS

KINDS = tuple(PAPER_TIMES)


def row(activity, quantity, rmse, largest, **more):
    return {
        "activity": activity, "quantity": quantity, "unit": "N", "count": 9, "rmse": rmse,
        "max_error": largest, "r2": 0.9, **more,
    }  # fmt: skip


def every(side, columns):
    """RMSEs and largest errors of a side over all activities."""
    cells = [PAPER_LOADS[kind, side][LOAD_COLUMNS.index(c)] for kind in KINDS for c in columns]
    return [rmse for rmse, _ in cells], [largest for _, largest in cells if largest is not None]


def test_the_loads_agree_with_what_the_papers_text_says_of_them():
    forces, moments = ("Fx", "Fy", "Fz"), ("Mx", "My", "Mz")
    for side, force, moment in (("medial", 5.6, 0.17), ("lateral", 9.9, 0.26)):
        assert max(every(side, forces)[0]) == force
        assert max(every(side, moments)[0]) == moment
    largest = {kind: max(m for s in SIDES for m in every(s, kind)[1]) for kind in (forces, moments)}
    assert largest == {forces: 47, moments: 1.4}
    assert PAPER_LOADS["right-turn", "lateral"][1] == (9.9, 47)
    # "during gait simulations (1.9 N/0.063 Nm)": means over components and sides.
    gait = [[rmse for rmse, _ in PAPER_LOADS["normal gait", side]] for side in SIDES]
    assert round(sum(sum(g[:3]) for g in gait) / 6, 1) == 1.9
    assert round(sum(sum(g[3:]) for g in gait) / 6, 3) == 0.063


def test_the_kinematics_agree_with_what_the_papers_text_says_of_them():
    turn = dict(zip(PAPER_KINEMATICS_COLUMNS, PAPER_KINEMATICS["right-turn"], strict=True))
    for columns, rmse, largest in (
        (PAPER_KINEMATICS_COLUMNS[:3], ("lateral_tibial_translation", 0.13), ("anterior_tibial_translation", 0.90)),
        (PAPER_KINEMATICS_COLUMNS[3:], ("tibial_external_rotation", 0.17), ("tibial_external_rotation", 1.27)),
    ):  # fmt: skip
        places = [PAPER_KINEMATICS_COLUMNS.index(c) for c in columns]
        cells = [PAPER_KINEMATICS[kind][i] for kind in KINDS for i in places]
        assert max(r for r, _ in cells) == turn[rmse[0]][0] == rmse[1]
        assert max(m for _, m in cells) == turn[largest[0]][1] == largest[1]


def test_the_times_agree_with_each_other():
    for times in PAPER_TIMES.values():
        assert round(times.reference_min / times.surrogate_min, 1) == times.speed_improvement
        assert times.surrogate_real_time == pytest.approx(
            times.reference_real_time * times.reference_min / times.surrogate_min
        )
    assert PAPER_TIMES["normal gait"].surrogate_real_time == pytest.approx(1.2 / 270)


def test_every_activity_is_whole_and_no_rmse_is_above_its_largest_error():
    assert set(PAPER_LOADS) == {(kind, side) for kind in KINDS for side in SIDES}
    assert set(PAPER_KINEMATICS) == set(KINDS)
    assert set(PAPER_KINEMATICS_COLUMNS) == {name for name, _, _ in KINEMATICS}
    rows = [*PAPER_LOADS.values(), *PAPER_KINEMATICS.values()]
    assert {len(cells) for cells in rows} == {6}
    assert all(rmse <= m for cells in rows for rmse, m in cells if m is not None)
    # One cell of the text is not legible.
    assert [cell for cells in rows for cell in cells if cell[1] is None] == [(0.02, None)]
    assert printed_error("normal gait", "lateral_My") == (0.02, None)


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("iso_like_gait", "normal gait"),
        ("DM_ngait_og1", "normal gait"),
        ("turn_like_gait", "right-turn"),
        ("RightTurn", "right-turn"),
        ("gait_and_return", "normal gait"),
        ("chair_rise_like", "rising from a chair"),
        ("squat_like", "squat"),
        ("DM_crouch_tm1", "squat"),
        ("DM_smooth1", None),
        ("leg_swing_like", None),
    ],
)
def test_an_activity_is_of_the_kind_that_its_name_says(name, kind):
    assert paper_activity(name) == kind


def test_each_printed_figure_is_compared_and_only_those():
    rows = [
        row("gait", "medial_Fy", 4.2, 14.001),
        row("gait", "lateral_My", 0.03, 79.0),
        row("gait", "patella_Fy", 9.0, 9.0),
        row("stairs", "medial_Fy", 9.0, 9.0),
        row("squat", "distraction", 0.004, 0.02, contact="hybrid"),
    ]
    found = {
        (c["activity"], c["contact"], c["quantity"], c["measure"]): c
        for c in activity_comparison(rows)
    }
    assert {key: c["above"] for key, c in found.items()} == {
        ("gait", "surrogate", "medial_Fy", "rmse"): False,
        ("gait", "surrogate", "medial_Fy", "max_error"): True,
        ("gait", "surrogate", "lateral_My", "rmse"): True,
        ("squat", "hybrid", "distraction", "rmse"): False,
        ("squat", "hybrid", "distraction", "max_error"): True,
    }
    largest = found["gait", "surrogate", "medial_Fy", "max_error"]
    assert (largest["paper_activity"], largest["paper"], largest["value"]) == (
        "normal gait",
        14,
        14.001,
    )


@pytest.mark.parametrize(
    ("value", "above"), [(0.0, False), (0.004999, False), (0.005, True), (math.nan, True)]
)
def test_a_printed_zero_is_below_half_of_its_last_digit(value, above):
    assert printed_error("normal gait", "flexion") == (0.0, 0.0)
    found = activity_comparison([row("gait", "flexion", value, value)])
    assert [c["above"] for c in found] == [above, above]


def test_what_is_not_a_number_is_above_and_what_has_no_time_frame_is_not_compared():
    assert [c["above"] for c in activity_comparison([row("gait", "medial_Fx", math.nan, 1.0)])] == [
        True,
        False,
    ]
    assert activity_comparison([row("gait", "medial_Fx", 0.0, 0.0, count=0)]) == []
