# SPDX-License-Identifier: Apache-2.0
"""Triangle surfaces in files, and what is wrong with them."""

from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal

from condyle._core import geometry
from condyle._core.geometry import Mesh

Units = Literal["m", "mm"]
MeshFile = str | PathLike[str]

_REPORT: Final = (
    "vertices",
    "faces",
    "closed",
    "components",
    "boundary_edges",
    "boundary_loops",
    "inconsistent_edges",
    "non_manifold_edges",
    "duplicate_vertices",
    "duplicate_faces",
    "degenerate_faces",
    "sliver_faces",
    "unused_vertices",
)


def read_mesh(file: MeshFile, units: Units, *, repair: bool = True) -> Mesh:
    """Reads an STL, OBJ, PLY or OFF file.

    Args:
        file: the file; its extension says the format.
        units: unit of its numbers.
        repair: weld vertices closer than 1 nm, drop faces without area and repeated ones, and make
            windings agree. A surface that is inside out as a whole stays so.

    Returns:
        The surface, vertices in m.

    Raises:
        ValueError: the file is missing, not of its format, without faces, or not of the size of a knee component
            in these units; the one line of text names the file and the reason.
    """
    mesh = geometry.read_mesh(Path(file), geometry.length_unit(units))
    return _repaired(file, mesh).mesh if repair else mesh


def write_mesh(file: MeshFile, mesh: Mesh) -> None:
    """Writes a binary STL or PLY, or an OBJ or OFF text, in m.

    Raises:
        ValueError: the extension is none of these.
        RuntimeError: the file cannot be written.
    """
    geometry.write_mesh(Path(file), mesh)


def inspect_mesh(file: MeshFile, units: Units) -> tuple[dict[str, Any], dict[str, Any]]:
    """What is right and wrong with a mesh file, as read and as :func:`read_mesh` repairs it.

    Returns:
        Two dicts with the same keys: counts, ``closed``, ``area_mm2``, ``volume_cm3`` (0 unless closed), and
        the bounding box ``lowest_mm`` and ``highest_mm``.

    Raises:
        ValueError: as :func:`read_mesh`.
    """
    before = geometry.read_mesh(Path(file), geometry.length_unit(units))
    return _report(before), _report(_repaired(file, before).mesh)


def _repaired(file: MeshFile, mesh: Mesh) -> geometry.RepairResult:
    settings = geometry.RepairSettings()
    # An inverted solid stays inverted: whoever made it should know, and the checks of a contact say so.
    settings.turn_closed_outward = False
    try:
        return geometry.repair_mesh(mesh, settings)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error


def _report(mesh: Mesh) -> dict[str, Any]:
    report = geometry.report_mesh(mesh)
    return {name: getattr(report, name) for name in _REPORT} | {
        "area_mm2": 1e6 * report.area,
        "volume_cm3": 1e6 * report.volume,
        "lowest_mm": [1e3 * float(x) for x in report.lowest],
        "highest_mm": [1e3 * float(x) for x in report.highest],
    }
