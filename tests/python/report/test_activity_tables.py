# SPDX-License-Identifier: Apache-2.0
"""Tables of simulated activities: known errors and times show, and bold is exactly what is worse than the paper's."""

import numpy as np
import pytest

from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.evaluation import kinematics_error_table, simulation_load_error_table
from condyle.evaluation.paper_activities import (
    PAPER_KINEMATICS,
    PAPER_KINEMATICS_COLUMNS,
    PAPER_LOADS,
    PAPER_TIMES,
)
from condyle.report import render_tables
from condyle.report.activity_errors import kinematics_markdown, loads_markdown
from condyle.report.activity_times import phases_markdown, times_markdown
from condyle.report.equilibrium_failures import failures_markdown

RNG = np.random.default_rng(21)
NAMES = {
    "normal gait": "DM_ngait_og1",
    "right-turn": "turn_like_gait",
    "rising from a chair": "chair_rise_like",
    "squat": "DM_crouch_tm1",
}


def table(text, number=0):
    """The cells of a Markdown table of a text, header first."""
    blocks, block = [], []
    for line in [*text.splitlines(), ""]:
        if line.startswith("| "):
            block.append([cell.strip() for cell in line.strip("|").split("|")])
        elif not line.startswith("|--") and block:
            blocks.append(block)
            block = []
    return blocks[number]


def row(activity, quantity, rmse, largest, **more):
    return {
        "activity": activity, "quantity": quantity, "unit": "N", "count": 9, "rmse": rmse,
        "max_error": largest, "r2": 0.98765, **more,
    }  # fmt: skip


def loads_row(text, *labels):
    return next(r for r in table(text) if r[: len(labels)] == list(labels))


def test_known_errors_of_loads_stand_beside_the_papers_in_its_order():
    reference = RNG.uniform(1.0, 900.0, (20, 2, 6))
    errors = np.arange(1.0, 13.0).reshape(2, 6) / 64.0
    alternating = np.where(np.arange(20) % 2, 1.0, -1.0)[:, None, None]
    text = loads_markdown(
        simulation_load_error_table("iso_like_gait", reference, reference + alternating * errors)
    )
    assert table(text)[0] == [
        "activity", "side", "contact", "Fx [N]", "Fy [N]", "Fz [N]", "Mx [Nm]", "My [Nm]", "Mz [Nm]",
    ]  # fmt: skip
    shown = [cell.replace("*", "") for cell in loads_row(text, "iso_like_gait", "lateral")]
    assert shown == ["iso_like_gait", "lateral", "surrogate"] + [
        f"{e:.3g} ({e:.3g})" for e in errors[1]
    ]
    papers = [r for r in table(text) if r[2] == "paper, normal gait"]
    assert papers[0] == [
        "", "", "paper, normal gait", "0.5 (2.2)", "4.2 (14)", "1.1 (11)", "0.17 (1.4)", "0.02 (0.09)", "0.04 (0.17)",
    ]  # fmt: skip
    assert papers[1][7] == "0.02 (–)"
    assert "The largest error of lateral My in the paper's normal gait is left out" in text
    assert "of another implant, subject and activity" in text


def test_known_errors_of_kinematics_stand_in_the_papers_order_and_units():
    reference = RNG.normal(0.0, 0.01, (20, 6))
    shift = np.array([*np.radians([0.25, 0.5, 1.5]), 2e-3, 3e-3, 4e-3])
    text = kinematics_markdown(kinematics_error_table("stairs", reference, reference + shift))
    header, line = table(text)
    assert header[2:] == [
        "anterior tibial translation [mm]",
        "distraction [mm]",
        "lateral tibial translation [mm]",
        "flexion [deg]",
        "adduction [deg]",
        "tibial external rotation [deg]",
    ]
    assert line == [
        "stairs",
        "surrogate",
        "2 (2)",
        "3 (3)",
        "4 (4)",
        "0.25 (0.25)",
        "0.5 (0.5)",
        "1.5 (1.5)",
    ]
    assert "No activity here is of a kind that the paper's Table 4 has." in text
    assert "paper, " not in text


def printed_tables():
    """Every printed error as if it were ours, its table's function with it."""
    for (kind, side), cells in PAPER_LOADS.items():
        for load, cell in zip(LOAD_COLUMNS, cells, strict=True):
            yield kind, f"{side}_{load}", cell, loads_markdown
    for kind, cells in PAPER_KINEMATICS.items():
        for quantity, cell in zip(PAPER_KINEMATICS_COLUMNS, cells, strict=True):
            yield kind, quantity, cell, kinematics_markdown


