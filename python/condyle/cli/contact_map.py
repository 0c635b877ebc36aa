# SPDX-License-Identifier: Apache-2.0
"""``condyle contact map``: the contact at one pose, as a picture and as files for ParaView."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import typer

from condyle.cli.console import console
from condyle.errors import CondyleError, InputDataError

if TYPE_CHECKING:
    from condyle.contact import MeshContact

_COORDINATES = "x y z theta_x theta_y theta_z"


def add_to(app: typer.Typer) -> None:
    """Adds the command to ``condyle contact``."""
    app.command(name="map")(draw)


def draw(
    femur: Annotated[Path, typer.Option(help="Femoral component, in the femoral frame.")],
    side_of_body: Annotated[Literal["left", "right"], typer.Option(help="Left or right knee.")],
    units: Annotated[Literal["m", "mm"], typer.Option(help="Unit of the mesh files.")],
    insert: Annotated[
        Path | None, typer.Option(help="Insert, both compartments: split at z = 0.")
    ] = None,
    insert_medial: Annotated[Path | None, typer.Option(help="Medial compartment.")] = None,
    insert_lateral: Annotated[Path | None, typer.Option(help="Lateral compartment.")] = None,
    pose: Annotated[str | None, typer.Option(help=f'The pose: "{_COORDINATES}" [m, rad].')] = None,
    poses: Annotated[Path | None, typer.Option(help="CSV of poses [m, rad], with --row.")] = None,
    row: Annotated[int, typer.Option(min=1, help="Row of --poses; the first is 1.")] = 1,
    depth_mm: Annotated[
        float | None, typer.Option(help="Instead of a pose: this far below the seated pose.")
    ] = None,
    force: Annotated[
        float | None,
        typer.Option(help="Instead of a pose: Fy [N] carried without Mx at the seated x and z."),
    ] = None,
    flexion_deg: Annotated[float, typer.Option(help="With --depth-mm or --force.")] = 0.0,
    evaluation: Annotated[
        Literal["exact", "fast"],
        typer.Option(help="Triangles themselves, or a smooth field of them."),
    ] = "exact",
    vtp: Annotated[
        Path | None, typer.Option(help="Folder for VTP files: femur, insert_medial, …")
    ] = None,
    figure: Annotated[Path | None, typer.Option(help="PNG of the pressure map.")] = None,
) -> None:
    """Shows the contact pressure at one pose: --vtp for ParaView, --figure for a picture."""
    from condyle.contact import MeshContact, contact_map

    if vtp is None and figure is None:
        raise InputDataError("contact map: name --vtp, --figure, or both")
    ways = {"--pose": pose, "--poses": poses, "--depth-mm": depth_mm, "--force": force}
    given = [name for name, value in ways.items() if value is not None]
    if len(given) != 1:
        raise InputDataError(f"contact map: give one of {', '.join(ways)} ({len(given)} given)")
    contact = MeshContact.from_files(
        femur=femur,
        insert=insert,
        insert_medial=insert_medial,
        insert_lateral=insert_lateral,
        units=units,
        side_of_body=side_of_body,
        evaluation=evaluation,
    )
    if pose is not None:
        at = _read_pose(pose)
    elif poses is not None:
        at = _row_of(poses, row)
    else:
        at = _seated(contact, np.radians(flexion_deg), depth_mm, force)
    found = contact_map(contact, at)
    if found.status != "ok":
        console.print(f"warning: {found.status}", highlight=False, markup=False)
    made: list[Path] = []
    if vtp is not None:
        from condyle.report.vtp_files import write_vtp

        made += write_vtp(vtp, found)
    if figure is not None:
        from condyle.report.pressure_map import Panel, pressure_map_figure
        from condyle.report.style import house_style, save

        x, y, z = 1e3 * at[:3]
        title = f"x {x:.2f}, y {y:.2f}, z {z:.2f} mm, flexion {-np.degrees(at[5]):.0f}°"
        with house_style():
            made.append(save(pressure_map_figure([Panel(title, found)], title=found.law), figure))
    for file in made:
        console.print(str(file), highlight=False, markup=False, soft_wrap=True)


def _read_pose(text: str) -> np.ndarray:
    try:
        values = np.array([float(word) for word in text.replace(",", " ").split()])
    except ValueError as error:
        raise InputDataError(f"--pose '{text}': {error}") from error
    if values.shape != (6,) or not np.all(np.isfinite(values)):
        raise InputDataError(f"--pose '{text}': six finite numbers are needed: {_COORDINATES}")
    return values


def _row_of(file: Path, row: int) -> np.ndarray:
    from condyle.contact import read_poses

    table = np.asarray(read_poses(file))
    if row > len(table):
        raise InputDataError(f"--row is {row}: {file} has {len(table)} rows")
    return np.asarray(table[row - 1])


def _seated(
    contact: "MeshContact", flexion: float, depth_mm: float | None, force: float | None
) -> np.ndarray:
    from condyle.fdk import load_seated, seated_pose

    seat = seated_pose(contact, flexion)
    if not seat.converged:
        raise CondyleError(f"seated pose: {seat.status}: {seat.advice}")
    at = seat.pose.copy()
    if depth_mm is not None:
        at[1] -= 1e-3 * depth_mm
    elif force is not None:
        found = load_seated(contact, seat, force, Mx=0.0)
        if not found.converged[0]:
            raise CondyleError(f"--force {force:g}: no equilibrium: {found.status[0]}")
        at = found.poses[0]
    return np.asarray(at)
