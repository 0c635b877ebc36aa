# SPDX-License-Identifier: Apache-2.0
"""Sensitive directions: the diagonal of the generalised stiffness, and what is said of it."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from spring_contact import SpringSolver

from condyle._core.common import twist_map
from condyle.contact import Derivatives, MeshContact
from condyle.errors import CondyleError, InputDataError
from condyle.implants import generate, preset, write_implant
from condyle.sampling import Dataset, DomainTarget, ReferenceCurves, SamplingPlan, sample
from condyle.sampling.sensitive_directions import (
    SensitiveDirections,
    diagonal_stiffness,
    find_sensitive_directions,
    require_solvable,
)


def told(*stiffness: float) -> SensitiveDirections:
    return SensitiveDirections(np.zeros(6), 900.0, np.array(stiffness))


def test_the_diagonal_is_the_derivative_of_the_generalised_forces() -> None:
    rng = np.random.default_rng(31)
    pose = np.array([0.004, 0.04, -0.002, 0.21, -0.33, -0.87])
    offset, slope = 300.0 * rng.normal(size=6), 1e4 * rng.normal(size=(6, 6))

    def generalised(at: np.ndarray) -> np.ndarray:
        return twist_map(at).T @ (offset + slope @ (at - pose))

    h = 1e-5
    expected = np.empty(6)
    for j in range(6):
        step = np.eye(6)[j] * h
        expected[j] = -(generalised(pose + step) - generalised(pose - step))[j] / (2 * h)
    # Truncation h²/6 of third derivatives of 1e4: 1e-6; rounding eps·1e3/h: 1e-8.
    np.testing.assert_allclose(diagonal_stiffness(pose, slope), expected, atol=1e-5)
    assert np.all(expected != 0.0)


def test_the_stiffest_translation_and_the_stiffest_free_rotation_are_found() -> None:
    found = told(3e4, 5e6, 4e5, 3900.0, 60.0, 9000.0)
    assert found.found == ("y", "theta_x")  # θz is driven, however stiff
    assert found.times_stiffer("y") == pytest.approx(12.5)
    assert found.times_stiffer("theta_x") == pytest.approx(65.0)
    require_solvable(found)
    sentence = found.sentence()
    assert "y (5e+03 N/mm, 12.5 times the next)" in sentence
    assert f"theta_x ({math.radians(3900):.3g} Nm/deg, 65 times the next)" in sentence
    assert "x 30 N/mm" in sentence
    table = found.to_json()
    assert table["stiffness"]["theta_y"] == {
        "value": pytest.approx(math.radians(60)),
        "unit": "Nm/deg",
    }


def test_a_direction_beside_which_all_give_way_is_infinitely_stiffer() -> None:
    found = told(-10.0, 5e6, 0.0, 3900.0, -1.0, 9.0)
    assert found.times_stiffer("y") == math.inf
    assert found.to_json()["times_stiffer_than_next"] == {"y": None, "theta_x": None}
    assert "the next gives way" in found.sentence()


@pytest.mark.parametrize(
    ("stiffness", "named"),
    [((9e6, 5e6, 1.0, 90.0, 5.0, 1.0), "x"), ((1.0, 5e6, 1.0, 9.0, 80.0, 1.0), "theta_y")],
)
def test_other_directions_are_refused_with_the_way_out(
    stiffness: tuple[float, ...], named: str
) -> None:
    with pytest.raises(InputDataError) as caught:
        require_solvable(told(*stiffness))
    message = str(caught.value)
    assert f" {named} (" in message
    assert 'say sensitive_directions = ["y", "theta_x"] (or ["y"])' in message


@pytest.fixture(scope="module")
def knee(tmp_path_factory: pytest.TempPathFactory) -> MeshContact:
    folder = tmp_path_factory.mktemp("implant")
    parameters = dataclasses.replace(preset("curved"), mesh_edge_length=1.5e-3)
    write_implant(folder, generate(parameters))
    return MeshContact.from_files(
        femur=folder / "femur.stl",
        insert_medial=folder / "insert_medial.stl",
        insert_lateral=folder / "insert_lateral.stl",
        units="m",
        side_of_body="right",
        evaluation="exact",
    )


def test_a_knee_is_sensitive_in_y_and_theta_x(knee: MeshContact) -> None:
    found = find_sensitive_directions(knee)
    assert found.found == ("y", "theta_x")
    # A plateau on two condyles: an order of magnitude apart, not a close call.
    assert found.times_stiffer("y") > 5.0
    assert found.times_stiffer("theta_x") > 5.0
    loads = knee.evaluate(found.pose[None], Derivatives.none, threads=1).wrench.sum(axis=1)
    assert abs(loads[0, 1] - 1000.0) <= 0.001 * 1000.0 + 0.01  # the solver's tolerance


def test_a_seat_that_does_not_carry_says_so(knee: MeshContact) -> None:
    with pytest.raises(CondyleError, match=r"the seat does not carry 60000 N: overclosure"):
        find_sensitive_directions(knee, Fy=6e4)


def test_with_y_alone_theta_x_is_drawn_as_part_of_the_pose(
    curves: ReferenceCurves, tmp_path: Path
) -> None:
    targets = tuple(DomainTarget(d, 40, 0 if d == 1 else 8) for d in (1, 2, 3, 4))
    plan = SamplingPlan(
        targets=(*targets, DomainTarget(5, 80, 16), DomainTarget(6, 20, 4)),
        seed=7,
        pilot=48,
        chunk_rows=64,
        sensitive_directions=("y",),
    )
    sample(plan, curves, SpringSolver(), tmp_path / "data", {"implant": "springs"})
    theta_x = curves.table(("theta_x",))
    middle, half = (theta_x.max() + theta_x.min()) / 2, np.ptp(theta_x) / 2
    drawn = {d: Dataset.read(tmp_path / "data").select(domain=d).poses[:, 3] for d in (1, 2, 4)}
    assert np.all(np.abs(drawn[4] - middle) <= 1.5 * half * (1 + 1e-12))
    for domain, values in drawn.items():
        assert np.ptp(values) > half, f"domain {domain}"
    # Solved for with Mx prescribed, θx would follow from it; drawn, it is a coordinate of its own.
    loads = Dataset.read(tmp_path / "data").select(domain=4).wrenches.sum(axis=1)
    assert np.all((loads[:, 1] > 0) & (loads[:, 1] <= plan.boundary_max_Fy * 1.002))


def test_a_plan_refuses_directions_that_cannot_be_solved_for() -> None:
    with pytest.raises(
        InputDataError, match=r"sensitive_directions is \('x',\); \('y', 'theta_x'\)"
    ):
        SamplingPlan(targets=(DomainTarget(2, 5, 1),), seed=1, sensitive_directions=("x",))