def test_errors_as_printed_are_not_bold_and_the_verdict_says_none_is_above():
    rows = {loads_markdown: [], kinematics_markdown: []}
    for kind, quantity, (rmse, largest), render in printed_tables():
        rows[render].append(row(NAMES[kind], quantity, rmse, 80.0 if largest is None else largest))
    assert "0 of 95 figures are above the paper's. " in loads_markdown(rows[loads_markdown])
    assert "0 of 48 figures are above the paper's. " in kinematics_markdown(
        rows[kinematics_markdown]
    )
    for render, given in rows.items():
        assert "*" not in render(given)


@pytest.mark.parametrize("measure", ["rmse", "max_error"])
def test_exactly_the_figure_above_the_papers_is_bold(measure):
    for kind, quantity, (rmse, largest), render in printed_tables():
        if measure == "max_error" and largest is None:
            continue
        values = {"rmse": rmse, "max_error": 80.0 if largest is None else largest}
        values[measure] = max(values[measure] * 1.001, 0.005)
        mine = row(NAMES[kind], quantity, values["rmse"], values["max_error"])
        others = [row(NAMES[kind], q, 0.0, 0.0) for q in quantities(render) if q != quantity]
        text = render([*others, mine])
        bold = [cell for line in table(text) for cell in line if "*" in cell]
        assert len(bold) == 1
        shown = bold[0].partition(" ")[0 if measure == "rmse" else 2]
        assert shown.strip("()").startswith("**")
        assert shown.strip("()").endswith("**")
        assert bold[0].count("*") == 4
        name = {"rmse": "RMSE", "max_error": "maximum"}[measure]
        assert f"(bold): {NAMES[kind]} surrogate {quantity} {name}." in text


def quantities(render):
    if render is kinematics_markdown:
        return PAPER_KINEMATICS_COLUMNS
    return [f"{side}_{load}" for side in SIDES for load in LOAD_COLUMNS]


def test_r2_of_every_quantity_is_shown_with_every_contact_model():
    rows = [
        row("gait", q, 0.1, 0.2, contact=contact) | {"r2": None if q == "medial_Mz" else r2}
        for contact, r2 in (("surrogate", 0.98765), ("hybrid", 0.9999912))
        for q in quantities(loads_markdown)
    ]
    text = loads_markdown(rows)
    assert table(text, 1) == [
        ["activity", "side", "contact", *LOAD_COLUMNS],
        ["gait", "medial", "surrogate", *["0.98765"] * 5, "–"],
        ["gait", "medial", "hybrid", *["0.99999"] * 5, "–"],
        ["gait", "lateral", "surrogate", *["0.98765"] * 6],
        ["gait", "lateral", "hybrid", *["0.99999"] * 6],
    ]
    assert "above 0.99 on the medial side and above 0.98 on the lateral side" in text
    # Both contact models, then the paper's.
    assert [r[2] for r in table(text)[1:4]] == ["surrogate", "hybrid", "paper, normal gait"]


def test_time_frames_left_out_are_told_and_an_error_of_none_is_not_zero():
    rows = [
        row("gait", "medial_Fy", 1.0, 2.0, excluded=3),
        row("squat", "medial_Fy", 0.0, 0.0, count=0, excluded=7),
    ]
    text = loads_markdown(rows)
    assert (
        "**Time frames left out of these errors**: 3 of 12 in gait (surrogate), 7 of 7 in squat (surrogate)."
        in text
    )
    assert loads_row(text, "squat", "medial")[3:6] == ["–", "–", "–"]
    assert loads_row(text, "gait", "medial")[3:6] == ["–", "1 (2)", "–"]
    assert "left out of these" not in loads_markdown(
        [row("gait", "medial_Fy", 1.0, 2.0, excluded=0)]
    )


def test_other_quantities_have_a_table_of_their_own():
    text = loads_markdown([row("gait", "patella_Fy", 1.25, 2.5, contact="hybrid")])
    assert table(text)[1] == ["gait", "hybrid", "patella_Fy", "N", "1.25", "2.5", "0.9877"]
    assert "Table 3" not in text


def times_row(**more):
    return {"what": "w", "activity": "gait", "reference_s": 3.0, "surrogate_s": 0.5} | more


def test_times_stand_in_the_papers_form_and_what_is_slower_than_the_paper_is_bold():
    known = {"time_frames": 60, "duration_s": 1.5}
    calls = {"evaluations": 300, "reference_evaluations": 7, "untrusted_time_frames": 2}
    text = times_markdown(
        [
            times_row(contact="hybrid", **known, **calls),
            times_row(surrogate_s=2.0, **known),
            times_row(reference_s=1.5e4, surrogate_s=4e3, **known),
        ]
    )
    assert [line[1:] for line in table(text)[1:]] == [
        ["hybrid", "60", "1.5", "3", "0.5", "6", "0.5", "3", "300 (7)", "2"],
        ["surrogate", "60", "1.5", "3", "2", "**1.5**", "0.5", "0.75", "–", "–"],
        ["surrogate", "60", "1.5", "15000", "4000", "3.75", "**0.0001**", "**0.000375**", "–", "–"],
        ["paper, normal gait", "146", "1.2", "816 (13.6 min)", "270 (4.5 min)", "3", "0.00147", "0.00444", "–", "–"],
    ]  # fmt: skip
    assert "3 of 9 ratios are below the paper's (bold)." in text


