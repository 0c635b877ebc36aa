# SPDX-License-Identifier: Apache-2.0
"""The potential surrogate: conservative whatever its weights, smooth at lift-off, and able to learn."""

import numpy as np
import pytest
import torch

from condyle.errors import InputDataError
from condyle.training.generalised_force import generalised_force
from condyle.training.networks import MinMaxMap
from condyle.training.potential import PotentialSurrogate, SideEnergy
from condyle.training.potential_network import PotentialNetwork
from condyle.training.settings import TrainingSettings
from condyle.training.train_potential import train_potential

FY = 1


def _random_surrogate(power):
    generator = torch.Generator().manual_seed(81)
    sides = []
    for side in range(2):
        centre = torch.tensor([0, 0.035, 0, 0, 0, -0.8], dtype=torch.float64)
        half = torch.tensor([0.01, 0.004, 0.003, 0.05, 0.15, 0.9], dtype=torch.float64)
        network = PotentialNetwork(MinMaxMap(centre, half), (7, 5))
        parameters = 0.4 * torch.randn(
            network.n_parameters, dtype=torch.float64, generator=generator
        )
        network = PotentialNetwork(MinMaxMap(centre, half), (7, 5), parameters)
        sides.append(SideEnergy(network, 0.5 + side, power))
    return PotentialSurrogate((sides[0], sides[1]))


def _poses(n, seed):
    generator = np.random.default_rng(seed)
    return generator.uniform(-1, 1, (n, 6)) * [0.01, 0.004, 0.003, 0.05, 0.15, 0.9] + [
        0, 0.035, 0, 0, 0, -0.8,
    ]  # fmt: skip


@pytest.mark.parametrize("power", [2.5, 3.0])
def test_loads_are_minus_the_energys_gradient(power):
    surrogate, poses = _random_surrogate(power), _poses(40, 82)
    wrench = surrogate.wrench(poses)
    assert 10 < (wrench[:, :, FY] != 0).sum() < 70
    steps = np.array([1e-7, 1e-7, 1e-7, 1e-6, 1e-6, 1e-6])
    for side in range(2):
        Q = generalised_force(torch.from_numpy(poses), torch.from_numpy(wrench[:, side])).numpy()
        for k in range(6):
            step = steps[k] * np.eye(6)[k]
            up, down = (surrogate.energy(poses + sign * step)[:, side] for sign in (1, -1))
            slope = (up - down) / (2 * steps[k])
            # Central differences: rounding of an energy near 1 J over the step, and h² beside it.
            np.testing.assert_allclose(
                -slope, Q[:, k], rtol=1e-5, atol=4e-16 / steps[k] * 10 + 1e-6
            )


@pytest.mark.parametrize("power", [2.5, 3.0])
def test_stiffness_is_the_derivative_of_the_wrench(power):
    surrogate, poses = _random_surrogate(power), _poses(40, 83)
    _, stiffness = surrogate.wrench_and_stiffness(poses)
    for k, size in enumerate([1e-8, 1e-8, 1e-8, 1e-7, 1e-7, 1e-7]):
        step = size * np.eye(6)[k]
        up, down = surrogate.wrench(poses + step), surrogate.wrench(poses - step)
        # A side that lifts off within the step has a bend there.
        clear = (up[:, :, FY] != 0) == (down[:, :, FY] != 0)
        slope = (up - down) / (2 * size)
        scale = np.abs(stiffness[..., k]).max()
        np.testing.assert_allclose(
            slope[clear], stiffness[clear][..., k], rtol=1e-5, atol=1e-6 * scale
        )


def test_generalised_stiffness_is_symmetric():
    surrogate, poses = _random_surrogate(2.5), torch.from_numpy(_poses(200, 84))
    for side in surrogate.sides:
        value, gradient, hessian = side.network.second_order(poses)
        depth = value.clamp(min=0)
        K = (
            side.scale
            * 2.5
            * depth[:, None, None] ** 0.5
            * (depth[:, None, None] * hessian + 1.5 * gradient[:, :, None] * gradient[:, None, :])
        )
        asymmetry = (K - K.transpose(1, 2)).abs().max() / K.abs().max()
        assert asymmetry < 1e-13


