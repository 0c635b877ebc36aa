# SPDX-License-Identifier: Apache-2.0
"""Normal equations of the energy network, fitted to generalised forces.

With the energy of a side U = c·max(N, 0)^p, the errors of a loaded sample are

    e_k = v_k·(−c p N₊^(p−1) ∂N/∂u_k / h_k − Q_k),    k over the six pose coordinates,

and where N ≤ 0 the prediction is zero, with no derivative. A sample without load that the network
leaves without load is an error of zero and takes no further part.

In every layer, and in the quadratic part taken as one, a row of the Jacobian has rank two,
A_k ⊗ a + δ ⊗ B_k, with

    A_k = ∂e_k/∂N δ + ∂e_k/∂(∂N/∂u_k) ∂δ/∂u_k,    B_k = ∂e_k/∂(∂N/∂u_k) ∂a/∂u_k,

so a block of JᵀJ, summed over a sample's six errors first, is four products of per-row outer
products, as in :mod:`condyle.training.mlp_least_squares`: for a 3×30 network a third of the
operations that the explicit Jacobian takes.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from condyle.training.least_squares import NormalEquations
from condyle.training.mlp_least_squares import Precision
from condyle.training.potential_network import (
    PotentialNetwork,
    SecondOrderPass,
    quadratic_tangents,
    quadratic_terms,
    second_order_pass,
    value_and_gradient,
)


class PotentialLeastSquares:
    """Fit of one side's energy, as a ``LeastSquaresProblem``.

    Args:
        network: Its shapes and input map; its parameters do not matter.
        poses: (n, 6) [m, rad].
        forces: Q (n, 6), generalised forces on the femur [N, Nm].
        weights: v (6,) or (n, 6), errors are multiplied by these [1/N, 1/Nm].
        scale: c [J].
        power: p > 2.
        precision: Of the products in JᵀJ; gradient and errors are always float64.
        chunk_rows: Loaded samples at a time; memory is about 8·chunk_rows·(width + 1)² numbers.
    """

    def __init__(
        self,
        network: PotentialNetwork,
        poses: Tensor,
        forces: Tensor,
        *,
        weights: Tensor,
        scale: float,
        power: float,
        precision: Precision = "float64",
        chunk_rows: int = 256,
    ) -> None:
        self._network = network
        self._inputs = network.input_map(poses)
        self._weights = weights.expand(forces.shape)
        self._targets = forces * self._weights
        self._weights = self._weights / network.input_map.half_range
        self._scale, self._power = scale, power
        self._product_dtype = torch.float32 if precision == "mixed" else torch.float64
        self._chunk_rows = chunk_rows

    @property
    def n_parameters(self) -> int:
        """P."""
        return self._network.n_parameters

    def sum_of_squares(self, parameters: Tensor) -> float:
        """E_D at ``parameters`` (P,)."""
        return self._errors(parameters)[2]

    def normal_equations(self, parameters: Tensor) -> NormalEquations:
        """JᵀJ, Jᵀe and E_D at ``parameters`` (P,)."""
        layers, coefficients = self._network.split(parameters)
        value, errors, total = self._errors(parameters)
        active = torch.nonzero(value > 0)[:, 0]
        blocks: dict[tuple[int, int], list[Tensor]] = {}
        jte = torch.zeros_like(parameters)
        for rows in torch.split(active, self._chunk_rows):
            done = second_order_pass(layers, coefficients, self._inputs[rows])
            parts = self._parts(done, rows)
            jte += torch.cat([part.gradient(errors[rows]).reshape(-1) for part in parts])
            parts = [part.to(self._product_dtype) for part in parts]
            for left in range(len(parts)):
                for right in range(left, len(parts)):
                    _add(blocks, (left, right), parts[left].products(parts[right], left == right))
        shapes = [tuple(layer.shape) for layer in layers] + [(1, len(coefficients))]
        return NormalEquations(
            _assemble(blocks, shapes, len(parameters)),
            jte,
            total,
            6 * int((errors != 0).any(dim=1).sum()),
        )

    def _errors(self, parameters: Tensor) -> tuple[Tensor, Tensor, float]:
        """N (n,), errors (n, 6) and their sum of squares."""
        layers, coefficients = self._network.split(parameters)
        value, gradient = value_and_gradient(layers, coefficients, self._inputs)
        force = self._scale * self._power * value.clamp(min=0) ** (self._power - 1)
        errors = -force[:, None] * gradient * self._weights - self._targets
        return value, errors, float((errors * errors).sum())

    def _parts(self, done: SecondOrderPass, rows: Tensor) -> list[_Part]:
        """Every layer's share of the chunk's Jacobian; the quadratic part's last."""
        weights, p = self._weights[rows], self._power
        curve = -self._scale * p * (p - 1) * done.value ** (p - 2)
        force = -self._scale * p * done.value ** (p - 1)
        by_value = weights * curve[:, None] * done.gradient
        by_gradient = weights * force[:, None]
        parts = []
        for delta, delta_tangent, inputs, tangent in zip(
            done.deltas, done.delta_tangents, done.layer_inputs, done.input_tangents, strict=True
        ):
            own = by_value[:, :, None] * delta[:, None] + by_gradient[:, :, None] * delta_tangent
            # The bias's input does not move.
            moved = torch.nn.functional.pad(by_gradient[:, :, None] * tangent, (0, 1))
            parts.append(_Part(own, inputs, delta, moved))
        one = done.deltas[-1]
        inputs = done.layer_inputs[0][:, :-1]
        moved = by_gradient[:, :, None] * quadratic_tangents(inputs)
        parts.append(_Part(by_value[:, :, None], quadratic_terms(inputs), one, moved))
        return parts


