# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.report.gait_cycles import (
    best_shift,
    heel_strikes,
    normalised_cycles,
    shifted_cycle,
)

#: Strikes at 0.7, 2.3, 3.9, ... s: 1.6 s a cycle, 70 % of it on the ground.
PERIOD, FIRST, STANCE = 1.6, 0.7, 1.12
TIMES = np.arange(0.0, 6.0, 1.0 / 1200.0)


def force(times: np.ndarray) -> np.ndarray:
    """Up at 40 kN/s to 700 N, down just before stance ends."""
    since = np.mod(times - FIRST, PERIOD)
    ramp = np.minimum(40e3 * since, 40e3 * (STANCE - since))
    return np.clip(ramp, 0.0, 700.0)


def test_heel_strikes_are_where_the_force_rises_through_the_threshold():
    strikes = heel_strikes(TIMES, force(TIMES), threshold=20.0)
    # 20 N are reached 0.5 ms after contact. The straight line between samples is off by the kink at contact at most:
    # a sample's 1/1200 s.
    np.testing.assert_allclose(strikes, FIRST + PERIOD * np.arange(4) + 20.0 / 40e3, atol=8.4e-4)


def test_on_a_straight_rise_the_strike_is_exact():
    times = np.array([0.0, 1.0, 1.5])
    np.testing.assert_allclose(heel_strikes(times, np.array([0.0, 10.0, 50.0])), [1.125])


def test_a_foot_that_was_not_lifted_long_enough_has_not_struck():
    vertical = force(TIMES)
    dip = (TIMES > 1.1) & (TIMES < 1.15)
    vertical[dip] = 0.0
    assert len(heel_strikes(TIMES, vertical)) == 4
    assert len(heel_strikes(TIMES, vertical, least_swing=0.01)) == 5


def test_a_record_that_begins_in_stance_counts_from_the_next_strike():
    kept = TIMES > 1.0
    assert len(heel_strikes(TIMES[kept], force(TIMES[kept]))) == 3


def test_cycles_are_told_at_every_percent():
    times = np.linspace(0.0, 6.0, 721)
    strikes = np.array([0.7, 2.3, 4.1])
    # A polyline through the time frames is reproduced: times themselves, and anything linear in them.
    values = np.stack([times, 3.0 - 2.0 * times], axis=1).reshape(-1, 2, 1)
    cycles = normalised_cycles(times, values, strikes)
    assert cycles.shape == (2, 101, 2, 1)
    for cycle, begin, end in zip(cycles, strikes[:-1], strikes[1:], strict=True):
        np.testing.assert_allclose(cycle[:, 0, 0], np.linspace(begin, end, 101), atol=1e-13)
        np.testing.assert_allclose(cycle[:, 1, 0], 3.0 - 2.0 * cycle[:, 0, 0], atol=1e-12)
    # The end of a cycle is the beginning of the next one.
    np.testing.assert_array_equal(cycles[0, -1], cycles[1, 0])


def curve(percent: np.ndarray) -> np.ndarray:
    angle = 2.0 * np.pi * percent / 100.0
    return 20.0 - 15.0 * np.cos(angle) + 6.0 * np.sin(2.0 * angle)


@pytest.mark.parametrize("shift", [-50, -13, 0, 4, 49])
def test_the_shift_of_a_shifted_cycle_is_found(shift):
    percent = np.arange(101.0)
    cycle = curve(percent + shift)  # a feature at p in the reference is at p - shift here
    found, left = best_shift(cycle, curve(percent))
    assert found == shift
    assert left < 1e-12
    np.testing.assert_allclose(shifted_cycle(cycle, found), curve(percent), atol=1e-12)


def test_what_no_shift_removes_is_told():
    percent = np.arange(101.0)
    assert best_shift(curve(percent) + 3.0, curve(percent)) == (0, pytest.approx(3.0))


def test_a_shifted_cycle_moves_all_columns_and_closes():
    cycle = np.arange(101.0)[:, None] * np.array([1.0, 10.0])
    shifted = shifted_cycle(cycle, 3)
    np.testing.assert_array_equal(shifted[3:100], cycle[:97])
    np.testing.assert_array_equal(shifted[:3], cycle[97:100])
    np.testing.assert_array_equal(shifted[100], shifted[0])


def test_what_is_no_cycle_is_refused():
    with pytest.raises(InputDataError, match="1 heel strikes: a cycle needs 2"):
        normalised_cycles(TIMES, TIMES, np.array([0.7]))
    with pytest.raises(InputDataError, match=r"cycle 2 is from 2.3 to 6.1 s; there are 0 to 5.99"):
        normalised_cycles(TIMES, TIMES, np.array([0.7, 2.3, 6.1]))
    with pytest.raises(InputDataError, match=r"vertical_force has shape \(3,\), times \(4,\)"):
        heel_strikes(np.arange(4.0), np.zeros(3))
    with pytest.raises(InputDataError, match=r"shapes \(100,\) and \(101,\): must be \(101,\)"):
        best_shift(np.zeros(100), np.zeros(101))
