# SPDX-License-Identifier: Apache-2.0
"""The exact volume in which two closed solids overlap: a check of a contact's own Σ A·d.

The triangles of the overlap itself are formed (CGAL corefinement), which takes tens of milliseconds a
pose. It is the overlap of *solids*: at the rim of an articulating surface it counts material that a
depth below the other surface does not see.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import geometry as _geometry
from condyle._core.geometry import Mesh, OverlapSolid
from condyle.contact.load_table import Columns
from condyle.contact.mesh_files import MeshFile, Units, read_mesh
from condyle.conventions import POSE_COLUMNS, SIDES
from condyle.errors import InputDataError

__all__ = ["OverlapSolid", "OverlapVolume", "add_overlap_columns", "overlap_volume", "read_solid"]


@dataclass(frozen=True)
class OverlapVolume:
    """The overlap of a femoral component with one insert solid at n poses.

    Attributes:
        volume: (n,) [m³]; exactly 0 where the solids are disjoint, NaN where ``status`` is "failed".
        centroid: (n, 3) in the tibial frame [m]; zero where disjoint.
        status: n of "ok"; "self_intersection_at_cut", where a solid passes through itself close to where it
            cuts the other and a region it covers twice may count twice; or "failed".
        self_intersections: pairs of faces at which the two solids pass through themselves, wherever that is.
    """

    volume: NDArray[np.float64]
    centroid: NDArray[np.float64]
    status: list[str]
    self_intersections: int


def overlap_volume(
    femur: Mesh | OverlapSolid, insert: Mesh | OverlapSolid, poses: ArrayLike, *, threads: int = 0
) -> OverlapVolume:
    """The exact overlap volume of two closed solids.

    Args:
        femur: closed surface of the femoral component, in the femoral frame; an ``OverlapSolid`` of it saves
            preparing it again.
        insert: closed surface of the insert or of one compartment, in the tibial frame.
        poses: (n, 6) or (6,) [m, rad].
        threads: 0 means all cores. The result does not depend on it.

    Raises:
        InputDataError: poses are not (n, 6).
        ValueError: a surface is open, inside out, or not one that has an inside; or a pose is not finite.
    """
    table = np.atleast_2d(np.ascontiguousarray(poses, dtype=np.float64))
    if table.ndim != 2 or table.shape[1] != len(POSE_COLUMNS):
        raise InputDataError(f"poses of shape {table.shape}: must be (n, 6)")
    a, b = _solid(femur, "femur"), _solid(insert, "insert")
    volume, centroid, status = _geometry.overlap_volumes(a, b, table, threads)
    pairs = a.self_intersections + b.self_intersections
    return OverlapVolume(np.asarray(volume), np.asarray(centroid), list(status), pairs)


def read_solid(file: MeshFile | None, units: Units, *, option: str) -> OverlapSolid:
    """Reads a closed solid.

    Args:
        file: the mesh file; nothing is refused.
        units: unit of its numbers.
        option: what the caller's user would name to give the file.

    Raises:
        InputDataError: no file, or a surface that is not closed or not outward; the text names the file and the remedy.
    """
    if file is None:
        raise InputDataError(
            f"{option} is missing: the Boolean volume of a side needs its own solid"
        )
    try:
        return OverlapSolid(read_mesh(file, units), str(file))
    except ValueError as error:
        raise InputDataError(f"{error} ({option})") from error


def add_overlap_columns(
    columns: Columns,
    femur: OverlapSolid,
    inserts: Mapping[str, OverlapSolid],
    *,
    threads: int = 0,
) -> Columns:
    """A load table with the exact overlap volumes of the solids beside the law's own.

    Args:
        columns: of :func:`condyle.contact.evaluate_table`.
        femur: the femoral component.
        inserts: the solid of each side, by its name.
        threads: 0 means all cores.

    Returns:
        The columns with ``medial_boolean_volume`` and ``lateral_boolean_volume`` [m³] before ``status``, which
        also says where such a volume is doubtful or missing.
    """
    poses = np.stack([np.asarray(columns[name]) for name in POSE_COLUMNS], axis=1)
    wider = {name: column for name, column in columns.items() if name != "status"}
    status = list(columns["status"])
    for side in SIDES:
        overlap = overlap_volume(femur, inserts[side], poses, threads=threads)
        wider[f"{side}_boolean_volume"] = overlap.volume
        for i, found in enumerate(overlap.status):
            if found != "ok":
                remark = f"{side} boolean volume: {found}"
                status[i] = remark if status[i] == "ok" else f"{status[i]}; {remark}"
    return wider | {"status": status}


def _solid(surface: Mesh | OverlapSolid, what: str) -> OverlapSolid:
    return surface if isinstance(surface, OverlapSolid) else OverlapSolid(surface, what)
