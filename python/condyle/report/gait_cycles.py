# SPDX-License-Identifier: Apache-2.0
"""A recorded gait cut into cycles, each on a scale of percent, so that cycles can be drawn and compared."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError

Array = NDArray[np.float64]
#: Of a cycle: 0 to 100 percent.
POINTS: Final = 101


def heel_strikes(
    times: Array, vertical_force: Array, *, threshold: float = 20.0, least_swing: float = 0.2
) -> Array:
    """When a foot meets the ground.

    Args:
        times: (n,) [s], increasing.
        vertical_force: (n,) of the ground on this foot, upward [N].
        threshold: above it the foot is on the ground [N].
        least_swing: a foot that was in the air for less than this has not been lifted [s]. So a record that
            begins in the air counts its first contact only if it shows that much of the swing.

    Returns:
        Times at which the force rises through the threshold, in between samples by a straight line [s].

    Raises:
        InputDataError: arrays that do not fit, by shape.
    """
    if times.ndim != 1 or times.shape != vertical_force.shape:
        raise InputDataError(
            f"vertical_force has shape {vertical_force.shape}, times {times.shape}: must be alike, one row a time"
        )
    strikes = []
    lifted = times[0] if vertical_force[0] <= threshold else np.inf
    for i in range(1, len(times)):
        before, now = vertical_force[i - 1], vertical_force[i]
        if before > threshold >= now:
            lifted = times[i]
        elif before <= threshold < now and times[i] - lifted >= least_swing:
            share = (threshold - before) / (now - before)
            strikes.append(times[i - 1] + share * (times[i] - times[i - 1]))
    return np.array(strikes)


def normalised_cycles(times: Array, values: Array, strikes: Array) -> Array:
    """Cycles from each heel strike to the next, at 0 to 100 percent, in between time frames by a straight line.

    Args:
        times: (n,) [s], increasing.
        values: (n, ...) anything over time.
        strikes: (k + 1,) where the k cycles begin and end [s].

    Returns:
        (k, 101, ...).

    Raises:
        InputDataError: fewer than two strikes, or a cycle that the times do not cover, by its number.
    """
    if len(strikes) < 2:
        raise InputDataError(f"{len(strikes)} heel strikes: a cycle needs 2")
    columns = values.reshape(len(times), -1)
    cycles = []
    for number, (begin, end) in enumerate(pairwise(strikes), start=1):
        if begin < times[0] or end > times[-1]:
            raise InputDataError(
                f"cycle {number} is from {begin:g} to {end:g} s; there are {times[0]:g} to {times[-1]:g} s"
            )
        at = begin + (end - begin) * np.linspace(0.0, 1.0, POINTS)
        cycles.append(np.stack([np.interp(at, times, column) for column in columns.T], axis=1))
    return np.stack(cycles).reshape(len(cycles), POINTS, *values.shape[1:])


def shifted_cycle(cycle: Array, shift: int) -> Array:
    """A cycle (101, ...) that begins ``shift`` percent earlier in itself: row i is what row i - shift was.

    The last row is the first one of the next cycle, so the shifted cycle closes where the given one jumps.
    """
    turned = np.roll(cycle[:-1], shift, axis=0)
    return np.concatenate([turned, turned[:1]])


def best_shift(cycle: Array, reference: Array) -> tuple[int, float]:
    """By how many percent a cycle has to be shifted to lie nearest to a reference, and how near it then is.

    For a measured cycle whose beginning is not known: align it by a curve that both have, such as flexion.

    Args:
        cycle: (101,) the curve to be shifted.
        reference: (101,).

    Returns:
        The shift for :func:`shifted_cycle`, from -50 to 49, and the root-mean-square difference that is left.
    """
    if cycle.shape != (POINTS,) or reference.shape != (POINTS,):
        raise InputDataError(
            f"cycles have shapes {cycle.shape} and {reference.shape}: must be ({POINTS},)"
        )
    shifts = range(-(POINTS // 2), POINTS // 2)
    left = [
        float(np.sqrt(np.mean((shifted_cycle(cycle, shift) - reference) ** 2))) for shift in shifts
    ]
    best = int(np.argmin(left))
    return shifts[best], left[best]
