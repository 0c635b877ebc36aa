# SPDX-License-Identifier: Apache-2.0
"""The options by which a command is told a trial, and how muscles share its loads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from condyle.errors import InputDataError

if TYPE_CHECKING:
    from condyle.model import MuscleSettings, MusculoskeletalModel, Trial

Loads = Annotated[
    Path | None, typer.Option(help="OpenSim's external loads, .xml; its table is found beside it.")
]
Paths = Annotated[
    Path | None, typer.Option(help="Path snapshots of the motion, of `condyle opensim paths`.")
]
Start = Annotated[float | None, typer.Option("--from", help="First time, s.")]
End = Annotated[float | None, typer.Option("--to", help="Last time, s.")]
Criterion = Annotated[
    str, typer.Option(metavar="P|min_max", help="min Σ(f/N)^P, or the least largest activity.")
]
Strength = Annotated[
    Literal["hill", "constant"],
    typer.Option(help="N by length and velocity of the fibres, or the maximum isometric force."),
]
Reserve = Annotated[
    float,
    typer.Option(
        metavar="NM", min=0.0, help="Reserve on every rotation that muscles balance; 0: none."
    ),
]
NegligibleForce = Annotated[
    float,
    typer.Option(metavar="N", min=0.0, help="Loads up to this need no point of application."),
]
AnyRange = Annotated[
    bool,
    typer.Option("--any-range", help="Take coordinates far beyond their range as they are."),
]
Meshes = Annotated[
    list[str] | None,
    typer.Option(
        metavar="FOLDER|NAME=FILE|FILE.json",
        help="Meshes of contact surfaces that are not beside the model; give several "
        "(docs/musculoskeletal.md).",
    ),
]


def muscle_settings(
    criterion: str, strength: Literal["hill", "constant"], reserve: float
) -> MuscleSettings:
    """How muscles share load.

    Raises:
        InputDataError: a criterion that is none.
    """
    from condyle.model import MuscleSettings

    if criterion == "min_max":
        return MuscleSettings(criterion="min_max", strength=strength, reserve_moment=reserve)
    try:
        power = float(criterion)
    except ValueError as error:
        raise InputDataError(
            f"--criterion {criterion}: must be a power, at least 1, or min_max"
        ) from error
    return MuscleSettings(criterion=power, strength=strength, reserve_moment=reserve)


def trial_of(
    model: MusculoskeletalModel,
    motion: Path,
    loads: Path | None,
    paths: Path | None,
    start: float | None,
    end: float | None,
    negligible_force: float,
    any_range: bool,
) -> Trial:
    """The trial of the options; raises as :func:`condyle.model.read_trial`."""
    from condyle.model import read_trial

    return read_trial(
        model,
        motion,
        external_loads=loads,
        snapshots=paths,
        start=start,
        end=end,
        negligible_force=negligible_force,
        range_factor=float("inf") if any_range else 3.0,
    )


def trial_inputs(
    model: Path, motion: Path, loads: Path | None, paths: Path | None
) -> dict[str, Path | None]:
    """The files that results come from, by what they are."""
    from condyle.model.external_loads_table import external_loads_table

    return {
        "model": model,
        "motion": motion,
        "external_loads": loads,
        "external_loads_table": external_loads_table(loads),
        "paths": paths,
    }
