# SPDX-License-Identifier: Apache-2.0
"""Equilibria under given loads: recomputed from public functions, failures told, mistakes named."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from condyle._core.common import twist_map
from condyle._core.fdk import ligament_length, ligament_tension, ligament_wrench
from condyle.contact import Derivatives, MeshContact
from condyle.errors import InputDataError
from condyle.fdk import GivenLoadsSettings, default_ligaments, seated_pose, solve_given_loads
from condyle.recruitment import Reserves

NAMES = ("hip", "knee", "ankle")
MUSCLES = (
    "quadriceps",
    "hamstrings",
    "gastrocnemius",
    "soleus",
    "tibialis",
    "iliopsoas",
    "gluteus",
)
ARMS = np.array(
    [
        [0.000, -0.061, 0.000, 0.000, 0.000, 0.052, -0.057],
        [-0.046, 0.036, 0.023, 0.000, 0.000, 0.000, 0.000],
        [0.000, 0.000, -0.044, -0.041, 0.036, 0.000, 0.000],
    ]
)
SECONDARY_ARMS = np.zeros((5, 7))
SECONDARY_ARMS[:, :3] = [
    [-0.21, 0.27, -0.41],
    [-0.97, -0.95, -0.88],
    [0.03, -0.02, 0.04],
    [-0.002, 0.006, 0.001],
    [0.003, 0.002, -0.004],
]
STRENGTHS = np.array([4700.0, 2300.0, 1800.0, 3600.0, 900.0, 1900.0, 2100.0])


def stance(t: int) -> dict[str, Any]:
    """Loads that rise and fall over t time frames while the knee flexes."""
    phase = np.linspace(0.0, 1.0, t)
    rise = (0.1 + np.sin(3.0 * phase))[:, None]
    return {
        "flexion": 0.05 + 0.5 * phase**2,
        "loads": rise * [-21.0, -15.0, -32.0],
        "secondary_loads": rise * [23.0, 540.0, 11.0, -13.0, 1.3],
        "moment_arms": np.stack([ARMS] * t),
        "secondary_arms": np.stack([SECONDARY_ARMS] * t),
        "strengths": STRENGTHS,
        "knee_coordinate": "knee",
        "coordinate_names": NAMES,
        "muscle_names": MUSCLES,
    }


@pytest.fixture(scope="module")
def ligaments(right_knee: MeshContact) -> list[Any]:
    return default_ligaments("right", seated_pose(right_knee).pose)


def passive(ligaments: list[Any], pose: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.sum([ligament_wrench(x, pose) for x in ligaments], axis=0))


def test_every_time_frame_is_in_equilibrium(right_knee: MeshContact, ligaments: list[Any]) -> None:
    given = stance(15)
    found = solve_given_loads(right_knee, "right", ligaments=ligaments, **given)
    assert found.converged and set(found.status) == {"converged"}, found.summary
    assert found.summary == "15 of 15 time frames converged"
    assert found.messages == ("",) * 15
    np.testing.assert_array_equal(found.poses[:, 5], -given["flexion"])
    contact = right_knee.evaluate(found.poses, Derivatives.none, 1).wrench
    np.testing.assert_array_equal(contact, found.wrenches)
    for i, pose in enumerate(found.poses):
        Q = twist_map(pose).T @ (contact[i].sum(axis=0) + passive(ligaments, pose))
        f = found.muscle_forces[i]
        r = Q[:5] + SECONDARY_ARMS @ f - given["secondary_loads"][i]
        # Newton's tolerances; r twice from the same pose: rounding, and recruitment's 1e-9 of 1e3 N.
        assert np.all(np.abs(r) <= np.array([0.01] * 3 + [5e-4] * 2) + 1e-6)
        np.testing.assert_allclose(r, found.residuals[i], atol=1e-6)
        needed = given["loads"][i] + [0.0, Q[5], 0.0]  # flexion is -theta_z
        np.testing.assert_allclose(ARMS @ f, needed, atol=1e-6)
        tensions = [ligament_tension(x, ligament_length(x, pose)) for x in ligaments]
        np.testing.assert_array_equal(found.ligament_tensions[i], tensions)
    assert np.all(found.residual <= 1.0)
    assert np.all(found.muscle_forces >= 0.0)
    np.testing.assert_allclose(found.activities, found.muscle_forces / STRENGTHS, rtol=1e-12)


def test_a_coordinate_may_count_extension(right_knee: MeshContact, ligaments: list[Any]) -> None:
    given = stance(3)
    a = solve_given_loads(right_knee, "right", ligaments=ligaments, **given)
    sign = np.array([1.0, -1.0, 1.0])
    turned = given | {
        "loads": given["loads"] * sign,
        "moment_arms": given["moment_arms"] * sign[:, None],
        "knee_counts_flexion": False,
        "knee_coordinate": 1,
    }
    b = solve_given_loads(right_knee, "right", ligaments=ligaments, **turned)
    # The same equations: the same path but for rounding, which the softest direction raises.
    np.testing.assert_allclose(a.poses, b.poses, atol=1e-8)
    np.testing.assert_allclose(a.muscle_forces, b.muscle_forces, atol=1e-3)


def test_arms_that_do_not_change_and_a_wrench(
    right_knee: MeshContact, ligaments: list[Any]
) -> None:
    given = stance(2)
    plain = solve_given_loads(right_knee, "right", ligaments=ligaments, **given)
    still = solve_given_loads(
        right_knee,
        "right",
        ligaments=ligaments,
        arms_by_pose=np.zeros((2, 5, 8, 7)),
        arms_at=np.zeros((2, 5)),
        **given,
    )
    np.testing.assert_allclose(plain.poses, still.poses, atol=1e-9)
    loads = given.pop("secondary_loads")
    wrench = np.array(
        [
            np.linalg.solve(twist_map(p).T, [*q, 0.0])
            for p, q in zip(plain.poses, loads, strict=True)
        ]
    )
    other = solve_given_loads(right_knee, "right", ligaments=ligaments, wrench=wrench, **given)
    assert other.converged, other.summary
    # Tolerances of 0.01 N over the softest stiffness, some 1e2 N/m along z.
    np.testing.assert_allclose(other.poses, plain.poses, atol=2e-4)


def test_what_muscles_cannot_do_is_told_and_the_rest_is_kept(
    right_knee: MeshContact, ligaments: list[Any]
) -> None:
    given = stance(5)
    given["loads"][2, 0] = 150.0  # all there is: 1900 N, 0.052 m: 98.8 Nm
    found = solve_given_loads(right_knee, "right", ligaments=ligaments, **given)
    assert not found.converged
    assert list(found.status) == ["converged"] * 2 + ["infeasible"] + ["converged"] * 2
    assert "hip" in found.messages[2]
    assert "time frame 2" in found.summary
    helped = solve_given_loads(
        right_knee, "right", ligaments=ligaments, reserves=Reserves(1.0), **given
    )
    assert helped.converged, helped.summary
    assert helped.reserves[2, 0] > 51.0


def test_a_start_of_ones_own(right_knee: MeshContact, ligaments: list[Any]) -> None:
    given = stance(1)
    seated = solve_given_loads(right_knee, "right", ligaments=ligaments, **given)
    settings = GivenLoadsSettings()
    settings.initial_pose = seated.poses[0]
    again = solve_given_loads(right_knee, "right", ligaments=ligaments, settings=settings, **given)
    assert again.iterations[0] <= 1 < seated.iterations[0]
    np.testing.assert_allclose(again.poses, seated.poses, atol=2e-4)  # as above


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"knee_coordinate": "knie"}, "'knie' is not among coordinate_names"),
        ({"knee_coordinate": 3}, "knee_coordinate is 3: must be 0 to 2"),
        ({"criterion": "cubic"}, "criterion 'cubic'"),
        ({"flexion": [0.1]}, "loads has 2 time frames, flexion has 1"),
        ({"loads": np.zeros((2, 2))}, r"time frame 0: loads has shape \(2, 1\): must be \(3, 1\)"),
        ({"strengths": -STRENGTHS}, "quadriceps"),
        ({"arms_at": np.zeros((2, 5))}, "give arms_by_pose and arms_at, or neither"),
        ({"secondary_loads": np.zeros((2, 6))}, "secondary_loads has 6 columns: must be 5"),
        ({"moment_arms": ARMS}, "moment_arms has shape"),
    ],
)
def test_mistakes_are_named(right_knee: MeshContact, change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputDataError, match=message):
        solve_given_loads(right_knee, "right", **(stance(2) | change))


def test_the_other_knee_is_refused(left_knee: MeshContact) -> None:
    with pytest.raises(InputDataError, match="of a left knee, the loads are of a right one"):
        solve_given_loads(left_knee, "right", **stance(2))
