# SPDX-License-Identifier: Apache-2.0
"""Figures of activities, muscles and comparisons: panels, labels and lines, not pixels."""

import numpy as np
import pytest

from condyle.errors import InputDataError

pytest.importorskip("matplotlib")

from condyle.report.activity_figures import (
    ActivityTraces,
    MeasuredForces,
    compressive_forces_figure,
    knee_kinematics_figure,
)
from condyle.report.comparison_figure import KinematicsCurve, comparison_figure
from condyle.report.muscle_figure import MuscleForces, muscle_forces_figure
from condyle.report.simulation_figures import Trace
from condyle.report.style import COLOURS, house_style, save

RNG = np.random.default_rng(31)
TIME = 2.4 + np.linspace(0.0, 0.9, 40)
WRENCHES = RNG.uniform(5.0, 900.0, (40, 2, 6))
KINEMATICS = RNG.normal(0.02, 0.01, (40, 6))


def activity(name="gait", measured=False, reference=True):
    return ActivityTraces(
        name,
        Trace("surrogate", TIME, WRENCHES + 3.0, KINEMATICS + 1e-4),
        Trace("fast", TIME, WRENCHES, KINEMATICS) if reference else None,
        MeasuredForces(TIME, WRENCHES[:, :, 1] * 1.1, "eTibia") if measured else None,
    )


def panels(figure, rows):
    return np.array(figure.axes).reshape(rows, -1)


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.mark.parametrize("count", [1, 2, 4, 6])
def test_forces_have_a_column_for_every_activity_and_medial_on_top(count):
    figure = compressive_forces_figure([activity(f"trial {i}") for i in range(count)])
    axes = panels(figure, 2)
    assert axes.shape == (2, count)
    assert [axis.get_title() for axis in axes[0]] == [f"trial {i}" for i in range(count)]
    assert [axis.get_ylabel() for axis in axes[:, 0]] == ["medial [N]", "lateral [N]"]
    assert {axis.get_xlabel() for axis in axes[1]} == {"time [s]"}
    # One scale, so that sides and activities compare at a glance.
    assert len({axis.get_ylim() for axis in axes.flat}) == 1
    for s, side in enumerate(("medial", "lateral")):
        for axis in axes[s]:
            surrogate, reference = axis.lines
            np.testing.assert_array_equal(surrogate.get_ydata(), WRENCHES[:, s, 1] + 3.0)
            np.testing.assert_array_equal(reference.get_ydata(), WRENCHES[:, s, 1])
            np.testing.assert_array_equal(reference.get_xdata(), TIME)
            assert (surrogate.get_linestyle(), reference.get_linestyle()) == ("-", ":")
            assert (surrogate.get_color(), reference.get_color()) == (COLOURS[side], "black")
    assert legend(figure) == ["surrogate, medial", "surrogate, lateral", "fast"]


def test_measured_forces_are_a_shade_from_zero_where_they_are_known():
    figure = compressive_forces_figure([activity(), activity("other", measured=True)])
    axes = panels(figure, 2)
    assert [len(axis.collections) for axis in axes.flat] == [0, 1, 0, 1]
    for s in (0, 1):
        shade = axes[s, 1].collections[0].get_paths()[0].vertices
        assert shade[:, 1].max() == pytest.approx(1.1 * WRENCHES[:, s, 1].max())
        assert shade[:, 1].min() == 0.0
    assert legend(figure) == ["eTibia", "surrogate, medial", "surrogate, lateral", "fast"]


def test_body_weights_stand_on_the_right_of_each_row():
    figure = compressive_forces_figure([activity(), activity("other")], body_weight=686.0)
    axes = panels(figure, 2)
    assert [len(axis.child_axes) for axis in axes.flat] == [0, 1, 0, 1]
    figure.draw_without_rendering()
    for axis in axes[:, 1]:
        (weights,) = axis.child_axes
        assert weights.get_ylabel() == "[BW]"
        np.testing.assert_allclose(weights.get_ylim(), np.array(axis.get_ylim()) / 686.0)


