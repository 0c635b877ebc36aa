# SPDX-License-Identifier: Apache-2.0
"""Muscle recruitment: sharing known generalised loads over more muscles than equations.

    min Σ w_i (f_i/N_i)^p + Σ c_j |e_j/S_j|^p   subject to   R f + e = τ,   0 ≤ f ≤ N

:func:`recruit` takes moment arms, loads and strengths of one time frame or of many; :class:`Recruiter` does
so call after call and gives derivatives of forces with respect to all three. p is any number from 1, or
``"min_max"``. Loads that cannot be carried are a status that names the coordinate, never an exception.
"""

from condyle.recruitment.recruiter import (
    Criterion,
    ForceChanges,
    Recruiter,
    Recruitment,
    RecruitmentSeries,
    Reserves,
    recruit,
)

__all__ = [
    "Criterion",
    "ForceChanges",
    "Recruiter",
    "Recruitment",
    "RecruitmentSeries",
    "Reserves",
    "recruit",
]
