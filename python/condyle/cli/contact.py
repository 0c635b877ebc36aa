# SPDX-License-Identifier: Apache-2.0
"""``condyle contact``: contact loads of meshes at given poses."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from condyle.cli.console import console

app = typer.Typer(help="The contact between two meshes.", no_args_is_help=True)


@app.callback()
def _contact() -> None:
    """Keeps ``eval`` a subcommand although it is the only one."""


@app.command(name="eval")
def evaluate(
    femur: Annotated[Path, typer.Option(help="Femoral component, in the femoral frame.")],
    side_of_body: Annotated[Literal["left", "right"], typer.Option(help="Left or right knee.")],
    units: Annotated[Literal["m", "mm"], typer.Option(help="Unit of the mesh files.")],
    poses: Annotated[Path, typer.Option(help="CSV: x,y,z [m],theta_x,theta_y,theta_z [rad].")],
    out: Annotated[Path, typer.Option(help="CSV to write: poses, loads per side, status.")],
    insert: Annotated[
        Path | None,
        typer.Option(help="Insert, both compartments: split by face centroid at z = 0."),
    ] = None,
    insert_medial: Annotated[Path | None, typer.Option(help="Medial compartment.")] = None,
    insert_lateral: Annotated[Path | None, typer.Option(help="Lateral compartment.")] = None,
    evaluation: Annotated[
        Literal["exact", "fast"],
        typer.Option(help="Triangles themselves, or a smooth field of them."),
    ] = "exact",
    pressure_modulus: Annotated[float, typer.Option(help="K in p = K·d [N/m³].")] = 9.3e9,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 for all cores.")] = 0,
) -> None:
    """Evaluates the reference contact at every pose of a table."""
    from condyle.contact import MeshContact, evaluate_table, read_poses, write_table

    table = read_poses(poses)
    model = MeshContact.from_files(
        femur=femur,
        insert=insert,
        insert_medial=insert_medial,
        insert_lateral=insert_lateral,
        units=units,
        side_of_body=side_of_body,
        evaluation=evaluation,
        pressure_modulus=pressure_modulus,
    )
    columns = evaluate_table(model, table, threads=threads)
    write_table(out, columns)
    console.print(f"{out}: {len(table)} poses", highlight=False)
