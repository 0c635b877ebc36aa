# SPDX-License-Identifier: Apache-2.0
"""``condyle opensim``: models, marker kinematics and path snapshots out of OpenSim (docs/opensim.md)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from condyle.cli.console import console, print_table, progress_bar
from condyle.errors import InputDataError

if TYPE_CHECKING:
    from condyle.opensim import InverseKinematicsResult

app = typer.Typer(
    help="From OpenSim: models, marker kinematics, path snapshots (docs/opensim.md).",
    no_args_is_help=True,
)

Model = Annotated[Path, typer.Argument(help="OpenSim model, .osim; OpenSim-JAM's contact too.")]
#: Names of a group of findings that the screen shows; the model file has them all.
_SHOWN = 8


@app.command(name="import")
def import_command(
    model: Model,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Model file; default: MODEL.json here.")
    ] = None,
    force_dependent: Annotated[
        list[str] | None,
        typer.Option(help="Coordinate to be solved for, or a pattern (knee_t?_r); give several."),
    ] = None,
    muscles: Annotated[
        list[str] | None,
        typer.Option(
            help="Coordinate that muscles balance, or a pattern; give several, or 'none'. "
            "Default: the turning ones that muscles cross."
        ),
    ] = None,
) -> None:
    """Writes an OpenSim model as a model file, and says what does not fit into one."""
    from condyle.opensim import import_model, summary, write_model

    balanced = [] if muscles == ["none"] else muscles
    content = import_model(model, force_dependent=force_dependent or (), muscles=balanced)
    target = output or Path(model.with_suffix(".json").name)
    write_model(target, content)
    console.print(f"{target}: {summary(content)}", highlight=False, markup=False, soft_wrap=True)
    for title, key, value in (
        ("force-dependent", "role", "force_dependent"),
        ("balanced by muscles", "balanced_by", "muscles"),
    ):
        names = [c["name"] for c in content["coordinates"] if c[key] == value]
        _say(f"{title}: {', '.join(names) or 'none'}")
    if content["not_supported"]:
        _say("left out or changed (not_supported in the file has every name):")
    for sentence in content["not_supported"]:
        _say(f"  - {_clipped(sentence)}")


@app.command()
def ik(
    model: Model,
    markers: Annotated[Path, typer.Argument(help="Markers, .trc or .c3d.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Coordinates, .sto: rad, m, s.")
    ] = Path("coordinates.sto"),
    weight: Annotated[
        list[str] | None,
        typer.Option(help="NAME=WEIGHT of a marker, or of a pattern; give several. Default: 1."),
    ] = None,
    weights: Annotated[
        Path | None,
        typer.Option(help="OpenSim's ik_setup.xml: follow its marker tasks, with their weights."),
    ] = None,
    filter_hz: Annotated[
        float, typer.Option(min=0.0, help="Cut-off of the low-pass; 0: do not filter.")
    ] = 6.0,
    start: Annotated[float | None, typer.Option("--from", help="First time, s.")] = None,
    end: Annotated[float | None, typer.Option("--to", help="Last time, s.")] = None,
    axes: Annotated[
        str,
        typer.Option(
            help="The model's x,y,z in the file's axes: 'x,z,-y' where the laboratory's z is up."
        ),
    ] = "x,y,z",
    accuracy: Annotated[float, typer.Option(min=1e-12, max=0.1, help="As OpenSim's tool.")] = 1e-5,
) -> None:
    """Inverse kinematics of markers, filtered; prints how well the markers fit."""
    from condyle.opensim import inverse_kinematics, write_coordinates

    if weight and weights:
        raise InputDataError("--weight and --weights: must be one of the two")
    with _progress("time frames") as progress:
        result = inverse_kinematics(
            model,
            markers,
            weights=weights or _parsed_weights(weight or []),
            filter_hz=filter_hz,
            start=start,
            end=end,
            axes=axes,
            accuracy=accuracy,
            progress=progress,
        )
    write_coordinates(output, result)
    _report(output, result)


@app.command()
def paths(
    model: Model,
    coordinates: Annotated[Path, typer.Argument(help="Coordinates, .sto, .mot or .csv.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Path snapshots, .json.")] = Path(
        "paths.json"
    ),
    which: Annotated[
        Literal["beyond-cylinders", "wrapped", "all"],
        typer.Option(help="Paths that wrap around more than cylinders; all that wrap; or all."),
    ] = "beyond-cylinders",
) -> None:
    """Writes where OpenSim's paths run at each time frame, for surfaces that only OpenSim wraps."""
    from condyle.opensim import path_snapshots, write_snapshots

    with _progress("time frames") as progress:
        snapshots = path_snapshots(model, coordinates, which=which, progress=progress)
    write_snapshots(output, snapshots)
    _say(f"{output}: {len(snapshots['paths'])} paths at {len(snapshots['times'])} time frames")


def _say(text: str) -> None:
    console.print(text, highlight=False, markup=False, soft_wrap=True)


def _clipped(sentence: str) -> str:
    reason, _, names = sentence.rpartition(": ")
    first = names.split(", ")
    if len(first) <= _SHOWN:
        return sentence
    return f"{reason}: {', '.join(first[:_SHOWN])} and {len(first) - _SHOWN} more"


@contextmanager
def _progress(what: str) -> Iterator[Callable[[int, int], None]]:
    with progress_bar() as bar:
        task = bar.add_task(what, total=None, note="")

        def update(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)

        yield update


def _parsed_weights(texts: list[str]) -> dict[str, float] | None:
    parsed = {}
    for text in texts:
        name, _, value = text.rpartition("=")
        try:
            parsed[name] = float(value)
        except ValueError:
            name = ""
        if not name:
            raise InputDataError(f"--weight {text}: must be NAME=WEIGHT, like R_Asis=30")
    return parsed or None


def _report(output: Path, result: InverseKinematicsResult) -> None:
    rms = 1e3 * result.rms
    worst = int(rms.argmax())
    _say(f"{output}: {len(result.times)} time frames, {len(result.coordinates)} coordinates")
    _say(f"coordinates: {result.filter_in_words}")
    _say(
        f"marker RMS before filtering: mean {rms.mean():.2f} mm, from {rms.min():.2f} to "
        f"{rms[worst]:.2f} mm (at {result.times[worst]:g} s)"
    )
    missing = (result.errors != result.errors).sum(axis=0)
    order = sorted(range(len(result.markers)), key=lambda k: -result.marker_rms[k])
    rows = [
        (result.markers[k], f"{1e3 * result.marker_rms[k]:.2f}", str(missing[k]))
        for k in order[:_SHOWN]
    ]
    print_table("markers that fit worst", ("marker", "RMS mm", "frames missing"), rows)
    gaps = [f"{result.markers[k]} ({missing[k]})" for k in order if missing[k]]
    for title, names in (
        ("missing in some time frames", gaps),
        ("in the file, not in the model", result.unknown),
        ("in the model, not measured", result.not_measured),
        ("measured, but without weight", result.without_weight),
    ):
        if names:
            _say(f"{title}: {', '.join(names)}")