@dataclass(frozen=True)
class _Part:
    """J_k = own_k ⊗ inputs + delta ⊗ moved_k, over n rows and their six errors k.

    Attributes:
        own: A (n, 6, d). inputs: a (n, p). delta: δ (n, d). moved: B (n, 6, p).
    """

    own: Tensor
    inputs: Tensor
    delta: Tensor
    moved: Tensor

    def to(self, dtype: torch.dtype) -> _Part:
        """All in another precision."""
        return _Part(*(t.to(dtype) for t in (self.own, self.inputs, self.delta, self.moved)))

    def gradient(self, errors: Tensor) -> Tensor:
        """Σ e_k J_k (d, p): the errors (n, 6) are summed over k before any outer product."""
        own = (errors[:, None] @ self.own)[:, 0]
        moved = (errors[:, None] @ self.moved)[:, 0]
        return own.T @ self.inputs + self.delta.T @ moved

    def products(self, other: _Part, same: bool) -> list[Tensor]:
        """The four products of a block, see :func:`_assemble`; the third is left out if ``same``."""
        products = [
            _product(_summed(self.own, other.own), _outer(self.inputs, other.inputs)),
            _product(_summed(self.own, other.moved), _outer(self.inputs, other.delta)),
            _product(_summed(self.moved, other.moved), _outer(self.delta, other.delta)),
        ]
        if not same:
            products.append(
                _product(_summed(self.moved, other.own), _outer(self.delta, other.inputs))
            )
        return products


def _summed(left: Tensor, right: Tensor) -> Tensor:
    """Σ_k left_k ⊗ right_k: (n, 6, i), (n, 6, j) → (n, i·j)."""
    return (left.transpose(1, 2) @ right).flatten(1)


def _outer(left: Tensor, right: Tensor) -> Tensor:
    """(n, i), (n, j) → (n, i·j)."""
    return (left[:, :, None] * right[:, None, :]).flatten(1)


def _product(left: Tensor, right: Tensor) -> Tensor:
    return (left.T @ right).to(torch.float64)


def _add(
    blocks: dict[tuple[int, int], list[Tensor]], key: tuple[int, int], products: list[Tensor]
) -> None:
    if key in blocks:
        for total, product in zip(blocks[key], products, strict=True):
            total += product
    else:
        blocks[key] = products


def _assemble(
    blocks: dict[tuple[int, int], list[Tensor]], shapes: list[tuple[int, ...]], size: int
) -> Tensor:
    """JᵀJ (P, P) from the blocks' products."""
    starts = [0]
    for rows, columns in shapes:
        starts.append(starts[-1] + rows * columns)
    jtj = torch.zeros(size, size, dtype=torch.float64)
    for (left, right), products in blocks.items():
        (d, p), (e, q) = shapes[left], shapes[right]
        # To (d, p, e, q) from (d e, p q), (d q, p e), (p q, d e) and (p e, d q).
        cross = products[1].view(d, q, p, e).permute(0, 2, 3, 1)
        block = products[0].view(d, e, p, q).permute(0, 2, 1, 3) + cross
        block = block + products[2].view(p, q, d, e).permute(2, 0, 3, 1)
        if left == right:
            block = block + cross.permute(2, 3, 0, 1)
        else:
            block = block + products[3].view(p, e, d, q).permute(2, 0, 1, 3)
        matrix = block.reshape(d * p, e * q)
        row = slice(starts[left], starts[left + 1])
        column = slice(starts[right], starts[right + 1])
        jtj[row, column] = matrix
        if left != right:
            jtj[column, row] = matrix.T
    return jtj