@pytest.mark.parametrize("count", [1, 3, 6])
def test_kinematics_have_six_rows_in_the_papers_order(count):
    figure = knee_kinematics_figure([activity(f"trial {i}") for i in range(count)])
    axes = panels(figure, 6)
    assert axes.shape == (6, count)
    labels = [axis.get_ylabel().replace("\n", " ") for axis in axes[:, 0]]
    assert labels == [
        "anterior tibial translation [mm]",
        "distraction [mm]",
        "lateral tibial translation [mm]",
        "flexion [deg]",
        "adduction [deg]",
        "tibial external rotation [deg]",
    ]
    columns = [3, 4, 5, 0, 1, 2]
    for i, axis in enumerate(axes[:, -1]):
        surrogate, reference = axis.lines
        factor = 1e3 if i < 3 else 180.0 / np.pi
        np.testing.assert_allclose(reference.get_ydata(), factor * KINEMATICS[:, columns[i]])
        assert (surrogate.get_linestyle(), reference.get_linestyle()) == ("-", ":")
        assert len({a.get_ylim() for a in axes[i]}) == 1
    assert legend(figure) == ["surrogate", "fast"]


def test_a_run_without_a_reference_has_the_solid_line_alone():
    for draw in (compressive_forces_figure, knee_kinematics_figure):
        figure = draw([activity(reference=False)])
        assert {len(axis.lines) for axis in figure.axes} == {1}
        assert "fast" not in legend(figure)


def test_a_long_name_breaks_after_an_underscore_and_stays_whole():
    name = "chair_rise_like_with_a_long_name"
    title = panels(compressive_forces_figure([activity(name)]), 2)[0, 0].get_title()
    assert "_\n" in title
    assert max(map(len, title.split("\n"))) <= 22
    assert title.replace("\n", "") == name


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(InputDataError, match="a figure of activities needs at least one"):
        knee_kinematics_figure([])
    with pytest.raises(InputDataError, match="body_weight is 0 N: must be positive"):
        compressive_forces_figure([activity()], body_weight=0.0)
    with pytest.raises(InputDataError, match=r"compression has shape \(40,\); \(40, 2\) is needed"):
        MeasuredForces(TIME, WRENCHES[:, 0, 1])


PEAKS = np.array([40.0, 900.0, np.nan, 15.0, 300.0, 700.0])
NAMES = ["sart", "gasmed", "tfl", "grac", "recfem", "vaslat"]


def muscles(label="surrogate", factor=1.0, names=NAMES):
    rise = np.sin(np.linspace(0.0, np.pi, 41))[:40, None]
    column = [NAMES.index(name) for name in names]
    return MuscleForces(label, TIME, names, factor * rise * PEAKS[column])


def test_the_strongest_muscles_come_first_with_reference_and_surrogate():
    # The reference knows its muscles in another order.
    reference = muscles("fast", 0.9, NAMES[::-1])
    figure = muscle_forces_figure("gait", muscles(), reference, count=5)
    assert [axis.get_title() for axis in figure.axes] == [
        "gasmed",
        "vaslat",
        "recfem",
        "sart",
        "grac",
    ]
    for axis in figure.axes:
        surrogate, known = axis.lines
        np.testing.assert_allclose(known.get_ydata(), 0.9 * surrogate.get_ydata())
        assert surrogate.get_ydata().max() == pytest.approx(
            PEAKS[NAMES.index(axis.get_title())], rel=0.01
        )
        assert (surrogate.get_linestyle(), known.get_linestyle()) == ("-", ":")
        assert axis.get_ylim()[0] == 0.0
    assert figure.axes[0].get_ylabel() == "force [N]"
    assert legend(figure) == ["surrogate", "fast"]
    assert figure.get_suptitle() == "gait: muscle forces, the 5 largest of 6"


def test_fewer_muscles_than_asked_are_all_shown():
    figure = muscle_forces_figure("gait", muscles())
    assert len(figure.axes) == 6
    assert figure.axes[-1].get_title() == "tfl"  # without a number, it has no peak
    assert figure.get_suptitle() == "gait: muscle forces"


def test_muscles_that_cannot_be_drawn_are_refused():
    with pytest.raises(InputDataError, match="'fast' have no muscle 'gasmed'"):
        muscle_forces_figure("gait", muscles(), muscles("fast", 1.0, ["sart"]))
    with pytest.raises(InputDataError, match="6 muscles, 0 asked for"):
        muscle_forces_figure("gait", muscles(), count=0)
    with pytest.raises(InputDataError, match=r"forces have shape \(40, 6\); \(40, 2\) is needed"):
        MuscleForces("fast", TIME, ["a", "b"], muscles().forces)


