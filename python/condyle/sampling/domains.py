# SPDX-License-Identifier: Apache-2.0
"""The domains of a plan, built around reference curves."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from condyle.sampling.domain import SamplingDomain
from condyle.sampling.domain_boundary import ContactBoundaryDomain
from condyle.sampling.domain_global import GlobalDomain
from condyle.sampling.plan import SamplingPlan
from condyle.sampling.reference_curves import ReferenceCurves


def _global(plan: SamplingPlan, curves: ReferenceCurves) -> SamplingDomain:
    return GlobalDomain.around(curves, widening=plan.widening, margins=plan.margins)


def _boundary(plan: SamplingPlan, curves: ReferenceCurves) -> SamplingDomain:
    return ContactBoundaryDomain.around(
        curves,
        widening=plan.widening,
        margins=plan.margins,
        max_Fy=plan.boundary_max_Fy,
        max_Mx=plan.boundary_max_Mx,
    )


#: Number → how it is built. Its keys are plan.DOMAINS_AVAILABLE (a test compares them).
BUILDERS: Final[dict[int, Callable[[SamplingPlan, ReferenceCurves], SamplingDomain]]] = {
    2: _global,
    4: _boundary,
}


def build_domains(plan: SamplingPlan, curves: ReferenceCurves) -> dict[int, SamplingDomain]:
    """The domains that a plan has targets for, by number, in the plan's order."""
    return {target.domain: BUILDERS[target.domain](plan, curves) for target in plan.targets}
