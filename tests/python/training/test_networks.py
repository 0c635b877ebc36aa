# SPDX-License-Identifier: Apache-2.0
"""The network: scaling inside, analytic Jacobian, parameter layout, seeded start."""

import pytest
import torch

from condyle.training import MinMaxMap, TanhMlp

EPS = torch.finfo(torch.float64).eps
#: SI-like columns: metres, radians, newtons.
LOW = torch.tensor([-0.004, 0.039, -1.3], dtype=torch.float64)
HIGH = torch.tensor([0.007, 0.046, 0.02], dtype=torch.float64)
OUT_LOW = torch.tensor([0.0, -31.0], dtype=torch.float64)
OUT_HIGH = torch.tensor([4100.0, 17.0], dtype=torch.float64)


def _inputs(n: int, seed: int) -> torch.Tensor:
    generator = torch.Generator().manual_seed(seed)
    return LOW + (HIGH - LOW) * torch.rand(n, 3, dtype=torch.float64, generator=generator)


def _net(seed: int = 8) -> TanhMlp:
    net = TanhMlp(
        MinMaxMap.from_data(torch.stack([LOW, HIGH])),
        MinMaxMap.from_data(torch.stack([OUT_LOW, OUT_HIGH])),
        (7, 5),
    )
    net.initialise(seed)
    return net


def test_data_map_to_minus_one_to_one_and_back():
    values = _inputs(50, 1)
    mapping = MinMaxMap.from_data(values)
    mapped = mapping(values)
    assert torch.allclose(mapped.min(0).values, -torch.ones(3, dtype=torch.float64), atol=8 * EPS)
    assert torch.allclose(mapped.max(0).values, torch.ones(3, dtype=torch.float64), atol=8 * EPS)
    assert torch.allclose(mapping.inverse(mapped), values, rtol=0, atol=8 * EPS)


def test_a_constant_column_maps_to_zero():
    values = torch.cat([_inputs(9, 1), torch.full((9, 1), 3.7, dtype=torch.float64)], dim=1)
    assert torch.equal(
        MinMaxMap.from_data(values)(values)[:, 3], torch.zeros(9, dtype=torch.float64)
    )


def test_folded_layers_are_the_same_function():
    net, inputs = _net(), _inputs(20, 2)
    expected = net(inputs).detach()
    found, jacobian = net.forward_and_jacobian(inputs)
    # Folding moves the offsets (y = 0.04 m against a range of 3 mm) into sums ten times larger.
    assert torch.allclose(found, expected, rtol=1e3 * EPS, atol=1e3 * EPS * 4100)
    assert jacobian.shape == (20, 2, 3)


def test_jacobian_equals_autograd():
    net, inputs = _net(), _inputs(12, 3)
    _, jacobian = net.forward_and_jacobian(inputs)
    expected = torch.stack(
        [torch.autograd.functional.jacobian(lambda x: net(x[None])[0], row) for row in inputs]
    )
    scale = expected.abs().amax(dim=(0, 2))[None, :, None]
    assert float(scale.min()) > 1.0
    assert float(((jacobian - expected) / scale).abs().max()) < 1e3 * EPS


def test_parameters_and_file_values_round_trip():
    net, inputs = _net(), _inputs(5, 4)
    copy = TanhMlp.from_dict(net.to_dict())
    assert torch.equal(copy(inputs), net(inputs))
    parameters = net.get_parameters()
    assert parameters.numel() == net.n_parameters == 4 * 7 + 8 * 5 + 6 * 2
    copy.set_parameters(parameters + 0.25)
    assert torch.equal(copy.get_parameters(), parameters + 0.25)


def test_the_start_depends_on_the_seed_only():
    assert torch.equal(_net(8).get_parameters(), _net(8).get_parameters())
    assert not torch.equal(_net(8).get_parameters(), _net(9).get_parameters())


def test_no_hidden_layer_is_refused():
    unit = MinMaxMap(torch.zeros(1), torch.ones(1))
    with pytest.raises(ValueError, match=r"hidden is \(\)"):
        TanhMlp(unit, unit, ())