PERCENT = np.linspace(0.0, 100.0, 40)


def test_measured_kinematics_are_black_with_their_band_behind_the_computed():
    band = (KINEMATICS - 0.01, KINEMATICS + 0.02)
    curves = [
        KinematicsCurve("surrogate", PERCENT, KINEMATICS + 0.003),
        KinematicsCurve("fast", PERCENT, KINEMATICS + 0.002),
        KinematicsCurve("fluoroscopy", PERCENT, KINEMATICS, band, measured=True),
    ]
    figure = comparison_figure("knee", curves, along="gait cycle [%]")
    assert [axis.get_title() for axis in figure.axes] == [
        "adduction [deg]",
        "tibial external rotation [deg]",
        "anterior tibial translation [mm]",
        "distraction [mm]",
        "lateral tibial translation [mm]",
    ]
    assert {axis.get_xlabel() for axis in figure.axes} == {"gait cycle [%]"}
    assert legend(figure) == ["fluoroscopy", "surrogate", "fast"]
    distraction = figure.axes[3]
    measured, *computed = distraction.lines
    assert measured.get_color() == "black"
    np.testing.assert_allclose(measured.get_ydata(), 1e3 * KINEMATICS[:, 4])
    assert len({line.get_linestyle() for line in computed}) == 2
    assert len({line.get_color() for line in computed}) == 2
    (shade,) = distraction.collections
    heights = shade.get_paths()[0].vertices[:, 1]
    assert heights.max() == pytest.approx(1e3 * (KINEMATICS[:, 4].max() + 0.02))
    assert heights.min() == pytest.approx(1e3 * (KINEMATICS[:, 4].min() - 0.01))


def test_quantities_are_chosen_by_name_and_a_loop_is_drawn_as_it_comes():
    flexion = 30.0 - 30.0 * np.cos(np.linspace(0.0, 2.0 * np.pi, 40))
    figure = comparison_figure(
        "knee", [KinematicsCurve("fast", flexion, KINEMATICS)], quantities=["flexion"]
    )
    (axis,) = figure.axes
    assert (axis.get_title(), axis.get_xlabel()) == ("flexion [deg]", "flexion [deg]")
    np.testing.assert_array_equal(axis.lines[0].get_xdata(), flexion)


def test_comparisons_that_cannot_be_drawn_are_refused():
    curve = KinematicsCurve("fast", PERCENT, KINEMATICS)
    with pytest.raises(InputDataError, match="quantity 'roll': must be one of flexion, adduction"):
        comparison_figure("knee", [curve], quantities=["roll"])
    with pytest.raises(
        InputDataError, match=r"7 curves \(7 of them computed\).* at most 6 computed"
    ):
        comparison_figure("knee", [curve] * 7)
    with pytest.raises(InputDataError, match="0 curves"):
        comparison_figure("knee", [])
    with pytest.raises(
        InputDataError, match=r"kinematics has shape \(40, 5\); \(40, 6\) is needed"
    ):
        KinematicsCurve("fast", PERCENT, KINEMATICS[:, :5])
    with pytest.raises(InputDataError, match=r"band has shape \(40,\)"):
        KinematicsCurve("fast", PERCENT, KINEMATICS, (KINEMATICS[:, 0], KINEMATICS))
    with pytest.raises(InputDataError, match="with a band, along must increase"):
        KinematicsCurve("fast", np.abs(PERCENT - 50.0), KINEMATICS, (KINEMATICS, KINEMATICS))


def test_the_same_data_give_the_same_bytes(tmp_path):
    draws = {
        "forces": lambda: compressive_forces_figure([activity(measured=True)], body_weight=686.0),
        "kinematics": lambda: knee_kinematics_figure([activity()]),
        "muscles": lambda: muscle_forces_figure("gait", muscles(), muscles("fast", 0.9)),
        "comparison": lambda: comparison_figure(
            "knee", [KinematicsCurve("fast", PERCENT, KINEMATICS, (KINEMATICS, KINEMATICS + 1.0))]
        ),
    }
    with house_style():
        for name, draw in draws.items():
            first, second = (
                save(draw(), tmp_path / f"{name}_{i}.png").read_bytes() for i in (1, 2)
            )
            assert first == second, name
