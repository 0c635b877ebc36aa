# SPDX-License-Identifier: Apache-2.0
"""Normal equations of a tanh multilayer perceptron, without ever forming its Jacobian.

With a_l = (h_{l-1}, 1) the input of layer l and δ_l^{nj} = ∂y_nj/∂z_l the back-propagated
sensitivity of output j of row n, the Jacobian row of error (n, j) with respect to layer l's weights
Θ_l (d_l × p_l) is δ_l^{nj} ⊗ a_l^n. So a block of JᵀJ, summed over the outputs first, is

    B_lk = Σ_n ( Σ_j δ_l^{nj} δ_k^{nj}ᵀ ) ⊗ ( a_l^n a_k^nᵀ ):

one matrix product (d_l d_k × rows)·(rows × p_l p_k) of per-row outer products, followed by a
permutation. Compared with the explicit Jacobian (rows·outputs × P) this saves the factor "number of
outputs" everywhere, and another four in diagonal blocks, whose two factors are symmetric and kept
packed: for a 3×30 network with four outputs it takes a tenth of the operations. Rows go through in
chunks, so memory does not grow with their number.

Weights: error (n, j) enters as sqrt(v_nj)·(y − t). One-sided errors: where ``one_sided`` is set,
the target is an upper bound, e = max(y − t, 0) (a censored observation, Tobin 1958): inactive
errors have no derivative and do not count in ``n_errors``.

References: Hagan & Menhaj (1994), IEEE Trans Neural Netw 5(6):989-993 (LM back-propagation).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import torch
from torch import Tensor

from condyle.training.least_squares import NormalEquations

#: "float64": every product in float64. "mixed": a chunk's products in float32, summed in float64.
#: Mixed takes a quarter off an epoch, but its rounding looks like information: on a 3 × 30 network
#: γ and α came out 2.3 % too high with chunks of 1024 rows, 1.4 % with 256. Not the default.
Precision = Literal["float64", "mixed"]


@dataclass(frozen=True)
class _Pass:
    """A forward pass over a chunk of n rows, in mapped units.

    Attributes:
        layer_inputs: a_l = (h_{l-1}, 1) of every layer, (n, p_l) each.
        outputs: y (n, m).
    """

    layer_inputs: list[Tensor]
    outputs: Tensor

    def select(self, rows: Tensor) -> _Pass:
        """The same of some rows (n,) bool."""
        return _Pass([inputs[rows] for inputs in self.layer_inputs], self.outputs[rows])


class MlpLeastSquares:
    """Fit of a tanh MLP with linear output, as a ``LeastSquaresProblem``.

    The parameter vector holds the layers in order, each as Θ_l = [W_l | b_l] row by row
    (the layout of :meth:`condyle.training.networks.TanhMlp.get_parameters`).

    Args:
        widths: Layer widths, inputs first and outputs last, e.g. (6, 30, 30, 30, 4).
        inputs: (n, widths[0]) float64, mapped (about [-1, 1]).
        targets: (n, widths[-1]) float64, mapped.
        weights: v ≥ 0, (n, m) or (n, 1), or None for ones. Errors of weight 0 do not count.
        one_sided: (n, m) bool, where the target is only an upper bound, or None for nowhere.
        precision: See :data:`Precision`.
        chunk_rows: Rows of a chunk; memory is about 8·chunk_rows·(width + 1)²·8 bytes.
    """

    def __init__(
        self,
        widths: tuple[int, ...],
        inputs: Tensor,
        targets: Tensor,
        *,
        weights: Tensor | None = None,
        one_sided: Tensor | None = None,
        precision: Precision = "float64",
        chunk_rows: int = 1024,
    ) -> None:
        if inputs.shape[1] != widths[0] or targets.shape != (inputs.shape[0], widths[-1]):
            raise ValueError(
                f"inputs {tuple(inputs.shape)} and targets {tuple(targets.shape)} "
                f"do not fit widths {widths}"
            )
        if chunk_rows < 1:
            raise ValueError(f"chunk_rows is {chunk_rows}; it must be at least 1")
        self.widths = widths
        self._inputs = inputs
        self._targets = targets
        self._root_weights = (
            torch.ones_like(targets)
            if weights is None
            else weights.sqrt().expand_as(targets).contiguous()
        )
        self._one_sided = one_sided
        self._product_dtype = torch.float32 if precision == "mixed" else torch.float64
        self._chunk_rows = chunk_rows
        self._shapes = [(out, into + 1) for into, out in pairwise(widths)]
        self._triangles = {
            size: torch.triu_indices(size, size, device=inputs.device)
            for shape in self._shapes
            for size in shape
        }

    @property
    def n_parameters(self) -> int:
        """P."""
        return sum(rows * columns for rows, columns in self._shapes)

    def sum_of_squares(self, parameters: Tensor) -> float:
        """E_D at ``parameters`` (P,)."""
        layers = self._layers(parameters)
        total = 0.0
        for rows in self._chunks():
            errors, _ = self._errors(rows, self._forward(layers, rows).outputs)
            total += float((errors * errors).sum())
        return total

    def normal_equations(self, parameters: Tensor) -> NormalEquations:
        """JᵀJ, Jᵀe and E_D at ``parameters`` (P,)."""
        layers = self._layers(parameters)
        blocks: dict[tuple[int, int], Tensor] = {}
        gradients = [torch.zeros_like(layer) for layer in layers]
        total, n_errors = 0.0, 0
        for rows in self._chunks():
            forward = self._forward(layers, rows)
            errors, root_weights = self._errors(rows, forward.outputs)
            total += float((errors * errors).sum())
            n_errors += int((root_weights > 0).sum())
            taught = (root_weights > 0).any(dim=1)
            if not taught.all():
                # Rows without an active error (poses out of contact, mostly) cost a forward pass.
                forward, errors, root_weights = (
                    forward.select(taught),
                    errors[taught],
                    root_weights[taught],
                )
            deltas = _back_propagate(layers, forward, root_weights)
            for index, delta in enumerate(deltas):
                # Σ_j e_j δ^j: ordinary back-propagation of the errors, kept in float64 (it sets the
                # step).
                gradients[index] += (errors[:, None, :] @ delta)[:, 0].T @ forward.layer_inputs[
                    index
                ]
            gradients[-1] += (errors * root_weights).T @ forward.layer_inputs[-1]
            self._accumulate(blocks, deltas, root_weights, forward.layer_inputs)
        return NormalEquations(
            jtj=self._assemble(blocks),
            jte=torch.cat([gradient.reshape(-1) for gradient in gradients]),
            sum_of_squares=total,
            n_errors=n_errors,
        )

    def _chunks(self) -> list[slice]:
        n, size = self._inputs.shape[0], self._chunk_rows
        return [slice(start, min(start + size, n)) for start in range(0, n, size)]

    def _layers(self, parameters: Tensor) -> list[Tensor]:
        sizes = [rows * columns for rows, columns in self._shapes]
        parts = torch.split(parameters, sizes)
        return [part.view(shape) for part, shape in zip(parts, self._shapes, strict=True)]

    def _forward(self, layers: list[Tensor], rows: slice) -> _Pass:
        hidden = self._inputs[rows]
        one = hidden.new_ones(hidden.shape[0], 1)
        layer_inputs = []
        for index, layer in enumerate(layers):
            layer_inputs.append(torch.cat([hidden, one], dim=1))
            hidden = layer_inputs[-1] @ layer.T
            if index + 1 < len(layers):
                hidden = torch.tanh(hidden)
        return _Pass(layer_inputs, hidden)

    def _errors(self, rows: slice, outputs: Tensor) -> tuple[Tensor, Tensor]:
        """Weighted errors and root weights (n, m each), both 0 where an error is inactive."""
        errors = outputs - self._targets[rows]
        root_weights = self._root_weights[rows]
        if self._one_sided is not None:
            inactive = self._one_sided[rows] & (errors <= 0)
            root_weights = root_weights.masked_fill(inactive, 0.0)
        return errors * root_weights, root_weights

    def _accumulate(
        self,
        blocks: dict[tuple[int, int], Tensor],
        deltas: list[Tensor],
        root_weights: Tensor,
        layer_inputs: list[Tensor],
    ) -> None:
        """Adds a chunk's products to ``blocks``; those of diagonal blocks are packed."""
        dtype = self._product_dtype
        deltas = [delta.to(dtype) for delta in deltas]
        root_weights = root_weights.to(dtype)
        inputs = [layer_input.to(dtype) for layer_input in layer_inputs]
        last = len(inputs) - 1
        for left in range(len(inputs)):
            i, j = self._triangles[inputs[left].shape[1]]
            packed = inputs[left][:, i] * inputs[left][:, j]
            if left == last:
                # The output layer's sensitivities are unit vectors: only D_jj = v_nj is left.
                _add(blocks, (left, left), (root_weights * root_weights).T @ packed)
                continue
            i, j = self._triangles[deltas[left].shape[2]]
            outer = (deltas[left].transpose(1, 2) @ deltas[left])[:, i, j]
            _add(blocks, (left, left), outer.T @ packed)
            for right in range(left + 1, len(inputs)):
                if right == last:
                    outer = deltas[left].transpose(1, 2) * root_weights[:, None, :]
                else:
                    outer = deltas[left].transpose(1, 2) @ deltas[right]
                product = inputs[left][:, :, None] * inputs[right][:, None, :]
                _add(blocks, (left, right), outer.flatten(1).T @ product.flatten(1))

    def _assemble(self, blocks: dict[tuple[int, int], Tensor]) -> Tensor:
        """JᵀJ (P, P) from the blocks: unpacked, (a, b, c, d) permuted to (a, c, b, d)."""
        sizes = [rows * columns for rows, columns in self._shapes]
        starts = [sum(sizes[:index]) for index in range(len(sizes) + 1)]
        jtj = self._inputs.new_zeros(starts[-1], starts[-1])
        last = len(sizes) - 1
        for (left, right), block in blocks.items():
            (d_left, p_left), (d_right, p_right) = self._shapes[left], self._shapes[right]
            if left == right:
                full = block[:, _packed_index(p_left, block.device)]
                if left == last:
                    full = torch.diag_embed(full.permute(1, 2, 0)).permute(2, 3, 0, 1)
                else:
                    full = full[_packed_index(d_left, block.device)]
            else:
                full = block.view(d_left, d_right, p_left, p_right)
            matrix = full.permute(0, 2, 1, 3).reshape(sizes[left], sizes[right])
            row, column = (
                slice(starts[left], starts[left + 1]),
                slice(starts[right], starts[right + 1]),
            )
            jtj[row, column] = matrix
            if left != right:
                jtj[column, row] = matrix.T
        return jtj


