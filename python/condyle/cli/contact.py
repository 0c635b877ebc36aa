# SPDX-License-Identifier: Apache-2.0
"""``condyle contact``: contact loads of meshes at given poses."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from condyle.cli import law_options, overlap_options
from condyle.cli.console import console
from condyle.errors import InputDataError

app = typer.Typer(help="The contact between two meshes.", no_args_is_help=True)


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
    integration: Annotated[
        Literal["insert", "femur", "both"],
        typer.Option(help="Whose faces are integrated; both: the mean."),
    ] = "insert",
    law: law_options.Law = "linear_volume",
    modulus: law_options.Modulus = None,
    youngs_modulus_mpa: law_options.YoungsModulus = None,
    poissons_ratio: law_options.PoissonsRatio = None,
    thickness_mm: law_options.Thickness = None,
    coefficient: law_options.Coefficient = None,
    exponent: law_options.Exponent = None,
    law_table: law_options.LawTable = None,
    volume: Annotated[
        Literal["law", "boolean"],
        typer.Option(help="boolean: also the exact overlap volume of closed solids, as a check."),
    ] = "law",
    femur_solid: Annotated[
        Path | None, typer.Option(help="boolean: closed femoral component, if --femur is open.")
    ] = None,
    insert_solid_medial: Annotated[
        Path | None, typer.Option(help="boolean: closed solid, if --insert-medial is open.")
    ] = None,
    insert_solid_lateral: Annotated[
        Path | None, typer.Option(help="boolean: closed solid, if --insert-lateral is open.")
    ] = None,
    cache: Annotated[
        Path | None,
        typer.Option(help="Folder that keeps what fast builds of the meshes between runs."),
    ] = None,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 for all cores.")] = 0,
) -> None:
    """Evaluates the reference contact at every pose of a table."""
    from condyle.contact import MeshContact, evaluate_table, read_poses, write_table

    table = read_poses(poses)
    solids = overlap_options.read_solids(
        volume,
        units,
        surfaces=(femur, insert_medial, insert_lateral),
        solids=(femur_solid, insert_solid_medial, insert_solid_lateral),
    )
    model = MeshContact.from_files(
        femur=femur,
        insert=insert,
        insert_medial=insert_medial,
        insert_lateral=insert_lateral,
        units=units,
        side_of_body=side_of_body,
        evaluation=evaluation,
        integration=integration,
        cache_directory=cache,
        law=law_options.read_law(
            law,
            modulus=modulus,
            youngs_modulus_mpa=youngs_modulus_mpa,
            poissons_ratio=poissons_ratio,
            thickness_mm=thickness_mm,
            coefficient=coefficient,
            exponent=exponent,
            law_table=law_table,
        ),
    )
    if model.fast_error is not None:
        console.print(model.fast_error.sentence(), highlight=False, soft_wrap=True)
    columns = evaluate_table(model, table, threads=threads)
    if solids is not None:
        columns = overlap_options.add_volumes(columns, solids, threads)
    write_table(out, columns)
    console.print(f"{out}: {len(table)} poses", highlight=False)


@app.command(name="pair")
def evaluate_pair(
    moving: Annotated[Path, typer.Option(help="Surface of the moving body, in its own frame.")],
    fixed: Annotated[
        list[Path],
        typer.Option(help="Surface of a compartment of the fixed body; as often as there are."),
    ],
    units: Annotated[Literal["m", "mm"], typer.Option(help="Unit of the mesh files.")],
    poses: Annotated[
        Path,
        typer.Option(help="CSV: x,y,z [m],theta_x,theta_y,theta_z [rad] of moving in fixed."),
    ],
    out: Annotated[Path, typer.Option(help="CSV to write: poses, loads per compartment.")],
    evaluation: Annotated[
        Literal["exact", "fast"],
        typer.Option(help="Triangles themselves, or smooth fields of them."),
    ] = "exact",
    integration: Annotated[
        Literal["fixed", "moving", "both"],
        typer.Option(help="Whose faces are integrated; both: the mean."),
    ] = "fixed",
    law: law_options.Law = "linear_volume",
    modulus: law_options.Modulus = None,
    youngs_modulus_mpa: law_options.YoungsModulus = None,
    poissons_ratio: law_options.PoissonsRatio = None,
    thickness_mm: law_options.Thickness = None,
    coefficient: law_options.Coefficient = None,
    exponent: law_options.Exponent = None,
    law_table: law_options.LawTable = None,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 for all cores.")] = 0,
) -> None:
    """Evaluates the contact of any two bodies, such as a patellar button on the trochlea."""
    from condyle.contact import (
        ContactPair,
        evaluate_pair_table,
        read_mesh,
        read_poses,
        write_table,
    )

    table = read_poses(poses)
    names = [file.stem for file in fixed]
    if len(set(names)) != len(names):
        raise InputDataError(f"--fixed: two files are called {names}: columns take their names")
    pair = ContactPair(
        read_mesh(moving, units),
        {name: read_mesh(file, units) for name, file in zip(names, fixed, strict=True)},
        evaluation=evaluation,
        integration=integration,
        law=law_options.read_law(
            law,
            modulus=modulus,
            youngs_modulus_mpa=youngs_modulus_mpa,
            poissons_ratio=poissons_ratio,
            thickness_mm=thickness_mm,
            coefficient=coefficient,
            exponent=exponent,
            law_table=law_table,
        ),
    )
    write_table(out, evaluate_pair_table(pair, table, threads=threads))
    console.print(f"{out}: {len(table)} poses", highlight=False)


@app.command(name="modulus")
def convert_modulus(
    poissons_ratio: Annotated[float, typer.Option(help="Of the layer.")],
    thickness_mm: Annotated[float, typer.Option(help="Of the layer.")],
    youngs_modulus_mpa: Annotated[
        float | None, typer.Option(help="Young's modulus of the layer: prints its modulus K.")
    ] = None,
    modulus: Annotated[
        float | None,
        typer.Option(help="Pressure modulus K [N/m³]: prints the layer's Young's modulus."),
    ] = None,
) -> None:
    """Converts between a thin elastic layer and a pressure modulus, K = M/h.

    The usual 9.3e9 N/m³ was fitted for forces and kinematics, not for pressures.
    """
    from condyle.contact import pressure_modulus, youngs_modulus

    if (youngs_modulus_mpa is None) == (modulus is None):
        raise InputDataError("give either --youngs-modulus-mpa or --modulus")
    thickness = 1e-3 * thickness_mm
    if youngs_modulus_mpa is not None:
        found = pressure_modulus(
            youngs_modulus=1e6 * youngs_modulus_mpa,
            poissons_ratio=poissons_ratio,
            thickness=thickness,
        )
        console.print(f"pressure modulus {found:.6g} N/m³", highlight=False)
    elif modulus is not None:
        found = youngs_modulus(modulus=modulus, poissons_ratio=poissons_ratio, thickness=thickness)
        console.print(f"Young's modulus {1e-6 * found:.6g} MPa", highlight=False)
