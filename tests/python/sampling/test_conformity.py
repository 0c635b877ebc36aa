# SPDX-License-Identifier: Apache-2.0
"""Bounds from conformity: on springs under a plateau they have a closed form; around them a plan can sample."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from spring_contact import EDGE, HEIGHT, SPACING, SpringSolver

from condyle.contact import MeshContact
from condyle.errors import InputDataError
from condyle.implants import generate, preset, write_implant
from condyle.sampling import PRESCRIBED_COLUMNS, DomainTarget, SamplingPlan, sample
from condyle.sampling.conformity import ConformityBounds, bounds_about, conformity_bounds
from condyle.sampling.conformity_curves import conformity_curves
from condyle.sampling.conformity_settings import ConformitySettings
from condyle.sampling.domain_global import GlobalDomain
from condyle.sampling.evaluate import equilibrium_solver

# Springs resist x with 0.8 x/SPACING of Fy: what they do at the middle counts for nothing.
SHEAR_SLOPE = 0.8 / SPACING
SETTINGS = ConformitySettings(
    body_weight=610.0, ap_shear=0.19, walking_force=1.4, high_force=2.9, travel_x=4.3e-3
)


def settled(x: float = 0.0011) -> np.ndarray:
    """Poses by flexion of a knee that rests at another x each."""
    flexion = np.linspace(0.0, 1.3, 5)
    poses = np.zeros((5, 6))
    poses[:, 0], poses[:, 1], poses[:, 2] = x - 0.002 * flexion, HEIGHT, 0.0004
    poses[:, 5] = -flexion
    return poses


def test_shear_bounds_x_where_statics_say(x: float = 0.0011) -> None:
    bounds = bounds_about(settled(x), SpringSolver(), SETTINGS)
    # Fx = slope x Fy is linear in x, so the crossing between two steps is exact but for rounding.
    reach = SETTINGS.ap_shear / SETTINGS.walking_force / SHEAR_SLOPE
    assert reach < SETTINGS.travel_x
    np.testing.assert_allclose(bounds.offsets[:, 0], [[-reach, reach]] * 5, rtol=1e-9)


def test_travel_bounds_what_nothing_resists() -> None:
    bounds = bounds_about(settled(), SpringSolver(), SETTINGS)
    # 0.05 z/SPACING of Fy stays below a tenth of a body weight over the travel; no torque at all.
    np.testing.assert_allclose(bounds.offsets[:, 1], [[-2e-3, 2e-3]] * 5, rtol=1e-12)
    np.testing.assert_allclose(bounds.offsets[:, 2], [[-np.pi / 18, np.pi / 18]] * 5, rtol=1e-12)


def test_the_edge_of_the_insert_bounds_x_before_shear_does() -> None:
    lax = dataclasses.replace(SETTINGS, ap_shear=9.0)
    bounds = bounds_about(settled(EDGE - 0.0017), SpringSolver(), lax)
    highest = bounds.settled[:, 0] + bounds.offsets[:, 0, 1]
    step = lax.travel_x / 10
    assert np.all(highest <= EDGE)
    # The last step that is on the insert, or the whole travel.
    assert np.all((highest > EDGE - step) | (bounds.offsets[:, 0, 1] == lax.travel_x))
    assert np.any(bounds.offsets[:, 0, 1] < lax.travel_x)


def test_arms_are_the_sides_distances_and_loads_share_by_them() -> None:
    bounds = bounds_about(settled(), SpringSolver(), SETTINGS)
    # One side alone carries at z = ∓SPACING; lift-off is bisected to 0.003°, which leaves the other
    # spring unloaded at the end that is taken.
    np.testing.assert_allclose(bounds.arms, [[SPACING, -SPACING]] * 5, rtol=1e-9)
    low, high = SETTINGS.medial_share
    Fy, Mx = bounds.loads[:, -2:, 0], bounds.loads[:, -2:, 1]
    medial = 0.5 * (1 + Mx / Fy / SPACING)
    np.testing.assert_allclose(medial, [[low, high]] * 5, rtol=1e-9)


def test_the_highest_load_is_what_the_settled_femur_bears() -> None:
    bounds = bounds_about(settled(), SpringSolver(), SETTINGS)
    # Springs give out at MAX_DEPTH · STIFFNESS = 1105 N a side: 0.8 of 0.7 of 2.9 body weights is
    # 991 N, 0.8 of 0.8 of them 1132 N.
    np.testing.assert_allclose(bounds.loads[:, -1, 0], 0.7 * 2.9 * 610.0)


def test_an_implant_that_bears_nothing_is_refused() -> None:
    heavy = dataclasses.replace(SETTINGS, high_force=9.0)
    with pytest.raises(
        InputDataError, match=r"0 flexions are found .* 4\.5 body weights are borne"
    ):
        bounds_about(settled(), SpringSolver(), heavy)


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("body_weight", 5.0, "body_weight is 5.0; it must be 50 to 3000"),
        ("walking_force", 0.05, "walking_force is 0.05; it must be 0.1 to 10"),
        ("high_force", 1.0, r"high_force is 1.0; it must be 1.4 to 10"),
        ("medial_share", (0.6, 0.4), r"medial_share is \(0.6, 0.4\); two rising shares"),
        ("travel_z", np.nan, "travel_z is nan; it must be"),
    ],
)
def test_settings_out_of_range_are_named(field: str, value: object, message: str) -> None:
    with pytest.raises(InputDataError, match=message):
        dataclasses.replace(SETTINGS, **{field: value})


@pytest.fixture(scope="module")
def bounds() -> ConformityBounds:
    return bounds_about(settled(), SpringSolver(), SETTINGS)


def test_the_curve_stands_at_every_bound_under_every_load(bounds: ConformityBounds) -> None:
    (curve,) = conformity_curves(bounds, SpringSolver()).curves
    assert len(curve.time) == 7 * 4 * 5
    # Up the flexions and down again.
    by_pass = curve.column("theta_z").reshape(28, 5)
    np.testing.assert_array_equal(by_pass[0::2], [bounds.settled[:, 5]] * 14)
    np.testing.assert_array_equal(by_pass[1::2], [bounds.settled[::-1, 5]] * 14)
    forward, backward = slice(None), slice(None, None, -1)
    for column, asked in (("Fy", bounds.loads[..., 0]), ("Mx", bounds.loads[..., 1])):
        carried = curve.column(column).reshape(7, 4, 5)
        for pattern in range(4):
            way = forward if pattern % 2 == 0 else backward
            expected = np.tile(asked[way, pattern], (7, 1))
            # A closed form, summed over the sides: a few eps of the load.
            np.testing.assert_allclose(carried[:, pattern], expected, rtol=1e-9, atol=1e-9)
    for stand, (column, moved) in enumerate(
        [("x", 0), ("x", 0), ("z", 1), ("z", 1), ("theta_y", 2), ("theta_y", 2)]
    ):
        settled_at = bounds.settled[:, (0, 2, 4)[moved]]
        found = curve.column(column).reshape(7, 4, 5)[stand + 1, 0]
        np.testing.assert_allclose(found, settled_at + bounds.offsets[:, moved, stand % 2])


def test_a_plan_samples_around_them_in_all_domains(
    bounds: ConformityBounds, tmp_path: Path
) -> None:
    curves = conformity_curves(bounds, SpringSolver())
    targets = tuple(DomainTarget(d, 60, 0 if d == 1 else 10) for d in (1, 2, 3, 4))
    plan = SamplingPlan(targets=targets, seed=11, pilot=48, chunk_rows=64)
    report = sample(plan, curves, SpringSolver(), tmp_path / "data", {"implant": "springs"})
    assert [d.train + d.test for d in report.domains] == [60, 70, 70, 70]


@pytest.fixture(scope="module")
def knee(tmp_path_factory: pytest.TempPathFactory) -> MeshContact:
    """The built-in implant, meshed coarsely and evaluated on its triangles: quick to build."""
    folder = tmp_path_factory.mktemp("implant")
    parameters = dataclasses.replace(preset("curved", side_of_body="left"), mesh_edge_length=2.2e-3)
    write_implant(folder, generate(parameters))
    return MeshContact.from_files(
        femur=folder / "femur.stl",
        insert_medial=folder / "insert_medial.stl",
        insert_lateral=folder / "insert_lateral.stl",
        units="m",
        side_of_body="left",
        evaluation="exact",
    )


def test_an_implants_own_bounds_enclose_its_settled_poses(knee: MeshContact) -> None:
    settings = ConformitySettings(max_flexion=0.7, flexion_step=0.35)
    found = []
    for threads in (1, 2):
        solver = equilibrium_solver(knee, max_depth=2e-3, threads=threads)
        found.append(conformity_curves(conformity_bounds(knee, solver, settings), solver))
    assert found[0].content_hash() == found[1].content_hash()
    box = GlobalDomain.around(found[0], widening=1.0, margins={}).box
    table = found[0].table(PRESCRIBED_COLUMNS)
    # A dished insert lets the femur go some millimetres, and not through its walls.
    spread = np.ptp(table, axis=0)
    assert 2e-3 < spread[0] < 0.02
    assert 2e-4 < spread[2] < 5e-3
    # Scores of the very points that the box is around: inside but for rounding.
    slack = 1e-9 * (box.high - box.low)
    scores = box.axes.scores(table)
    assert np.all((scores >= box.low - slack) & (scores <= box.high + slack))
