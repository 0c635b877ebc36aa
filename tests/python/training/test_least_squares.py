# SPDX-License-Identifier: Apache-2.0
"""Normal equations: the blockwise back-propagation against the Jacobian that autograd forms."""

from itertools import pairwise

import pytest
import torch
from torch import Tensor

from condyle.training import AutogradLeastSquares, MlpLeastSquares

WIDTHS = (3, 5, 4, 2)
N_ROWS = 17
EPS64, EPS32 = torch.finfo(torch.float64).eps, torch.finfo(torch.float32).eps


def _case(seed: int) -> dict[str, Tensor]:
    generator = torch.Generator().manual_seed(seed)

    def draw(*shape: int) -> Tensor:
        return 2 * torch.rand(*shape, dtype=torch.float64, generator=generator) - 1

    n_parameters = sum((a + 1) * b for a, b in pairwise(WIDTHS))
    return {
        "inputs": draw(N_ROWS, WIDTHS[0]),
        "targets": draw(N_ROWS, WIDTHS[-1]),
        "weights": draw(N_ROWS, WIDTHS[-1]).abs() + 0.1,
        "one_sided": draw(N_ROWS, WIDTHS[-1]) > 0.2,
        "parameters": 0.8 * draw(n_parameters),
    }


def _residuals(case: dict[str, Tensor]):
    """The same errors, written the plain way for autograd."""

    def residuals(parameters: Tensor) -> Tensor:
        hidden, start = case["inputs"], 0
        for index, (into, out) in enumerate(pairwise(WIDTHS)):
            layer = parameters[start : start + out * (into + 1)].view(out, into + 1)
            start += layer.numel()
            hidden = hidden @ layer[:, :-1].T + layer[:, -1]
            if index < len(WIDTHS) - 2:
                hidden = torch.tanh(hidden)
        errors = hidden - case["targets"]
        errors = torch.where(case["one_sided"], errors.clamp(min=0.0), errors)
        return (case["weights"].sqrt() * errors).flatten()

    return residuals


def _mlp(case: dict[str, Tensor], **options: object) -> MlpLeastSquares:
    return MlpLeastSquares(
        WIDTHS,
        case["inputs"],
        case["targets"],
        weights=case["weights"],
        one_sided=case["one_sided"],
        **options,
    )


@pytest.mark.parametrize("seed", [1, 2, 3])
# A float32 product of numbers of order 1 is off by eps32 each; sums of 17 rows by a few of that.
@pytest.mark.parametrize(
    ("precision", "tolerance"), [("float64", 1e3 * EPS64), ("mixed", 50 * EPS32)]
)
def test_blockwise_normal_equations_equal_those_of_the_explicit_jacobian(
    seed, precision, tolerance
):
    case = _case(seed)
    parameters = case["parameters"]
    expected = AutogradLeastSquares(_residuals(case), len(parameters)).normal_equations(parameters)
    found = _mlp(case, precision=precision, chunk_rows=5).normal_equations(parameters)
    scale = float(expected.jtj.abs().max())
    assert scale > 0.1
    assert float((found.jtj - expected.jtj).abs().max()) <= tolerance * scale
    # Jᵀe is float64 in either precision: it decides where the minimum is.
    scale = float(expected.jte.abs().max())
    assert float((found.jte - expected.jte).abs().max()) <= 1e3 * EPS64 * scale
    assert found.sum_of_squares == pytest.approx(expected.sum_of_squares, rel=1e3 * EPS64)
    assert torch.equal(found.jtj, found.jtj.T)


def test_inactive_one_sided_errors_do_not_count():
    case = _case(4)
    case["one_sided"] = torch.ones_like(case["one_sided"])
    case["targets"] = torch.full_like(case["targets"], 100.0)
    equations = _mlp(case).normal_equations(case["parameters"])
    assert equations.n_errors == 0
    assert equations.sum_of_squares == 0.0
    assert float(equations.jtj.abs().max()) == 0.0


@pytest.mark.parametrize("chunk_rows", [1, 6, 1000])
def test_chunks_only_change_rounding(chunk_rows):
    case = _case(5)
    whole = _mlp(case, chunk_rows=N_ROWS).normal_equations(case["parameters"])
    parts = _mlp(case, chunk_rows=chunk_rows).normal_equations(case["parameters"])
    limit = 1e3 * EPS64 * float(whole.jtj.abs().max())
    assert float((whole.jtj - parts.jtj).abs().max()) <= limit
    assert whole.n_errors == parts.n_errors


def test_shapes_that_do_not_fit_are_refused():
    case = _case(6)
    with pytest.raises(ValueError, match=r"targets \(17, 1\) do not fit widths"):
        MlpLeastSquares(WIDTHS, case["inputs"], case["targets"][:, :1])
    with pytest.raises(ValueError, match="chunk_rows is 0"):
        _mlp(case, chunk_rows=0)
