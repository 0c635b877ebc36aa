# SPDX-License-Identifier: Apache-2.0
"""The knee simulator: every time frame is in equilibrium, left knees mirror right ones, failures are told."""

from dataclasses import replace

import numpy as np
import pytest

from condyle._core.common import clinical_kinematics, side_of_body, twist_map
from condyle.activities import BUILT_IN, LoadCase, load_case
from condyle.contact import Derivatives, MeshContact
from condyle.errors import InputDataError
from condyle.fdk import (
    KneeSimulation,
    KneeSimulatorSettings,
    default_ligaments,
    settled_pose,
    simulate_knee,
)


def thinned(case: LoadCase, step: int) -> LoadCase:
    rows = slice(None, None, step)
    return replace(
        case,
        time=case.time[rows],
        flexion=case.flexion[rows],
        axial_force=case.axial_force[rows],
        ap_force=case.ap_force[rows],
        ie_torque=case.ie_torque[rows],
    )


@pytest.fixture(scope="module")
def gait() -> LoadCase:
    return thinned(load_case("iso_like_gait"), 4)


@pytest.fixture(scope="module")
def right(right_knee: MeshContact, gait: LoadCase) -> KneeSimulation:
    return simulate_knee(right_knee, gait)


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_built_in_activity_is_borne(right_knee: MeshContact, name: str) -> None:
    case = thinned(load_case(name), 6)
    result = simulate_knee(right_knee, case)
    assert set(result.status) == {"converged"}, result.summary
    # What was applied along y is what the contact carries: springs and torque add nothing there.
    carried = result.wrenches[:, :, 1].sum(axis=1)
    np.testing.assert_allclose(carried, case.axial_force, atol=0.01 + 1e-9)


def test_every_time_frame_is_in_equilibrium(
    right_knee: MeshContact, gait: LoadCase, right: KneeSimulation
) -> None:
    assert right.converged, right.summary
    assert set(right.status) == {"converged"}
    contact = right_knee.evaluate(right.poses, Derivatives.none, 1).wrench.sum(axis=1)
    for i, pose in enumerate(right.poses):
        x, y, z = pose[:3]
        F, P, T = gait.axial_force[i], gait.ap_force[i], gait.ie_torque[i]
        # On the femur of a right knee: axial line at z = -offset, AP line through To, torque about -y.
        applied = [-P, -F, 0.0, (-right.axial_offset - z) * F, z * P - T, x * F - y * P]
        force = twist_map(pose).T @ (contact[i] + applied)
        force[0] -= right.restraint.ap_stiffness * (x - right.restraint.reference_x)
        force[4] -= right.restraint.ie_stiffness * (pose[4] - right.restraint.reference_theta_y)
        assert np.all(np.abs(force[:3]) <= 0.01 + 1e-9)
        assert np.all(np.abs(force[3:5]) <= 5e-4 + 1e-9)
        np.testing.assert_allclose(right.residuals[i], force[:5], atol=1e-8)
    np.testing.assert_array_equal(right.poses[:, 5], -gait.flexion)
    assert np.all(right.residual <= 1.0)
    np.testing.assert_array_equal(right.trust, 1.0)
    np.testing.assert_array_equal(
        right.kinematics, clinical_kinematics(right.poses, side_of_body("right"))
    )


def test_medial_side_carries_the_larger_share(gait: LoadCase, right: KneeSimulation) -> None:
    share = right.wrenches[:, 0, 1] / right.wrenches[:, :, 1].sum(axis=1)
    assert np.all(share > 0.5)
    assert np.all(share < 0.85)


def test_left_knee_mirrors_the_right_one(
    left_knee: MeshContact, gait: LoadCase, right: KneeSimulation
) -> None:
    left = simulate_knee(left_knee, gait)
    assert left.converged
    mirror = np.array([1.0, 1.0, -1.0, -1.0, -1.0, 1.0])
    # Both within the solver's tolerance of the same equilibrium: 0.01 N over the softest stiffness (z, some 1e3 N/m).
    np.testing.assert_allclose(left.poses * mirror, right.poses, atol=2e-5)
    np.testing.assert_allclose(left.kinematics, right.kinematics, atol=2e-5)


def test_ligaments_can_take_the_springs_place(right_knee: MeshContact, gait: LoadCase) -> None:
    settings = KneeSimulatorSettings()
    settings.restraint.ap_stiffness = 0.0
    settings.restraint.ie_stiffness = 0.0
    settings.ligaments = default_ligaments("right", settled_pose(right_knee))
    assert len(settings.ligaments) == 8
    held = simulate_knee(right_knee, thinned(gait, 5), settings)
    assert held.converged, held.summary


def test_what_does_not_converge_is_told(right_knee: MeshContact) -> None:
    impossible = LoadCase(
        "pull",
        *[np.array(v) for v in ([0.0, 1.0], [0.1, 0.1], [300.0, 300.0], [0.0, 4000.0], [0, 0])],
    )
    settings = KneeSimulatorSettings()
    settings.restraint.ap_stiffness = 0.0
    settings.max_substeps = 4
    simulated = simulate_knee(right_knee, impossible, settings)
    assert not simulated.converged
    assert list(simulated.status) == ["converged", "not_converged"]
    assert simulated.residual[1] > 1.0
    assert simulated.worst_coordinate[1] in ("x", "y", "z", "theta_x", "theta_y")
    assert "first not converged: time frame 1" in simulated.summary


def test_mistakes_are_named(right_knee: MeshContact, gait: LoadCase) -> None:
    with pytest.raises(
        InputDataError, match="activity 'iso_like_gait': load case 'given': flexion in row 1 is"
    ):
        simulate_knee(
            right_knee, replace(gait, flexion=np.degrees(gait.flexion) + 4.0 * (gait.time > 0))
        )
    settings = KneeSimulatorSettings()
    settings.newton.force_tolerance = 0.0
    with pytest.raises(
        InputDataError, match=r"force_tolerance is 0.000000: must be finite and above 0"
    ):
        simulate_knee(right_knee, gait, settings)
    with pytest.raises(InputDataError, match="flexion is nan"):
        settled_pose(right_knee, np.nan)
    with pytest.raises(InputDataError, match="six finite values"):
        default_ligaments("left", [0.0] * 5)