def test_a_ratio_as_the_papers_is_not_below_it():
    for kind, paper in PAPER_TIMES.items():
        same = times_row(
            activity=NAMES[kind],
            reference_s=60.0 * paper.surrogate_min * paper.speed_improvement,
            surrogate_s=60.0 * paper.surrogate_min,
            duration_s=paper.duration_s,
        )
        # The printed improvement is rounded, so the reference may stand on either side of its own time.
        text = times_markdown(
            [same | {"reference_s": min(same["reference_s"], 60.0 * paper.reference_min)}]
        )
        bold = [cell for line in table(text) for cell in line if "*" in cell]
        assert len(bold) == (paper.reference_min / paper.surrogate_min < paper.speed_improvement)


def test_times_without_the_new_keys_are_shown_as_before():
    old = {"what": "gait, 101 time frames", "reference_s": 3.0, "surrogate_s": 0.5}
    line = ["gait, 101 time frames", "surrogate", "3", "0.5", "6", "–", "–"]
    assert table(times_markdown([old]))[1] == line
    assert "paper" not in times_markdown([old])
    assert "\n## Wall times, one thread, this machine\n" in render_tables("knee", {"times": [old]})
    # Both kinds at once: each in its own table.
    both = times_markdown([old, times_row(activity="stairs")])
    assert table(both, 1)[1] == line
    assert table(both)[1] == ["stairs", "surrogate", "–", "–", "3", "0.5", "6", "–", "–", "–", "–"]
    assert phases_markdown([old]) == ""


def test_time_by_phase_is_per_time_frame_with_shares_and_the_reference_once():
    common = {"time_frames": 100, "reference_phases_s": {"paths": 0.01, "contact": 0.03}}
    rows = [
        times_row(phases_s={"paths": 0.01, "linear_algebra": 0.0}, **common),
        times_row(contact="hybrid", phases_s={"paths": 0.02, "contact": 0.06}, **common),
        times_row(activity="stairs", phases_s={"paths": 0.02}),
    ]
    assert table(phases_markdown(rows)) == [
        ["activity", "contact", "paths", "contact", "linear algebra", "all"],
        ["gait", "reference", "100 (25%)", "300 (75%)", "–", "400"],
        ["gait", "surrogate", "100 (100%)", "–", "0 (0%)", "100"],
        ["gait", "hybrid", "200 (25%)", "600 (75%)", "–", "800"],
        ["stairs", "surrogate", "– (100%)", "–", "–", "–"],
    ]


def failure(i, **more):
    return {
        "activity": "gait", "contact": "surrogate", "time_s": 2.4 + i / 100, "status": "not_converged",
        "worst_coordinate": "knee_tx_r", "message": f"residual {i} N\n is above 0.1 N",
    } | more  # fmt: skip


def test_time_frames_not_in_equilibrium_are_loud_and_come_before_the_errors():
    rows = [failure(i) for i in range(12)] + [failure(0, activity="squat", contact="hybrid")]
    text = render_tables(
        "knee", {"unconverged": rows, "simulation_loads": [row("gait", "medial_Fy", 1.0, 2.0)]}
    )
    assert text.index("## NOT in equilibrium: 13 time frames") < text.index(
        "## Simulated activities"
    )
    assert (
        "**13 time frames are not in equilibrium: 12 of gait (surrogate), 1 of squat (hybrid)."
        in text
    )
    told = [line for line in text.splitlines() if line.startswith("- ")]
    assert len(told) == 10
    assert told[1] == (
        "- gait (surrogate), 2.41 s: not_converged, worst in knee_tx_r: residual 1 N is above 0.1 N"
    )
    assert "These are the first 10 of 13; tables.json has all." in text


def test_few_failures_are_all_told_and_none_says_nothing():
    text = failures_markdown([failure(3, worst_coordinate="", status="recruitment_failed")])
    assert text.startswith(
        "## NOT in equilibrium: 1 time frame\n\n**1 time frame is not in equilibrium: 1 of gait"
    )
    assert "2.43 s: recruitment_failed: residual 3 N is above 0.1 N\n" in text
    assert "first 10" not in text
    assert failures_markdown([]) == ""
    assert render_tables("knee", {"unconverged": []}) == "# knee\n"
