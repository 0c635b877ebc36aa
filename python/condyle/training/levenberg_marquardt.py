# SPDX-License-Identifier: Apache-2.0
"""Levenberg-Marquardt with Bayesian regularisation (MacKay 1992; Foresee & Hagan 1997).

Minimises, over the parameters w of a :class:`~condyle.training.least_squares.LeastSquaresProblem`,

    F(w) = β·E_D + α·E_W,    E_D = Σ e_i²,    E_W = Σ w_k²

and re-estimates α and β as it goes by maximising the evidence of a Gaussian likelihood (variance of
an error 1/(2β)) and a Gaussian prior (variance of a parameter 1/(2α)):

    H = 2β JᵀJ + 2α I                      Gauss-Newton Hessian of F
    γ = P − 2α·tr(H⁻¹)                     effective number of parameters, 0 ≤ γ ≤ P
    α = γ / (2 E_W),   β = (N − γ) / (2 E_D)

An epoch: normal equations at w; γ, α, β from them (in the first epoch γ = P, as nothing is known
yet); then steps −(β JᵀJ + (α + μ) I)⁻¹ (β Jᵀe + α w) with μ raised until F falls.

MATLAB's ``trainbr`` is the model: the same μ schedule and stopping rules, by the same names. One
departure: γ is evaluated with the Jacobian at the accepted parameters, which the next step needs
anyway, where ``trainbr`` uses the one before the step; the fixed points are the same.

Pitfalls. Errors and inputs should be scaled to about [-1, 1], since one α serves all parameters.
With data free of noise β keeps growing and γ nears P: the regularisation then fades, as it should.

References:
    MacKay (1992), Neural Computation 4(3):415-447, doi:10.1162/neco.1992.4.3.415.
    Foresee & Hagan (1997), Proc. ICNN 3:1930-1935, doi:10.1109/ICNN.1997.614194.
    Hagan & Menhaj (1994), IEEE Trans. Neural Networks 5(6):989-993, doi:10.1109/72.329697.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

import torch
from torch import Tensor

from condyle.training.least_squares import LeastSquaresProblem, NormalEquations


class StopReason(StrEnum):
    """Why a training ended (``trainbr``'s names), and what it means for the user."""

    EPOCHS = "epochs"
    GOAL = "goal"
    MIN_GRAD = "min_grad"
    MU_MAX = "mu_max"
    TIME = "time"
    PATIENCE = "patience"

    @property
    def advice(self) -> str:
        """One sentence on what to do next."""
        return {
            StopReason.EPOCHS: "all epochs are done; allow more if the loss still falls",
            StopReason.GOAL: "the mean squared error fell below the goal",
            StopReason.MIN_GRAD: "converged: the gradient vanished",
            StopReason.MU_MAX: "converged: no step lowers the objective any more",
            StopReason.TIME: "the time budget is spent; allow more if the loss still falls",
            StopReason.PATIENCE: "converged: the loss has all but stopped falling",
        }[self]


@dataclass(frozen=True)
class LevenbergMarquardtSettings:
    """Settings; the defaults are ``trainbr``'s except for patience, which it does not have.

    Attributes:
        max_epochs: Stop "epochs".
        goal: Stop "goal" when the mean squared error E_D/N is at or below this.
        min_grad: Stop "min_grad" when 2·|Jᵀe + (α/β) w|/N, the gradient of F/(βN), is below this.
        mu: First μ.
        mu_dec: Factor on μ after a step that lowered F.
        mu_inc: Factor on μ after one that did not.
        mu_max: Stop "mu_max" when μ exceeds this.
        time_s: Stop "time" before the first epoch that would begin later than this [s].
        patience: Stop "patience" when over this many epochs E_D/N has fallen by less than
            ``min_relative_improvement`` of itself; 0 switches the rule off.
        min_relative_improvement: See ``patience``.
        bayesian: Re-estimate α and β; otherwise they stay at ``alpha`` and ``beta``.
        alpha: First α when not re-estimated.
        beta: First β when not re-estimated.
    """

    max_epochs: int = 1000
    goal: float = 0.0
    min_grad: float = 1e-7
    mu: float = 0.005
    mu_dec: float = 0.1
    mu_inc: float = 10.0
    mu_max: float = 1e10
    time_s: float = math.inf
    patience: int = 0
    min_relative_improvement: float = 1e-3
    bayesian: bool = True
    alpha: float = 0.0
    beta: float = 1.0


@dataclass
class LevenbergMarquardtState:
    """All that the next epoch depends on; restoring it resumes a run bit for bit.

    Attributes:
        parameters: w (P,) float64.
        epoch: Epochs done.
        mu: Damping for the next step.
        alpha: α. beta: β. gamma: γ.
        elapsed_s: Time spent so far over all runs [s]; only the stop "time" looks at it.
        stop_reason: Set once the run has ended.
        history: Per epoch, before its step: loss (E_D/N), gamma, alpha, beta; and mu after it.
    """

    parameters: Tensor
    epoch: int = 0
    mu: float = 0.005
    alpha: float = 0.0
    beta: float = 1.0
    gamma: float = 0.0
    elapsed_s: float = 0.0
    stop_reason: StopReason | None = None
    history: dict[str, list[float]] = field(
        default_factory=lambda: {key: [] for key in ("loss", "gamma", "alpha", "beta", "mu")}
    )

    def to_dict(self) -> dict[str, Any]:
        """Plain values and one tensor, for a checkpoint."""
        values = asdict(self)
        values["parameters"] = self.parameters.clone()
        values["stop_reason"] = None if self.stop_reason is None else self.stop_reason.value
        return values

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> LevenbergMarquardtState:
        """Inverse of :meth:`to_dict`."""
        reason = values["stop_reason"]
        return cls(**{**values, "stop_reason": None if reason is None else StopReason(reason)})


class LevenbergMarquardt:
    """The optimiser. ``run`` to the end, or call ``step`` epoch by epoch.

    Args:
        problem: The errors to be minimised.
        parameters: First w (P,) float64; not modified.
        settings: See :class:`LevenbergMarquardtSettings`.
        state: A state to resume from instead of ``parameters``.
    """

    def __init__(
        self,
        problem: LeastSquaresProblem,
        parameters: Tensor | None = None,
        settings: LevenbergMarquardtSettings | None = None,
        *,
        state: LevenbergMarquardtState | None = None,
    ) -> None:
        self.problem = problem
        self.settings = settings or LevenbergMarquardtSettings()
        if state is None:
            if parameters is None:
                raise ValueError("either parameters or a state to resume from must be given")
            state = LevenbergMarquardtState(
                parameters.detach().to(torch.float64).clone(),
                mu=self.settings.mu,
                alpha=self.settings.alpha,
                beta=self.settings.beta,
            )
        if state.parameters.shape != (problem.n_parameters,):
            raise ValueError(
                f"parameters have shape {tuple(state.parameters.shape)}; "
                f"the problem has {problem.n_parameters}"
            )
        self.state = state

    def run(
        self, callback: Callable[[LevenbergMarquardtState], None] | None = None
    ) -> LevenbergMarquardtState:
        """Steps until a stopping rule holds; ``callback`` sees the state after every epoch."""
        while self.state.stop_reason is None:
            started = time.monotonic()
            self.step()
            self.state.elapsed_s += time.monotonic() - started
            if callback is not None:
                callback(self.state)
        return self.state

    def step(self) -> None:
        """One epoch; sets ``state.stop_reason`` instead when a stopping rule holds."""
        state, settings = self.state, self.settings
        equations = self.problem.normal_equations(state.parameters)
        if settings.bayesian:
            self._re_estimate(equations)
        loss = equations.sum_of_squares / max(equations.n_errors, 1)
        for key, value in zip(
            ("loss", "gamma", "alpha", "beta"),
            (loss, state.gamma, state.alpha, state.beta),
            strict=True,
        ):
            state.history[key].append(value)
        gradient = state.beta * equations.jte + state.alpha * state.parameters
        scale = 2.0 / (state.beta * max(equations.n_errors, 1))
        if loss <= settings.goal:
            state.stop_reason = StopReason.GOAL
        elif scale * float(gradient.norm()) < settings.min_grad:
            state.stop_reason = StopReason.MIN_GRAD
        elif self._stalled():
            state.stop_reason = StopReason.PATIENCE
        elif state.epoch >= settings.max_epochs:
            state.stop_reason = StopReason.EPOCHS
        elif state.elapsed_s >= settings.time_s:
            state.stop_reason = StopReason.TIME
        elif not self._descend(equations, gradient):
            state.stop_reason = StopReason.MU_MAX
        else:
            state.epoch += 1
        state.history["mu"].append(state.mu)

    def _re_estimate(self, equations: NormalEquations) -> None:
        """γ, α and β from the normal equations at the current parameters."""
        state = self.state
        if state.epoch == 0:
            state.gamma = float(self.problem.n_parameters)
        else:
            state.gamma = effective_parameters(equations.jtj, state.alpha, state.beta)
        sum_of_parameters = float(state.parameters @ state.parameters)
        # trainbr's guards: 1 where a ratio is not defined (no weights, no errors, fewer errors than
        # parameters).
        state.alpha = state.gamma / (2.0 * sum_of_parameters) if sum_of_parameters > 0 else 1.0
        freedom = equations.n_errors - state.gamma
        beta = freedom / (2.0 * equations.sum_of_squares) if equations.sum_of_squares > 0 else 1.0
        state.beta = beta if beta > 0 else 1.0

    def _stalled(self) -> bool:
        patience, losses = self.settings.patience, self.state.history["loss"]
        if patience <= 0 or len(losses) <= patience:
            return False
        before = losses[-1 - patience]
        return before - losses[-1] < self.settings.min_relative_improvement * before

    def _descend(self, equations: NormalEquations, gradient: Tensor) -> bool:
        """Raises μ until a step lowers F and takes it; False when μ exceeds its limit."""
        state, settings = self.state, self.settings
        objective = self._objective(equations.sum_of_squares, state.parameters)
        while state.mu <= settings.mu_max:
            matrix = _damped(equations.jtj, state.beta, state.alpha + state.mu)
            factor, failed = torch.linalg.cholesky_ex(matrix)
            if int(failed) == 0:
                step = torch.cholesky_solve(gradient[:, None], factor)[:, 0]
                trial = state.parameters - step
                if self._objective(self.problem.sum_of_squares(trial), trial) < objective:
                    state.parameters = trial
                    state.mu = max(state.mu * settings.mu_dec, 1e-20)
                    return True
            state.mu *= settings.mu_inc
        return False

    def _objective(self, sum_of_squares: float, parameters: Tensor) -> float:
        value = self.state.beta * sum_of_squares + self.state.alpha * float(parameters @ parameters)
        # An overflowing trial must count as worse, and NaN compares as neither.
        return value if math.isfinite(value) else math.inf


def effective_parameters(jtj: Tensor, alpha: float, beta: float) -> float:
    """γ = P − 2α·tr((2β JᵀJ + 2α I)⁻¹), the number of parameters that the data determine.

    Args:
        jtj: JᵀJ (P, P) float64.
        alpha: α > 0.
        beta: β > 0.
    """
    n_parameters = jtj.shape[0]
    factor, failed = torch.linalg.cholesky_ex(_damped(jtj, beta, alpha))
    if int(failed) == 0:
        trace = float(torch.cholesky_inverse(factor).diagonal().sum())
    else:
        # Rounding of JᵀJ made it indefinite by more than α/β: such directions hold no data.
        eigenvalues = torch.linalg.eigvalsh(jtj).clamp(min=0.0)
        trace = float((1.0 / (beta * eigenvalues + alpha)).sum())
    return float(min(max(n_parameters - alpha * trace, 0.0), n_parameters))


def _damped(jtj: Tensor, beta: float, shift: float) -> Tensor:
    matrix = beta * jtj
    matrix.diagonal().add_(shift)
    return matrix
