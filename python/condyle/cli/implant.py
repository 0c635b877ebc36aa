# SPDX-License-Identifier: Apache-2.0
"""``condyle implant``: parametric implants, and a look at meshes from elsewhere."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from condyle.cli.console import console, print_table

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
    files: Annotated[list[Path], typer.Argument(help="Meshes: STL, OBJ, PLY, OFF.")],
    units: Annotated[Literal["m", "mm"], typer.Option(help="Unit of the files.")] = "mm",
) -> None:
    """Reports what is wrong with meshes, and what reading them repairs."""
    from condyle.contact import inspect_mesh

    for file in files:
        before, after = inspect_mesh(file, units)
        rows = [[key, _shown(before[key]), _shown(after[key])] for key in before]
        print_table(str(file), ["", "in the file", "after repair"], rows)


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(_shown(v) for v in value)
    return str(value)
