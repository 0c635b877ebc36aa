# SPDX-License-Identifier: Apache-2.0
"""An implant pair out of its mesh files: read, repaired, split and checked."""

from collections.abc import Callable
from typing import TypedDict, TypeVar

from condyle._core import contact as _contact
from condyle._core.common import side_of_body as _side_of_body
from condyle._core.geometry import Mesh
from condyle.contact.mesh_files import MeshFile, Units, read_mesh
from condyle.conventions import SideOfBody
from condyle.errors import InputDataError

_T = TypeVar("_T")


class ImplantMeshes(TypedDict):
    """The surfaces of an implant pair: the femur in F, the compartments in T [m]."""

    femur: Mesh
    insert_medial: Mesh
    insert_lateral: Mesh


def read_implant(
    *,
    femur: MeshFile | None,
    insert: MeshFile | None = None,
    insert_medial: MeshFile | None = None,
    insert_lateral: MeshFile | None = None,
    units: Units,
    side_of_body: SideOfBody,
) -> ImplantMeshes:
    """Reads an implant pair, from one insert or its two compartments.

    Args:
        femur: file of the femoral component, in the femoral frame.
        insert: file of the whole insert, in the tibial frame; split by face centroid at z = 0.
        insert_medial: file of the medial compartment, instead of ``insert``.
        insert_lateral: file of the lateral compartment, instead of ``insert``.
        units: unit of the numbers in the files.
        side_of_body: which knee the implant is for.

    Returns:
        The three surfaces.

    Raises:
        ValueError: one line that names the argument or the file and what is wrong with it: as
            :func:`read_mesh`, and normals that point inwards, or parts that are swapped.
    """
    side = _side_of_body(side_of_body)
    if femur is None:
        raise InputDataError("femur is missing: name the file of the femoral component")
    femur_mesh = read_mesh(femur, units)
    if insert is not None:
        if insert_medial is not None or insert_lateral is not None:
            raise InputDataError(
                f"insert is {insert}: goes without insert_medial and insert_lateral"
            )
        files = f"{insert}"
        whole = read_mesh(insert, units)
        medial, lateral = _naming(files, lambda: _contact.split_insert(whole, side))
    else:
        if insert_medial is None or insert_lateral is None:
            absent = "insert_medial" if insert_medial is None else "insert_lateral"
            raise InputDataError(
                f"{absent} is missing: name insert, or both insert_medial and insert_lateral"
            )
        files = f"{insert_medial}, {insert_lateral}"
        medial, lateral = read_mesh(insert_medial, units), read_mesh(insert_lateral, units)
    _naming(f"{femur}", lambda: _contact.require_femur(femur_mesh))
    _naming(files, lambda: _contact.require_insert([medial, lateral], side))
    _naming(f"{femur}, {files}", lambda: _contact.require_unswapped(femur_mesh, [medial, lateral]))
    return {"femur": femur_mesh, "insert_medial": medial, "insert_lateral": lateral}


def _naming(files: str, check: Callable[[], _T]) -> _T:
    """Runs a check that speaks of parts; a complaint then names their files."""
    try:
        return check()
    except ValueError as error:
        raise InputDataError(f"{files}: {error}") from error
