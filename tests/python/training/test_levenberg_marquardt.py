# SPDX-License-Identifier: Apache-2.0
"""The optimiser on problems whose answers are known: evidence, noise, Rosenbrock."""

import math

import numpy as np
import pytest
import torch
from torch import Tensor

from condyle.training import (
    AutogradLeastSquares,
    LevenbergMarquardt,
    LevenbergMarquardtSettings,
    LevenbergMarquardtState,
    MinMaxMap,
    MlpLeastSquares,
    StopReason,
    TanhMlp,
)

TO_THE_END = LevenbergMarquardtSettings(max_epochs=500, min_grad=1e-12)


def _linear_problem(n_rows: int = 60, n_columns: int = 7):
    """y = A w + noise with columns of very different size, so that γ lies well between 0 and P."""
    generator = np.random.default_rng(5)
    matrix = generator.normal(size=(n_rows, n_columns)) * np.logspace(0.3, -2.2, n_columns)
    truth = generator.normal(size=n_columns) * 1.3
    values = matrix @ truth + 0.21 * generator.normal(size=n_rows)
    a, y = torch.from_numpy(matrix), torch.from_numpy(values)
    return AutogradLeastSquares(lambda w: a @ w - y, n_columns), matrix, values


def _log_evidence(matrix, values, alpha: float, beta: float) -> float:
    """ln p(y | α, β): y is normal with covariance I/(2β) + A Aᵀ/(2α)."""
    covariance = np.eye(len(values)) / (2 * beta) + matrix @ matrix.T / (2 * alpha)
    _, log_determinant = np.linalg.slogdet(2 * math.pi * covariance)
    return float(-0.5 * (log_determinant + values @ np.linalg.solve(covariance, values)))


def test_linear_model_ends_at_the_maximum_of_its_evidence():
    problem, matrix, values = _linear_problem()
    start = torch.full((7,), 0.3, dtype=torch.float64)
    state = LevenbergMarquardt(problem, start, TO_THE_END).run()
    alpha, beta = state.alpha, state.beta
    best = _log_evidence(matrix, values, alpha, beta)
    assert 1.0 < state.gamma < 6.5
    # The gradient in (ln α, ln β) vanishes. It is of order N/2 = 30 away from the maximum; central
    # differences with h = 1e-4 are good to 30·h² + eps·|ln p|/h, about 1e-6.
    for step_alpha, step_beta in ((1e-4, 0.0), (0.0, 1e-4)):
        ahead = _log_evidence(
            matrix, values, alpha * math.exp(step_alpha), beta * math.exp(step_beta)
        )
        behind = _log_evidence(
            matrix, values, alpha * math.exp(-step_alpha), beta * math.exp(-step_beta)
        )
        assert abs(ahead - behind) / 2e-4 < 1e-4
        assert ahead < best + 1e-9 and behind < best + 1e-9


def test_linear_model_parameters_are_the_posterior_mean_and_gamma_its_trace():
    problem, matrix, values = _linear_problem()
    state = LevenbergMarquardt(problem, torch.zeros(7, dtype=torch.float64), TO_THE_END).run()
    ratio = state.alpha / state.beta
    gram = matrix.T @ matrix
    mean = np.linalg.solve(gram + ratio * np.eye(7), matrix.T @ values)
    np.testing.assert_allclose(state.parameters.numpy(), mean, rtol=1e-7, atol=1e-9)
    eigenvalues = np.linalg.eigvalsh(gram)
    assert state.gamma == pytest.approx(
        float((eigenvalues / (eigenvalues + ratio)).sum()), rel=1e-6
    )


def test_a_parameter_without_effect_goes_to_zero_and_does_not_count():
    x = torch.linspace(-1, 1, 40, dtype=torch.float64)
    y = 1.7 * x - 0.4 + 0.05 * torch.sin(37 * x)
    problem = AutogradLeastSquares(lambda w: w[0] * x + w[1] + 0.0 * w[2] - y, 3)
    start = torch.tensor([0.1, 0.1, 5.0], dtype=torch.float64)
    state = LevenbergMarquardt(problem, start, TO_THE_END).run()
    assert abs(float(state.parameters[2])) < 1e-6
    assert 1.9 < state.gamma <= 2.0 + 1e-9


def _curve(n_rows: int, noise: float, seed: int) -> tuple[Tensor, Tensor]:
    generator = torch.Generator().manual_seed(seed)
    x = 2 * torch.rand(n_rows, 1, dtype=torch.float64, generator=generator) - 1
    clean = torch.sin(math.pi * x) * 0.8
    return x, clean + noise * torch.randn(n_rows, 1, dtype=torch.float64, generator=generator)


