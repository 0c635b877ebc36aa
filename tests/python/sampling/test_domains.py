# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.spatial import ConvexHull
from sklearn.preprocessing import StandardScaler
from spring_contact import EDGE, SPACING, STIFFNESS, SpringSolver

from condyle.errors import InputDataError
from condyle.sampling import (
    DOMAIN_NAMES,
    PAPER_COUNTS,
    PRESCRIBED_COLUMNS,
    BoundaryPoints,
    DomainInputs,
    Prescribed,
    ReferenceCurves,
    build_domain,
)
from condyle.sampling.chunk import Chunk
from condyle.sampling.domain_boundary import ContactBoundaryDomain
from condyle.sampling.domain_envelopes import EnvelopeDomain
from condyle.sampling.domain_global import GlobalDomain
from condyle.sampling.domain_single_sided import SingleSidedDomain
from condyle.sampling.domains import BUILDERS
from condyle.sampling.hammersley import hammersley, seeded_shift
from condyle.sampling.lift_off import lift_off_angles
from condyle.sampling.plan import DOMAINS_AVAILABLE, SamplingPlan


def test_builders_are_the_domains_that_a_plan_accepts(
    plan: SamplingPlan, curves: ReferenceCurves
) -> None:
    assert tuple(BUILDERS) == DOMAINS_AVAILABLE == tuple(DOMAIN_NAMES)
    inputs = DomainInputs(plan, curves)
    assert [build_domain(number, inputs).number for number in (2, 4)] == [2, 4]


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


def test_time_varying_envelopes_contain_their_curves_and_span_one_standard_deviation(
    curves: ReferenceCurves,
) -> None:
    domain = EnvelopeDomain.around(curves, 61)
    assert sum(frames for _, frames in domain.activities) == len(domain.centres) == 61
    assert np.array_equal(domain.centres, curves.resampled(61).table(PRESCRIBED_COLUMNS))
    chunk = Chunk(1, 1, 61 * 40, 0, 61 * 40)
    drawn = domain.with_sizes(np.full(61, 40)).draw(chunk, 3).to_array().reshape(61, 40, 6)
    # Hammersley projections of 40 points: both ends of every box are reached within 5/40 of it.
    offset = (drawn - domain.centres[:, None]) / domain.half_widths[:, None]
    assert np.all(np.abs(offset) <= 1 + 1e-12)
    assert np.all(offset.max(axis=1) > 0.4)
    assert np.all(offset.min(axis=1) < -0.4)
    first = 0
    for curve, (name, frames) in zip(curves.curves, domain.activities, strict=True):
        values = np.column_stack([curve.column(n) for n in PRESCRIBED_COLUMNS])
        # Equally spaced frames, both ends of the period among them: 1 / 90 of the period.
        scaler = StandardScaler().fit(values)
        np.testing.assert_allclose(domain.half_widths[first], scaler.scale_, rtol=0.02)
        assert name == curve.name
        first += frames


def test_time_frames_have_sets_of_their_own(curves: ReferenceCurves) -> None:
    sizes = np.array([5, 0, 7, 3])
    domain = EnvelopeDomain.around(curves, 4).with_sizes(sizes)
    whole = domain.draw(Chunk(1, 1, 15, 0, 15), 3).to_array()
    pieces = [domain.draw(Chunk(1, 1, 15, i, i + 3), 3).to_array() for i in range(0, 15, 3)]
    assert np.array_equal(np.concatenate(pieces), whole)
    assert np.array_equal(domain.frames_of(np.arange(15)), np.repeat([0, 2, 3], [5, 7, 3]))
    again = domain.draw(Chunk(1, 2, 15, 0, 15), 3).to_array()
    assert not np.any(np.isclose(again, whole, rtol=1e-12, atol=0))