def test_a_closed_loop_does_no_work():
    surrogate = _random_surrogate(2.5)
    centre, radius = _poses(2, 85)[:1], np.array([4e-3, 1e-3, 1e-3, 0.02, 0.05, 0.3])
    work, size = [], []
    for n in (200, 400):
        angle = 2 * np.pi * np.arange(n) / n
        phases = np.array([0.0, 0.9, 1.7, 2.6, 3.9, 5.1])
        poses = centre + radius * np.sin(angle[:, None] + phases)
        tangent = radius * np.cos(angle[:, None] + phases) * 2 * np.pi / n
        Q = sum(
            generalised_force(torch.from_numpy(poses), torch.from_numpy(w)).numpy()
            for w in surrogate.wrench(poses).transpose(1, 0, 2)
        )
        work.append((Q * tangent).sum())
        size.append(np.abs(Q * tangent).sum())
    # The trapezoid rule on a closed smooth path, bent where a side lifts off: fourth order or so.
    assert abs(work[1]) < 1e-6 * size[1]


def test_exactly_zero_beyond_lift_off_and_smooth_there():
    surrogate = _random_surrogate(2.5)
    poses = _poses(400, 86)
    value = surrogate.sides[0].network.value(torch.from_numpy(poses)).numpy()
    wrench, stiffness = surrogate.wrench_and_stiffness(poses)
    assert (wrench[value <= 0, 0] == 0).all() and (stiffness[value <= 0, 0] == 0).all()
    assert (np.abs(wrench[value > 0, 0]).max(axis=1) > 0).all()
    # Towards lift-off the stiffness fades as N^(p − 2) does: a tenth at a hundredth of the way.
    network = surrogate.sides[0].network
    low, high = poses[value > 0.05][0], poses[value < -0.05][0]
    for _ in range(60):
        middle = (low + high) / 2
        above = float(network.value(torch.from_numpy(middle[None]))[0]) > 0
        low, high = (middle, high) if above else (low, middle)
    away = poses[value > 0.05][0] - low
    near = np.array([low + share * away for share in (1e-4, 1e-6)])
    far, close = np.abs(surrogate.stiffness(near)[:, 0]).max(axis=(1, 2))
    assert close / far == pytest.approx(0.1, rel=0.05)


def test_powers_that_leave_a_kink_are_refused():
    side = _random_surrogate(2.5).sides[0]
    with pytest.raises(InputDataError, match="medial energy has power 2"):
        PotentialSurrogate((SideEnergy(side.network, 1.0, 2), side))


@pytest.fixture(scope="module")
def learned(contact):
    poses = contact.sample(1500, 91)
    settings = TrainingSettings(
        hidden_layers=2, neurons=10, max_epochs=40, patience=0, seed=4, power=3.0
    )
    return train_potential(poses, contact.wrench(poses), settings), settings, poses


def test_it_learns_the_synthetic_contact(contact, learned):
    (surrogate, record), _, _ = learned
    fresh = contact.sample(1500, 92)
    truth, found = contact.wrench(fresh), surrogate.wrench(fresh)
    loaded = truth[:, :, FY] > 0
    error = np.sqrt(((found - truth)[..., FY][loaded] ** 2).mean())
    # 191 weights a side: measured 2 % of the spread of Fy.
    assert error < 0.03 * truth[..., FY][loaded].std(), error
    assert [net.name.split(" ", 1)[1] for net in record.nets[:3]] == [
        "level", "wrench on 4 000", "wrench",
    ]  # fmt: skip


def test_equal_seeds_give_equal_bytes(contact, learned):
    (surrogate, record), settings, poses = learned
    again, other = train_potential(poses, contact.wrench(poses), settings)
    assert other.to_dict() == record.to_dict()
    for mine, theirs in zip(surrogate.sides, again.sides, strict=True):
        assert torch.equal(mine.network.parameters, theirs.network.parameters)


def test_saved_and_loaded_it_is_the_same(learned, tmp_path):
    (surrogate, _), _, poses = learned
    surrogate.save(tmp_path / "energy.pt")
    back = PotentialSurrogate.load(tmp_path / "energy.pt")
    np.testing.assert_array_equal(back.wrench(poses[:50]), surrogate.wrench(poses[:50]))


def test_it_goes_on_from_a_checkpoint_with_the_same_result(contact, learned, tmp_path):
    (surrogate, _), settings, poses = learned
    checkpoint = tmp_path / "checkpoint.pt"

    class Interrupted(Exception):
        pass

    def stop(net, epoch, *_):
        if net == "medial wrench on 4 000" and epoch == 7:
            raise Interrupted

    with pytest.raises(Interrupted):
        train_potential(
            poses, contact.wrench(poses), settings, progress=stop, checkpoint=checkpoint
        )
    again, _ = train_potential(poses, contact.wrench(poses), settings, checkpoint=checkpoint)
    for mine, theirs in zip(surrogate.sides, again.sides, strict=True):
        assert torch.equal(mine.network.parameters, theirs.network.parameters)
