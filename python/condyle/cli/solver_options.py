# SPDX-License-Identifier: Apache-2.0
"""The options by which a command is told how a trial is solved; what is not given stays at the core's default."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Final, Literal

import typer

if TYPE_CHECKING:
    from condyle.fdk import TrialSimulationSettings

_PANEL: Final = "Solver"

ForceTolerance = Annotated[
    float | None,
    typer.Option(
        metavar="N",
        help="Largest net force left on a translation. [default: 0.01]",
        rich_help_panel=_PANEL,
    ),
]
MomentTolerance = Annotated[
    float | None,
    typer.Option(
        metavar="NM",
        help="Largest net moment left on a rotation. [default: 0.0005]",
        rich_help_panel=_PANEL,
    ),
]
MaxIterations = Annotated[
    int | None,
    typer.Option(help="Newton steps of an attempt at most. [default: 60]", rich_help_panel=_PANEL),
]
MaxNewtonStepMm = Annotated[
    float | None,
    typer.Option(
        metavar="MM", help="Bound on a translation's step. [default: 2]", rich_help_panel=_PANEL
    ),
]
MaxNewtonStepDeg = Annotated[
    float | None,
    typer.Option(
        metavar="DEG", help="Bound on a rotation's step. [default: 2.86]", rich_help_panel=_PANEL
    ),
]
LocalSearch = Annotated[
    int | None,
    typer.Option(
        help="Halvings of a step that does not improve, at most. [default: 6]",
        rich_help_panel=_PANEL,
    ),
]
JacobianName = Annotated[
    Literal["analytic", "finite_differences"],
    typer.Option(help="Of the Newton steps.", rich_help_panel=_PANEL),
]
Perturbation = Annotated[
    float | None,
    typer.Option(
        metavar="M|RAD",
        help="Step of the finite differences. [default: 1e-6]",
        rich_help_panel=_PANEL,
    ),
]
MaxSubsteps = Annotated[
    int | None,
    typer.Option(
        help="Parts that the way from the last time frame may be cut into. [default: 16]",
        rich_help_panel=_PANEL,
    ),
]
Chunk = Annotated[
    int,
    typer.Option(
        min=0,
        help="Time frames solved one after another; chunks are spread over threads. 0: all in one.",
        rich_help_panel=_PANEL,
    ),
]


def solver_settings(
    *,
    force_tolerance: float | None,
    moment_tolerance: float | None,
    max_iterations: int | None,
    max_newton_step_mm: float | None,
    max_newton_step_deg: float | None,
    local_search: int | None,
    jacobian: Literal["analytic", "finite_differences"],
    perturbation: float | None,
    max_substeps: int | None,
    chunk: int,
    threads: int,
) -> TrialSimulationSettings:
    """The settings of the options; their limits are the core's."""
    from condyle.fdk import JacobianMethod, TrialSimulationSettings

    settings = TrialSimulationSettings()
    newton = settings.solver.newton
    given = {
        "force_tolerance": force_tolerance,
        "moment_tolerance": moment_tolerance,
        "max_iterations": max_iterations,
        "max_newton_step_m": None if max_newton_step_mm is None else 1e-3 * max_newton_step_mm,
        "max_newton_step_rad": None
        if max_newton_step_deg is None
        else math.radians(max_newton_step_deg),
        "max_line_search": local_search,
        "perturbation": perturbation,
    }
    for name, value in given.items():
        if value is not None:
            setattr(newton, name, value)
    newton.jacobian = getattr(JacobianMethod, jacobian)
    if max_substeps is not None:
        settings.solver.max_substeps = max_substeps
    settings.chunk, settings.threads = chunk, threads
    return settings
