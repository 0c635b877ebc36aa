# SPDX-License-Identifier: Apache-2.0
"""``condyle implant``: parametric implants, and a look at meshes from elsewhere."""

from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from condyle.cli.console import console, print_table

if TYPE_CHECKING:
    from condyle.contact import ImplantExamination, TrialContact

app = typer.Typer(help="Implants: generate and check.", no_args_is_help=True)


@app.command()
def generate(
    directory: Annotated[Path, typer.Argument(help="Folder for femur.stl, insert.stl, …")],
    preset: Annotated[Literal["curved", "flat"], typer.Option(help="Coronal profile.")] = "curved",
    side_of_body: Annotated[
        Literal["left", "right"], typer.Option(help="Left or right knee.")
    ] = "right",
    size: Annotated[float, typer.Option(help="Scale; 1 is 65 mm from front to back.")] = 1.0,
    parameters: Annotated[
        Path | None,
        typer.Option(help="parameters.json of an earlier implant, instead of a preset."),
    ] = None,
) -> None:
    """Writes a parametric implant as STL files in metres, with its parameters."""
    from condyle import implants

    chosen = (
        implants.read_parameters(parameters)
        if parameters is not None
        else implants.preset(preset, size=size, side_of_body=side_of_body)
    )
    implant = implants.generate(chosen)
    implants.write_implant(directory, implant)
    for name, mesh in implant.meshes().items():
        console.print(f"{directory / name}.stl: {len(mesh.faces)} triangles")


@app.command()
def check(
    files: Annotated[
        list[Path] | None, typer.Argument(help="Meshes to look at one by one: STL, OBJ, PLY, OFF.")
    ] = None,
    units: Annotated[Literal["m", "mm"], typer.Option(help="Unit of the files.")] = "mm",
    femur: Annotated[Path | None, typer.Option(help="Femoral component of a pair.")] = None,
    insert: Annotated[Path | None, typer.Option(help="Its insert, both compartments.")] = None,
    insert_medial: Annotated[Path | None, typer.Option(help="Medial compartment.")] = None,
    insert_lateral: Annotated[Path | None, typer.Option(help="Lateral compartment.")] = None,
    side_of_body: Annotated[
        Literal["left", "right"] | None, typer.Option(help="Left or right knee, for a pair.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print everything as JSON.")] = False,
) -> None:
    """Says what is wrong with meshes, what reading repairs and what to do; seats a pair and loads it with 1 kN.

    The exit code is 2 where a contact is impossible.
    """
    from condyle.contact import ImplantExamination, examine_implant, examine_mesh
    from condyle.errors import InputDataError

    pair = any(f is not None for f in (femur, insert, insert_medial, insert_lateral))
    if pair and files:
        raise InputDataError(f"{files[0]}: give meshes one by one, or a pair by its options")
    if pair:
        if femur is None or side_of_body is None:
            absent = "--femur" if femur is None else "--side-of-body"
            raise InputDataError(f"{absent} is missing: a pair needs it")
        found = examine_implant(
            femur=femur,
            insert=insert,
            insert_medial=insert_medial,
            insert_lateral=insert_lateral,
            units=units,
            side_of_body=side_of_body,
        )
    elif files:
        found = ImplantExamination(tuple(examine_mesh(file, units) for file in files), (), None)
    else:
        raise InputDataError("name mesh files, or a pair: --femur and --insert")
    if json:
        typer.echo(dumps(found.as_dict(), indent=1))
    else:
        _print_examination(found)
    if found.errors:
        worst = found.errors[0]
        where = next((f"{p.file}: " for p in found.parts if worst in p.findings), "")
        raise InputDataError(f"{where}{worst.text}. {worst.advice}")


def _print_examination(found: "ImplantExamination") -> None:
    for part in found.parts:
        if part.part != "mesh" and part.after:
            _say(f"{part.part}: {part.file}: {_in_brief(part.after)}")
        elif part.after:
            rows = [[key, _shown(part.before[key]), _shown(part.after[key])] for key in part.before]
            print_table(part.file, ["", "in the file", "after repair"], rows)
    for finding in found.all_findings:
        if finding.severity != "error":
            _say(f"{finding.severity}: {finding.part}: {finding.text}. {finding.advice}")
    if not found.all_findings:
        _say("nothing wrong found")
    if found.trial is not None:
        _print_trial(found.trial)


def _in_brief(mesh: dict[str, Any]) -> str:
    size = " × ".join(
        f"{high - low:.1f}" for low, high in zip(mesh["lowest_mm"], mesh["highest_mm"], strict=True)
    )
    kind = "closed" if mesh["closed"] else "open"
    return f"{mesh['faces']} triangles, {kind}, {size} mm (x, y, z)"


def _print_trial(trial: "TrialContact") -> None:
    if trial.first_touch_y_mm is not None:
        _say(f"first touch at x = z = 0, rotations zero: y = {trial.first_touch_y_mm:.3f} mm")
    if trial.seat_status == "converged":
        x, y, z = trial.seat_mm
        _say(f"seated pose: x {x:.3f}, y {y:.3f}, z {z:.3f} mm")
    if trial.load_status == "converged":
        rows = [
            [name, *(f"{value:.4g}" for value in values)]
            for name, values in (
                ("Fy, N", trial.Fy),
                ("greatest depth, mm", trial.max_depth_mm),
                ("area, mm²", trial.area_mm2),
                ("peak pressure, MPa", trial.peak_pressure_mpa),
                ("loaded faces", trial.loaded_faces),
            )
        ]
        title = f"{trial.load:.0f} N there, rotations zero, p = K·d with K = 9.3 GN/m³"
        print_table(title, ["", "medial", "lateral"], rows)


def _say(text: str) -> None:
    console.print(text, highlight=False, markup=False, soft_wrap=True)


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(_shown(v) for v in value)
    return str(value)
