# SPDX-License-Identifier: Apache-2.0
"""The built-in load cases are what their knots and sources say."""

import numpy as np
import pytest

from condyle.activities import BUILT_IN, load_case, load_case_file, waveforms

# Rows 0-14 % of the published copy of the ISO 14243-3 table: flexion [deg], axial force [N].
PUBLISHED = np.array(
    [
        (0, 167.6), (0.17, 597.5), (0.69, 1457.4), (1.53, 1887.3), (2.65, 1782.9), (4.0, 1530.9), (5.53, 1278.8),
        (7.16, 1174.6), (8.84, 1270.1), (10.47, 1530.9), (12.0, 1887.3), (13.35, 2243.6), (14.47, 2504.5),
        (15.31, 2600.0), (15.83, 2570.0),
    ]
)  # fmt: skip


@pytest.mark.parametrize("name", BUILT_IN)
def test_file_is_what_its_module_generates(name: str) -> None:
    assert load_case_file(name).read_text(encoding="utf-8") == getattr(waveforms, name)()


def test_gait_reproduces_the_published_rows() -> None:
    percent = np.arange(15.0)
    # The source prints 0.01 deg and 0.1 N; the half-cosines reproduce it to 0.01 deg and 0.2 N.
    flexion = waveforms.half_cosines(waveforms.GAIT_FLEXION_DEG, percent)
    np.testing.assert_allclose(flexion, PUBLISHED[:, 0], atol=0.01)
    axial = waveforms.half_cosines(waveforms.GAIT_AXIAL_N, percent)
    np.testing.assert_allclose(axial, PUBLISHED[:, 1], atol=0.2)


def test_gait_spans_the_quoted_extremes() -> None:
    gait = load_case("iso_like_gait")
    assert len(gait) == 101
    assert gait.time[-1] == 1.0
    assert np.degrees(gait.flexion.max()) == pytest.approx(58.0, abs=0.01)
    assert gait.axial_force.max() == 2600.0
    assert gait.axial_force.min() == 167.6
    assert (gait.ap_force.min(), gait.ap_force.max()) == (-265.0, 110.0)
    assert (gait.ie_torque.min(), gait.ie_torque.max()) == (-1.0, 6.0)


def test_squat_goes_to_ninety_degrees_at_two_and_a_half_body_weights() -> None:
    squat = load_case("squat_like")
    deepest = np.argmax(squat.flexion)
    assert np.degrees(squat.flexion[deepest]) == pytest.approx(90.0)
    assert squat.axial_force[deepest] == pytest.approx(2.5 * 750.0)
    np.testing.assert_allclose(
        squat.flexion, squat.flexion[::-1], atol=2e-6
    )  # 1e-4 deg, as printed


@pytest.mark.parametrize(
    ("name", "quoted"),
    [
        # Peaks as their sources print them, in body weights (Nm for the torque); the rest claims nothing.
        ("turn_like_gait", {"axial_force": 2.6, "ap_force": 0.30}),
        ("chair_rise_like", {"axial_force": 2.46, "ap_force": 0.17}),
    ],
)
def test_quoted_peaks_are_reached(name: str, quoted: dict[str, float]) -> None:
    case = load_case(name)
    for column, peak in quoted.items():
        # Knots lie on the 1 % grid of the table, so a peak is met to its four decimals.
        found = np.abs(getattr(case, column)).max() / waveforms.BODY_WEIGHT_N
        assert found == pytest.approx(peak, abs=1e-7)


def test_chair_rise_ends_in_two_legged_stance() -> None:
    assert load_case("chair_rise_like").axial_force[-1] == pytest.approx(1.07 * 750.0)


def test_the_swinging_leg_is_loaded_less_than_any_other_activity() -> None:
    swing = load_case("leg_swing_like")
    assert swing.axial_force.min() > 0.0
    assert np.degrees(np.ptp(swing.flexion)) > 60.0
    for name in set(BUILT_IN) - {"leg_swing_like"}:
        # 167.6 N is what simulators apply in the swing phase: no other activity is below.
        assert swing.axial_force.max() < 167.6
        assert load_case(name).axial_force.min() >= 165.0 - 1e-9


@pytest.mark.parametrize("name", BUILT_IN)
def test_time_frames_are_101_and_begin_at_0(name: str) -> None:
    case = load_case(name)
    assert len(case) == 101
    assert case.time[0] == 0.0


def test_half_cosines_pass_their_knots_with_level_tangents() -> None:
    knots = ((0, 3.0), (20, -1.0), (70, 8.0))
    np.testing.assert_allclose(
        waveforms.half_cosines(knots, np.array([0.0, 20.0, 70.0])), [3.0, -1.0, 8.0]
    )
    h = 1e-4
    near = waveforms.half_cosines(knots, np.array([20.0 - h, 20.0 + h]))
    # Level to second order: amplitude·(π h / span)²/4.
    np.testing.assert_allclose(near, -1.0, atol=9.0 * (np.pi * h / 20.0) ** 2)


@pytest.mark.parametrize("name", BUILT_IN)
def test_header_claims_no_compliance_and_states_the_signs(name: str) -> None:
    header = [
        line
        for line in load_case_file(name).read_text("utf-8").splitlines()
        if line.startswith("#")
    ]
    text = " ".join(header)
    assert "Signs:" in text
    assert "TIBIA" in text
    assert "illustrative" in text or "no claim of compliance" in text
