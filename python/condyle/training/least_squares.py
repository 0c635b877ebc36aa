# SPDX-License-Identifier: Apache-2.0
"""What a Gauss-Newton optimiser needs of a problem: sum of squares and normal equations.

    E_D(w) = Σ_i e_i(w)²,   normal equations: JᵀJ (P, P) and Jᵀe (P,), J = ∂e/∂w.

:class:`LeastSquaresProblem` is that interface, :class:`AutogradLeastSquares` an implementation for
any differentiable residual (small problems, tests), and
:class:`~condyle.training.mlp_least_squares.MlpLeastSquares` the fast one for tanh networks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import torch
from torch import Tensor


@dataclass(frozen=True)
class NormalEquations:
    """The normal equations of a least-squares problem at one parameter vector, all float64.

    Attributes:
        jtj: JᵀJ (P, P), symmetric, both triangles filled.
        jte: Jᵀe (P,).
        sum_of_squares: E_D = eᵀe.
        n_errors: How many errors took part (it may change with w where errors can be inactive).
    """

    jtj: Tensor
    jte: Tensor
    sum_of_squares: float
    n_errors: int


class LeastSquaresProblem(Protocol):
    """Errors e(w) of P parameters. Evaluation is a pure function of ``parameters``."""

    @property
    def n_parameters(self) -> int:
        """P."""
        ...

    def sum_of_squares(self, parameters: Tensor) -> float:
        """E_D at ``parameters`` (P,) float64."""
        ...

    def normal_equations(self, parameters: Tensor) -> NormalEquations:
        """JᵀJ, Jᵀe and E_D at ``parameters`` (P,) float64."""
        ...


class AutogradLeastSquares:
    """A least-squares problem from any differentiable residual function, by autograd.

    The Jacobian (N, P) is formed whole: meant for problems that fit in memory. No derivation is
    asked of the user, which also makes it the oracle that faster implementations are tested
    against.

    Args:
        residuals: Maps parameters (P,) float64 to errors (N,) float64 with torch operations.
        n_parameters: P.
    """

    def __init__(self, residuals: Callable[[Tensor], Tensor], n_parameters: int) -> None:
        self._residuals = residuals
        self._n_parameters = n_parameters

    @property
    def n_parameters(self) -> int:
        """P."""
        return self._n_parameters

    def sum_of_squares(self, parameters: Tensor) -> float:
        """E_D at ``parameters`` (P,)."""
        with torch.no_grad():
            errors = self._residuals(parameters)
        return float(errors @ errors)

    def normal_equations(self, parameters: Tensor) -> NormalEquations:
        """JᵀJ, Jᵀe and E_D at ``parameters`` (P,)."""
        jacobian = torch.func.jacrev(self._residuals)(parameters).detach()
        with torch.no_grad():
            errors = self._residuals(parameters)
        return NormalEquations(
            jtj=jacobian.T @ jacobian,
            jte=jacobian.T @ errors,
            sum_of_squares=float(errors @ errors),
            n_errors=errors.numel(),
        )