def _back_propagate(layers: list[Tensor], forward: _Pass, root_weights: Tensor) -> list[Tensor]:
    """Sensitivities sqrt(v)·∂y_nj/∂z_l (n, m, d_l) of the hidden layers, first layer first."""
    n_hidden = len(layers) - 1
    deltas: list[Tensor] = []
    sensitivity = root_weights[:, :, None]
    for index in range(n_hidden, 0, -1):
        weights = layers[index][:, :-1]
        hidden = forward.layer_inputs[index][:, None, :-1]
        if index == n_hidden:
            sensitivity = sensitivity * weights * (1.0 - hidden * hidden)
        else:
            sensitivity = (sensitivity @ weights) * (1.0 - hidden * hidden)
        deltas.insert(0, sensitivity)
    return deltas


def _add(blocks: dict[tuple[int, int], Tensor], key: tuple[int, int], product: Tensor) -> None:
    """Sums chunk products in float64 whatever the precision of the products."""
    if key in blocks:
        blocks[key] += product
    else:
        blocks[key] = product.to(torch.float64)


def _packed_index(size: int, device: torch.device) -> Tensor:
    """(size, size) table of where element (i, j) sits in the packed upper triangle."""
    i, j = torch.triu_indices(size, size, device=device)
    table = torch.zeros(size, size, dtype=torch.long, device=device)
    positions = torch.arange(i.numel(), device=device)
    table[i, j] = positions
    table[j, i] = positions
    return table