def test_lift_off_angles_of_springs_are_their_closed_form(curves: ReferenceCurves) -> None:
    poses = curves.table(("x", "z", "theta_y", "theta_z"))[::9]
    load = np.linspace(5.0, 400.0, len(poses))
    x, z, theta_y, theta_z = poses.T
    angles = lift_off_angles(SpringSolver(), Prescribed(x, load, z, 0 * x, theta_y, theta_z))
    on_insert = np.abs(x) <= EDGE
    assert np.array_equal(~np.isnan(angles[:, 0]), on_insert)
    # One side carries all from |θx| = Fy / (2 · SPACING · STIFFNESS) on; 12 halvings of 0.2 rad.
    expected = load / (2 * SPACING * STIFFNESS)
    np.testing.assert_allclose(angles[on_insert, 1], expected[on_insert], rtol=0, atol=0.2 / 2**12)
    np.testing.assert_allclose(angles[on_insert, 0], -expected[on_insert], rtol=0, atol=0.2 / 2**12)


def test_single_sided_domain_stretches_its_box_to_its_range(curves: ReferenceCurves) -> None:
    domain = build_domain(
        3, DomainInputs(SamplingPlan.preset("paper", seed=1), curves, SpringSolver())
    )
    assert isinstance(domain, SingleSidedDomain)
    drawn = domain.prescribe(hammersley(4096))
    low, high = domain.theta_x_range
    own = domain.box.corners()[:, 2]
    assert high - low == pytest.approx(
        1.5 * (max(domain.lift_off[1], own.max()) - min(domain.lift_off[0], own.min()))
    )
    assert np.all((drawn.theta_x > low) & (drawn.theta_x < high))
    assert np.all(np.isnan(drawn.Mx))
    assert drawn.theta_x_given
    assert not drawn.pose_given
    # The other variables are the box's own.
    assert np.array_equal(drawn.x, domain.box.values(hammersley(4096)[:, 1:])[:, 0])


def test_domains_name_what_they_are_built_from(plan: SamplingPlan, curves: ReferenceCurves) -> None:
    for number, message in ((3, "a solver"), (5, "domain 4's samples"), (6, "domain 4's samples")):
        with pytest.raises(
            InputDataError, match=f"domain {number}.*{message} .*needed to build it"
        ):
            build_domain(number, DomainInputs(plan, curves))


@pytest.mark.parametrize("number", [2, 4])
def test_envelope_is_the_shadow_of_the_domain(
    number: int, plan: SamplingPlan, curves: ReferenceCurves
) -> None:
    domain = build_domain(number, DomainInputs(plan, curves))
    points = domain.prescribe(hammersley(2000)).to_array()
    envelope = domain.envelope()
    for i in range(6):
        for j in range(i):
            scale = np.ptp(envelope[:, [i, j]], axis=0)
            hull = ConvexHull(envelope[:, [i, j]] / scale)
            outside = points[:, [i, j]] / scale @ hull.equations[:, :2].T + hull.equations[:, 2]
            # Qhull's own facet tolerance on coordinates of order 1 (Fy / its range: up to a few).
            assert np.max(outside) < 1e-10


def test_envelopes_of_domains_with_a_prescribed_tilt_bound_them(
    plan: SamplingPlan, curves: ReferenceCurves
) -> None:
    poses = np.random.default_rng(8).normal([0, 0.033, 0, 0, 0, -0.5], 1e-3, (20, 6))
    boundary = BoundaryPoints(np.arange(20, dtype=np.uint64), poses, np.ones(20, dtype=np.int8))
    inputs = DomainInputs(plan, curves, SpringSolver(), boundary)
    for number, solved_or_given in ((3, ["Mx"]), (5, ["Fy", "Mx"]), (6, ["Fy", "Mx"])):
        domain = build_domain(number, inputs)
        count = 4 * len(poses) if number == 5 else 2000
        points = domain.draw(Chunk(number, 1, count, 0, count), 3).to_array()
        envelope = domain.envelope()
        for column, name in enumerate(PRESCRIBED_COLUMNS):
            absent = name in solved_or_given
            assert np.all(np.isnan(envelope[:, column])) == absent
            assert np.all(np.isnan(points[:, column])) == absent
            if not absent:
                room = 1e-12 * np.ptp(envelope[:, column])
                assert envelope[:, column].min() - room <= points[:, column].min()
                assert points[:, column].max() <= envelope[:, column].max() + room
