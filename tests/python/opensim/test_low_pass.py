# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.signal import butter, filtfilt

from condyle.errors import InputDataError
from condyle.opensim.low_pass import low_pass


def test_it_is_the_butterworth_of_scipy_forward_and_backward(rng):
    times = 0.37 + np.arange(200) / 120.0
    values = rng.normal(size=(200, 3)).cumsum(axis=0)
    b, a = butter(2, 6.0 / 60.0)
    expected = filtfilt(b, a, values, axis=0, padtype="odd", padlen=30)
    # Two recursions of the same second-order filter: rounding only, on values of about 30.
    np.testing.assert_allclose(low_pass(times, values, 6.0), expected, rtol=0, atol=1e-11)


def test_amplitude_halves_at_the_cut_off_and_there_is_no_lag():
    rate, cut_off = 200.0, 8.0
    times = np.arange(2000) / rate
    wave = np.sin(2 * np.pi * cut_off * times)[:, None]
    middle = slice(800, 1200)
    np.testing.assert_allclose(
        low_pass(times, wave, cut_off)[middle], 0.5 * wave[middle], atol=1e-9
    )


def test_straight_lines_pass_unchanged(rng):
    times = np.arange(600) / 100.0
    lines = rng.normal(size=4) + np.outer(times, rng.normal(size=4))
    filtered = low_pass(times, lines, 5.0)
    # The filter begins in the steady state of a constant: a ramp's start-up has died down by
    # exp(-2π·5/√2·(0.3 s of reflection)) = 1.3e-3 at the ends, times a lag of 0.045 s; to nothing inside.
    np.testing.assert_allclose(filtered, lines, atol=2e-4)
    np.testing.assert_allclose(filtered[200:400], lines[200:400], atol=1e-12)


@pytest.mark.parametrize(
    ("times", "cut_off", "words"),
    [
        ([0.0, 0.1], 2.0, "2 time frames: a filter needs 3 or more"),
        ([0.0, 0.1, 0.2, 0.4], 2.0, "the step after 0.2 s is 0.2 s"),
        ([0.0, 0.1, 0.2, 0.3], 5.5, "below half the sampling rate, 5 Hz"),
        ([0.0, 0.1, 0.2, 0.3], -1.0, "cut-off -1 Hz: must be above 0"),
    ],
)
def test_what_cannot_be_filtered_is_refused(times, cut_off, words):
    with pytest.raises(InputDataError, match=f"trial: .*{words}"):
        low_pass(np.array(times), np.zeros((len(times), 1)), cut_off, source="trial")
