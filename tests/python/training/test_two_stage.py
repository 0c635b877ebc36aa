# SPDX-License-Identifier: Apache-2.0
"""The surrogate as a contact model: gate, stiffness, files; and the oracle it is trained on."""

import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.training import TwoStageSurrogate

FY = 1


def test_the_synthetic_contact_pushes_down_its_energy_gradient(contact):
    """Guards the oracle: with U = Σ k d³/3, ∂U/∂(x, y, z) = −(Fx, Fy, Fz) and ∂U/∂θx = Mx."""
    poses = contact.sample(40, 21)

    def energy(poses):
        depths = [np.maximum(contact._depths(poses, side)[0], 0) for side in contact.SPHERES]
        return contact.STIFFNESS * sum((d**3).sum(1) for d in depths) / 3

    total = contact.wrench(poses).sum(axis=1)
    step = 1e-6
    for column, load, sign in ((0, 0, -1), (1, 1, -1), (2, 2, -1), (3, 3, 1)):
        ahead, behind = poses.copy(), poses.copy()
        ahead[:, column] += step
        behind[:, column] -= step
        slope = (energy(ahead) - energy(behind)) / (2 * step)
        scale = np.abs(total[:, load]).max()
        assert scale > 1
        # Third derivative k·d⁰ ≈ 2·1.6e9·(few): step²·U'''/6 is 1e-3 N; moments have an arm of 0.03
        # m.
        np.testing.assert_allclose(sign * slope, total[:, load], rtol=0, atol=1e-5 * scale)


def test_a_lifted_side_carries_exactly_nothing(trained):
    poses = trained.test.poses
    fy = trained.surrogate.ungated_fy(poses)
    wrench, stiffness = trained.surrogate.wrench_and_stiffness(poses)
    lifted = fy <= 0
    assert 0.1 < lifted.mean() < 0.9
    assert (wrench[lifted] == 0).all() and (stiffness[lifted] == 0).all()
    np.testing.assert_allclose(wrench[~lifted][:, FY], fy[~lifted], rtol=1e-10, atol=1e-9)
    assert (wrench[~lifted] != 0).all()


def test_far_above_the_insert_there_is_no_contact_or_no_trust(trained):
    poses = trained.test.poses + np.array([0, 0.02, 0, 0, 0, 0])
    wrench = trained.surrogate.wrench(poses)
    trust = trained.trust.trust(poses, wrench)
    assert ((wrench == 0).all(axis=(1, 2)) | (trust < 0.5)).all()


def test_stiffness_equals_central_differences_of_the_wrench(trained):
    poses = trained.test.poses
    # Away from the gate, where the wrench jumps.
    fy = trained.surrogate.ungated_fy(poses)
    poses = poses[(np.abs(fy) > 50).all(axis=1)][:100]
    stiffness = trained.surrogate.stiffness(poses)
    step = 2e-6
    for column in range(6):
        offset = step * np.eye(6)[column]
        near = trained.surrogate.wrench(poses + offset) - trained.surrogate.wrench(poses - offset)
        far = trained.surrogate.wrench(poses + 2 * offset) - trained.surrogate.wrench(
            poses - 2 * offset
        )
        # The 4-point stencil leaves step⁴/30 of the fifth derivative, which features of the network
        # 0.1 mm wide make 1e-8 of the largest entry; rounding is 1e3·eps·F/(K·step), 1e-9 or less.
        numeric = (8 * near - far) / (12 * step)
        analytic = stiffness[..., column]
        scale = np.abs(analytic).max(axis=(0, 1))
        assert (scale > 0).all() and not np.array_equal(numeric, analytic)
        assert (np.abs(numeric - analytic) <= 1e-6 * scale).all()


def test_wrench_alone_and_with_stiffness_agree(trained):
    alone = trained.surrogate.wrench(trained.test.poses)
    together, _ = trained.surrogate.wrench_and_stiffness(trained.test.poses)
    # Scaling is folded into the weights in one and not in the other: rounding only.
    rms = np.sqrt((alone**2).mean(axis=(0, 1)))
    assert (np.abs(alone - together) <= 1e-10 * (np.abs(alone) + rms)).all()


def test_files_round_trip_and_damage_is_named(trained, tmp_path):
    path = tmp_path / "surrogate.pt"
    trained.surrogate.save(path)
    loaded = TwoStageSurrogate.load(path)
    np.testing.assert_array_equal(
        loaded.wrench(trained.test.poses), trained.surrogate.wrench(trained.test.poses)
    )
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(InputDataError, match=r"surrogate\.pt: not a readable torch file"):
        TwoStageSurrogate.load(path)
    with pytest.raises(InputDataError, match=r"absent\.pt: no such file"):
        TwoStageSurrogate.load(tmp_path / "absent.pt")


@pytest.mark.parametrize(
    ("poses", "message"),
    [
        (np.zeros((3, 5)), r"poses has shape \(3, 5\); it must be \(n, 6\)"),
        (np.full((2, 6), np.nan), "poses row 0 column x is nan"),
    ],
)
def test_unfit_poses_are_refused(trained, poses, message):
    with pytest.raises(InputDataError, match=message):
        trained.surrogate.wrench(poses)


def test_networks_of_other_shapes_are_refused(trained):
    first, (medial, _) = trained.surrogate.first, trained.surrogate.second
    with pytest.raises(InputDataError, match="net III has 6 inputs and 4 outputs; it must have 8"):
        TwoStageSurrogate(first, (medial, first))
