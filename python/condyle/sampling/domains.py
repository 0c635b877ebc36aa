# SPDX-License-Identifier: Apache-2.0
"""The domains of a plan, built around reference curves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.sampling.domain import SamplingDomain
from condyle.sampling.domain_boundary import ContactBoundaryDomain
from condyle.sampling.domain_envelopes import EnvelopeDomain
from condyle.sampling.domain_far import FarDomain
from condyle.sampling.domain_global import GlobalDomain
from condyle.sampling.domain_proximity import ProximityDomain
from condyle.sampling.domain_single_sided import SingleSidedDomain
from condyle.sampling.equilibrium_protocol import StaticEquilibriumSolver
from condyle.sampling.plan import SamplingPlan
from condyle.sampling.reference_curves import ReferenceCurves


@dataclass(frozen=True)
class BoundaryPoints:
    """What domain 4 gives to domains 5 and 6.

    Attributes:
        ids: (m,) accepted candidates.
        poses: (m, 6) of these [m, rad].
        splits: (m,) codes of :mod:`condyle.sampling.selection`; DROPPED is a spare.
    """

    ids: NDArray[np.uint64]
    poses: NDArray[np.float64]
    splits: NDArray[np.int8]


@dataclass(frozen=True)
class DomainInputs:
    """What domains are built from.

    Attributes:
        plan: The sampling plan.
        curves: The reference curves.
        solver: The static equilibrium solver, for domain 3.
        boundary: Domain 4's points, for domains 5 and 6.
    """

    plan: SamplingPlan
    curves: ReferenceCurves
    solver: StaticEquilibriumSolver | None = None
    boundary: BoundaryPoints | None = None


def _envelopes(inputs: DomainInputs) -> EnvelopeDomain:
    (target,) = [t for t in inputs.plan.targets if t.domain == EnvelopeDomain.number]
    frames = round(target.total / inputs.plan.envelope_points)
    frames = max(frames, 2 * len(inputs.curves.names))
    return EnvelopeDomain.around(inputs.curves, frames, inputs.plan.drawn_columns)


def _global(inputs: DomainInputs) -> GlobalDomain:
    plan = inputs.plan
    return GlobalDomain.around(
        inputs.curves,
        widening=plan.widening,
        margins=plan.margins,
        columns=plan.drawn_columns,
    )


def _single_sided(inputs: DomainInputs) -> SingleSidedDomain:
    plan = inputs.plan
    if inputs.solver is None:
        raise InputDataError("sampling domain 3 (single-sided): a solver is needed to build it")
    return SingleSidedDomain.around(
        inputs.curves,
        inputs.solver,
        widening=plan.widening,
        margins=plan.margins,
        max_Fy=plan.single_sided_max_Fy,
        theta_z_limits=(plan.min_theta_z, plan.max_theta_z),
    )


def _boundary(inputs: DomainInputs) -> ContactBoundaryDomain:
    plan = inputs.plan
    return ContactBoundaryDomain.around(
        inputs.curves,
        widening=plan.widening,
        margins=plan.margins,
        max_Fy=plan.boundary_max_Fy,
        max_Mx=plan.boundary_max_Mx,
        theta_x_drawn="theta_x" not in plan.sensitive_directions,
    )


def _points(inputs: DomainInputs, domain: int) -> BoundaryPoints:
    if inputs.boundary is None:
        raise InputDataError(f"sampling domain {domain}: domain 4's samples are needed to build it")
    return inputs.boundary


def _proximity(inputs: DomainInputs) -> ProximityDomain:
    points = _points(inputs, ProximityDomain.number)
    return ProximityDomain(points.poses, points.ids)


def _far(inputs: DomainInputs) -> FarDomain:
    points = _points(inputs, FarDomain.number)
    kept = points.poses[points.splits != 0]
    return FarDomain.above(_boundary(inputs).box, np.asarray(kept), max_y=inputs.plan.far_max_y)


#: Number → how it is built. Its keys are plan.DOMAINS_AVAILABLE (a test compares them).
BUILDERS: Final[dict[int, Callable[[DomainInputs], SamplingDomain]]] = {
    1: _envelopes,
    2: _global,
    3: _single_sided,
    4: _boundary,
    5: _proximity,
    6: _far,
}


def build_domain(number: int, inputs: DomainInputs) -> SamplingDomain:
    """One domain of a plan.

    Raises:
        InputDataError: The curves do not span it, or something that it needs is not given.
    """
    return BUILDERS[number](inputs)
