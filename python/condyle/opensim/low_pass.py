# SPDX-License-Identifier: Apache-2.0
"""A zero-lag Butterworth low-pass: second order, forward and backward, so fourth order in all.

The amplitude at the cut-off falls to 1/√2 in each pass, so to 1/2 in all; the phase is untouched.
Source: Winter 2009, Biomechanics and Motor Control of Human Movement, ch. 3; ends by odd reflection and
the filter's steady state (Gustafsson 1996, IEEE Trans Signal Process 44:988-992, gives the problem).
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from condyle.errors import InputDataError

Array = npt.NDArray[np.float64]

#: Largest deviation of a time step from the mean step, as a share of it.
_EVEN: Final = 0.01
#: Length of the reflected ends, in periods of the cut-off.
_PERIODS: Final = 1.5


def low_pass(times: Array, values: Array, cut_off_hz: float, *, source: str = "motion") -> Array:
    """Filters columns over time.

    Args:
        times: (n) [s], evenly spaced.
        values: (n, m), finite.
        cut_off_hz: Cut-off of one pass [Hz], below half the sampling rate.
        source: Name for messages.

    Returns:
        (n, m).

    Raises:
        InputDataError: Uneven times, a cut-off out of range, or fewer than three time frames.
    """
    if len(times) < 3:
        raise InputDataError(f"{source}: {len(times)} time frames: a filter needs 3 or more")
    steps = np.diff(times)
    step = float(np.mean(steps))
    worst = int(np.argmax(np.abs(steps - step)))
    if abs(steps[worst] - step) > _EVEN * step:
        raise InputDataError(
            f"{source}: the step after {times[worst]:.6g} s is {steps[worst]:.6g} s, the mean step "
            f"{step:.6g} s: a filter needs even steps (within {_EVEN:.0%})"
        )
    if not 0.0 < cut_off_hz * step < 0.5:
        raise InputDataError(
            f"{source}: cut-off {cut_off_hz:g} Hz: must be above 0 and below half the sampling rate, "
            f"{0.5 / step:.6g} Hz"
        )
    pad = min(round(_PERIODS / (cut_off_hz * step)), len(times) - 1)
    before = 2.0 * values[0] - values[pad:0:-1]
    after = 2.0 * values[-1] - values[-2 : -pad - 2 : -1]
    padded = np.concatenate([before, values, after])
    b, a = _coefficients(cut_off_hz * step)
    once = _filtered(padded, b, a)[::-1]
    return _filtered(once, b, a)[::-1][pad : pad + len(values)].copy()


def _coefficients(share: float) -> tuple[Array, Array]:
    """Bilinear transform of s² + √2 s + 1, prewarped; share = cut-off over sampling rate."""
    w = math.tan(math.pi * share)
    scale = 1.0 + math.sqrt(2.0) * w + w * w
    b = np.array([1.0, 2.0, 1.0]) * (w * w / scale)
    a = np.array([1.0, 2.0 * (w * w - 1.0) / scale, (1.0 - math.sqrt(2.0) * w + w * w) / scale])
    return b, a


def _filtered(values: Array, b: Array, a: Array) -> Array:
    """Direct form II transposed, begun in the steady state of the first row."""
    # A constant input of 1 gives 1: z1 = 1 − b0, z2 = b2 − a2.
    first = (1.0 - b[0]) * values[0]
    second = (b[2] - a[2]) * values[0]
    out = np.empty_like(values)
    for i, row in enumerate(values):
        out[i] = b[0] * row + first
        first = b[1] * row - a[1] * out[i] + second
        second = b[2] * row - a[2] * out[i]
    return out