def _fit_curve(n_rows: int, neurons: int, noise: float) -> tuple[TanhMlp, LevenbergMarquardtState]:
    x, y = _curve(n_rows, noise, 7)
    unit = MinMaxMap(torch.zeros(1), torch.ones(1))
    net = TanhMlp(unit, unit, (neurons,))
    net.initialise(4)
    settings = LevenbergMarquardtSettings(max_epochs=300)
    state = LevenbergMarquardt(
        MlpLeastSquares(net.widths, x, y), net.get_parameters(), settings
    ).run()
    net.set_parameters(state.parameters)
    return net, state


def test_beta_recovers_the_variance_of_the_noise():
    noise, n_rows = 0.13, 600
    _, state = _fit_curve(n_rows, 12, noise)
    # 1/(2β) estimates σ² with relative standard deviation sqrt(2/(N − γ)) = 5.8 %; three of them.
    assert 1 / (2 * state.beta) == pytest.approx(noise**2, rel=3 * math.sqrt(2 / (n_rows - 20)))
    assert state.gamma < 20 < 37 == state.parameters.numel()


def test_regularisation_prevents_overfitting_of_a_large_network():
    # As the example of Foresee & Hagan (1997): a 1-20-1 network on a noisy sine, with as many
    # weights as points. Left to itself it goes through all of them and is off by the noise between
    # them.
    noise, n_rows = 0.2, 61
    net, state = _fit_curve(n_rows, 20, noise)
    assert state.parameters.numel() == n_rows
    x = torch.linspace(-0.95, 0.95, 200, dtype=torch.float64)[:, None]
    with torch.no_grad():
        error = float((net(x) - 0.8 * torch.sin(math.pi * x)).pow(2).mean().sqrt())
    assert 4 < state.gamma < 12
    # γ weights fitted to N points leave an error of about σ·sqrt(γ/N) = 0.34 σ; allow half as much
    # again.
    assert error < 1.5 * noise * math.sqrt(state.gamma / n_rows)


def test_without_regularisation_it_is_levenberg_marquardt():
    def rosenbrock(w: Tensor) -> Tensor:
        return torch.stack([10 * (w[1] - w[0] ** 2), 1 - w[0]])

    settings = LevenbergMarquardtSettings(bayesian=False, max_epochs=200, min_grad=1e-12)
    start = torch.tensor([-1.2, 1.0], dtype=torch.float64)
    state = LevenbergMarquardt(AutogradLeastSquares(rosenbrock, 2), start, settings).run()
    assert state.stop_reason in (StopReason.MIN_GRAD, StopReason.MU_MAX)
    assert torch.allclose(state.parameters, torch.ones(2, dtype=torch.float64), atol=1e-9)
    assert (state.alpha, state.beta) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"max_epochs": 2}, StopReason.EPOCHS),
        ({"goal": 10.0}, StopReason.GOAL),
        ({"min_grad": 1e3}, StopReason.MIN_GRAD),
        ({"min_grad": 0.0, "mu_max": 1e3}, StopReason.MU_MAX),
        ({"time_s": 1e-9}, StopReason.TIME),
        ({"patience": 3, "min_relative_improvement": 0.5}, StopReason.PATIENCE),
    ],
)
def test_every_stopping_rule_stops_by_its_name(options, reason):
    problem, _, _ = _linear_problem()
    settings = LevenbergMarquardtSettings(**options)
    state = LevenbergMarquardt(problem, torch.ones(7, dtype=torch.float64), settings).run()
    assert state.stop_reason is reason
    assert reason.advice
    # The record ends with the loss of the parameters that are returned.
    loss = problem.sum_of_squares(state.parameters) / 60
    assert state.history["loss"][-1] == pytest.approx(loss, rel=1e-12)


def test_a_run_resumed_from_its_state_is_identical():
    x, y = _curve(80, 0.05, 9)
    unit = MinMaxMap(torch.zeros(1), torch.ones(1))
    net = TanhMlp(unit, unit, (6,))
    net.initialise(2)
    problem = MlpLeastSquares(net.widths, x, y)
    settings = LevenbergMarquardtSettings(max_epochs=25)
    whole = LevenbergMarquardt(problem, net.get_parameters(), settings).run()
    broken = LevenbergMarquardt(problem, net.get_parameters(), settings)
    for _ in range(9):
        broken.step()
    saved = LevenbergMarquardtState.from_dict(broken.state.to_dict())
    resumed = LevenbergMarquardt(problem, settings=settings, state=saved).run()
    assert torch.equal(whole.parameters, resumed.parameters)
    assert whole.history == resumed.history


def test_wrong_arguments_are_refused():
    problem, _, _ = _linear_problem()
    with pytest.raises(ValueError, match=r"parameters have shape \(3,\); the problem has 7"):
        LevenbergMarquardt(problem, torch.zeros(3))
    with pytest.raises(ValueError, match="either parameters or a state"):
        LevenbergMarquardt(problem)
