# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.spatial import ConvexHull

from condyle.sampling import (
    DOMAIN_NAMES,
    PAPER_COUNTS,
    PRESCRIBED_COLUMNS,
    ReferenceCurves,
    build_domains,
)
from condyle.sampling.domain_boundary import ContactBoundaryDomain
from condyle.sampling.domain_global import GlobalDomain
from condyle.sampling.domains import BUILDERS
from condyle.sampling.hammersley import hammersley, seeded_shift
from condyle.sampling.plan import DOMAINS_AVAILABLE, SamplingPlan


def test_builders_are_the_domains_that_a_plan_accepts(
    plan: SamplingPlan, curves: ReferenceCurves
) -> None:
    assert tuple(BUILDERS) == DOMAINS_AVAILABLE
    domains = build_domains(plan, curves)
    assert {number: domain.number for number, domain in domains.items()} == {2: 2, 4: 4}


def test_paper_counts_add_up_to_the_designs_total() -> None:
    assert sum(train + test for train, test in PAPER_COUNTS.values()) == 154_310
    assert set(PAPER_COUNTS) == set(DOMAIN_NAMES)


def test_global_domain_contains_its_curves_with_room(curves: ReferenceCurves) -> None:
    domain = GlobalDomain.around(curves, widening=1.5, margins={})
    table = curves.table(PRESCRIBED_COLUMNS)
    assert np.all(domain.box.contains(table))
    # A quarter of the range on either side of every score.
    scores = domain.box.axes.scores(table)
    length = scores.max(axis=0) - scores.min(axis=0)
    np.testing.assert_allclose(scores.min(axis=0) - domain.box.low, 0.25 * length, rtol=1e-9)
    np.testing.assert_allclose(domain.box.high - scores.max(axis=0), 0.25 * length, rtol=1e-9)


def test_global_domain_prescribes_points_of_its_box_in_the_papers_order(
    curves: ReferenceCurves,
) -> None:
    domain = GlobalDomain.around(curves, widening=1.5, margins={})
    unit = hammersley(300)
    prescribed = domain.prescribe(unit)
    assert np.array_equal(prescribed.to_array(), domain.box.values(unit))
    assert np.array_equal(prescribed.Fy, domain.box.values(unit)[:, 1])


def test_boundary_domain_has_its_loads_whatever_the_pose(curves: ReferenceCurves) -> None:
    domain = ContactBoundaryDomain.around(
        curves, widening=1.5, margins={}, max_Fy=100.0, max_Mx=5.0
    )
    # Shifted off the cube's faces, where rounding decides what is inside.
    prescribed = domain.prescribe(hammersley(4096, shift=seeded_shift(1, "inside")))
    assert 0 <= prescribed.Fy.min() < 0.05 < 99.95 < prescribed.Fy.max() <= 100
    assert -5 <= prescribed.Mx.min() < -4.99 < 4.99 < prescribed.Mx.max() <= 5
    pose = np.column_stack([prescribed.x, prescribed.z, prescribed.theta_y, prescribed.theta_z])
    assert np.all(domain.box.contains(pose))
    # Independent coordinates of a low-discrepancy set: correlations of order (log N)^2 / N.
    correlation = np.corrcoef(np.column_stack([prescribed.Fy, prescribed.Mx, pose]).T)
    assert np.max(np.abs(correlation[:2, 2:])) < 0.02
    assert np.all(domain.box.contains(curves.table(("x", "z", "theta_y", "theta_z"))))


@pytest.mark.parametrize("number", [2, 4])
def test_envelope_is_the_shadow_of_the_domain(
    number: int, plan: SamplingPlan, curves: ReferenceCurves
) -> None:
    domain = build_domains(plan, curves)[number]
    points = domain.prescribe(hammersley(2000)).to_array()
    envelope = domain.envelope()
    for i in range(6):
        for j in range(i):
            scale = np.ptp(envelope[:, [i, j]], axis=0)
            hull = ConvexHull(envelope[:, [i, j]] / scale)
            outside = points[:, [i, j]] / scale @ hull.equations[:, :2].T + hull.equations[:, 2]
            # Qhull's own facet tolerance on coordinates of order 1 (Fy / its range: up to a few).
            assert np.max(outside) < 1e-10
