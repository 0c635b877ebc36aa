# SPDX-License-Identifier: Apache-2.0
"""Normal equations and derivatives of the energy network, against automatic differentiation."""

import numpy as np
import pytest
import torch

from condyle.training.least_squares import AutogradLeastSquares
from condyle.training.networks import MinMaxMap, TanhMlp
from condyle.training.potential_least_squares import PotentialLeastSquares
from condyle.training.potential_network import (
    PotentialNetwork,
    n_terms,
    network_value,
    quadratic_terms,
    second_order_pass,
    value_and_gradient,
)


def _random(*shape, seed):
    generator = torch.Generator().manual_seed(seed)
    return torch.randn(*shape, dtype=torch.float64, generator=generator)


@pytest.fixture
def network():
    input_map = MinMaxMap(_random(6, seed=1), _random(6, seed=2).abs() + 0.5)
    network = PotentialNetwork(input_map, (5, 4))
    return PotentialNetwork(input_map, (5, 4), 0.5 * _random(network.n_parameters, seed=3))


def test_derivatives_with_respect_to_the_pose(network):
    poses = _random(20, 6, seed=4)
    value, gradient, hessian = network.second_order(poses)

    def of_one(pose):
        return network.value(pose[None])[0]

    for row, pose in enumerate(poses):
        torch.testing.assert_close(value[row], of_one(pose))
        torch.testing.assert_close(gradient[row], torch.func.grad(of_one)(pose))
        torch.testing.assert_close(hessian[row], torch.func.jacrev(torch.func.jacrev(of_one))(pose))


def test_the_cheap_passes_agree_with_the_full_one(network):
    layers, coefficients = network.split(network.parameters)
    inputs = _random(20, 6, seed=5)
    done = second_order_pass(layers, coefficients, inputs)
    value, gradient = value_and_gradient(layers, coefficients, inputs)
    torch.testing.assert_close(value, done.value)
    torch.testing.assert_close(gradient, done.gradient)
    torch.testing.assert_close(network_value(layers, coefficients, inputs), done.value)


def test_a_network_from_an_mlp_and_a_quadratic_part_is_their_sum():
    mlp = TanhMlp(
        MinMaxMap(_random(6, seed=6), _random(6, seed=7).abs() + 0.5),
        MinMaxMap(torch.tensor([0.3]), torch.tensor([2.0])),
        (5, 4),
    )
    mlp.initialise(8)
    coefficients, poses = _random(n_terms(6), seed=9), _random(20, 6, seed=10)
    network = PotentialNetwork.from_mlp(mlp, coefficients, 0.7)
    expected = mlp(poses)[:, 0] + quadratic_terms(mlp.input_map(poses)) @ coefficients + 0.7
    torch.testing.assert_close(network.value(poses), expected.detach())
    layers, matrix, slope, shift = network.folded()
    hidden = poses
    for weight, bias in layers[:-1]:
        hidden = torch.tanh(hidden @ weight.T + bias)
    weight, bias = layers[-1]
    quadratic = ((poses @ matrix) * poses).sum(dim=1) + poses @ slope + shift
    folded = (hidden @ weight.T + bias)[:, 0] + quadratic
    torch.testing.assert_close(folded, expected.detach())


@pytest.mark.parametrize("power", [2.5, 3.0])
def test_normal_equations_agree_with_automatic_differentiation(network, power):
    poses, forces, weights = (
        _random(40, 6, seed=11),
        _random(40, 6, seed=12),
        torch.rand(6).double(),
    )
    problem = PotentialLeastSquares(
        network, poses, forces, weights=weights, scale=1.3, power=power, chunk_rows=7
    )
    inputs, half_range = network.input_map(poses), network.input_map.half_range

    def residuals(parameters):
        layers, coefficients = network.split(parameters)
        value, gradient = value_and_gradient(layers, coefficients, inputs)
        loaded = value > 0
        # where() twice, or the derivative of the power at zero would be NaN · 0.
        depth = torch.where(loaded, value, torch.ones_like(value))
        force = torch.where(loaded, 1.3 * power * depth ** (power - 1), torch.zeros_like(value))
        return (weights * (-force[:, None] * gradient / half_range - forces)).reshape(-1)

    expected = AutogradLeastSquares(residuals, network.n_parameters).normal_equations(
        network.parameters
    )
    found = problem.normal_equations(network.parameters)
    assert 5 < int((network.value(poses) > 0).sum()) < 35
    scale = float(expected.jtj.abs().max())
    np.testing.assert_allclose(found.jtj, expected.jtj, atol=1e-12 * scale)
    np.testing.assert_allclose(found.jte, expected.jte, rtol=1e-10, atol=1e-10)
    assert found.sum_of_squares == pytest.approx(expected.sum_of_squares, rel=1e-12)
    assert problem.sum_of_squares(network.parameters) == found.sum_of_squares
    assert found.n_errors == 240


def test_mixed_precision_touches_only_the_matrix(network):
    poses, forces = _random(40, 6, seed=13), _random(40, 6, seed=14)
    options = dict(weights=torch.ones(6, dtype=torch.float64), scale=1.0, power=2.5)
    exact = PotentialLeastSquares(network, poses, forces, **options)
    mixed = PotentialLeastSquares(network, poses, forces, precision="mixed", **options)
    a, b = (p.normal_equations(network.parameters) for p in (exact, mixed))
    assert torch.equal(a.jte, b.jte) and a.sum_of_squares == b.sum_of_squares
    # Single precision: 6e-8 a product, some tens of them.
    np.testing.assert_allclose(b.jtj, a.jtj, atol=1e-5 * float(a.jtj.abs().max()))
    assert not torch.equal(a.jtj, b.jtj)
