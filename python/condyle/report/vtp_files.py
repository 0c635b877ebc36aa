# SPDX-License-Identifier: Apache-2.0
"""Contact maps as VTP files, for ParaView and whatever else reads VTK (``pip install 'condyle[vtk]'``).

One file a surface, in the tibial frame, lengths in m: ``insert_medial.vtp`` and ``insert_lateral.vtp`` with cell data
``depth`` [m] and ``pressure`` [Pa], and ``femur.vtp`` placed at the pose. Each carries as field data what it was made
with: pose, law, side of body, status, and the wrench of either side on the femur.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from condyle.contact import ContactMap
from condyle.errors import InputDataError
from condyle.whole_files import write_whole

Floats = NDArray[np.float64]
Faces = NDArray[np.int32]


def write_vtp(directory: Path, contact: ContactMap) -> list[Path]:
    """Writes the surfaces of a contact map, each whole or not at all.

    Args:
        directory: Made where it does not exist.
        contact: From :func:`condyle.contact.contact_map`.

    Returns:
        The files.

    Raises:
        InputDataError: The ``vtk`` package is missing, or a file cannot be written.
    """
    vtk = _vtk()
    field: dict[str, Floats | str] = {
        "pose_m_rad": contact.pose,
        "law": contact.law,
        "side_of_body": contact.side_of_body,
        "status": contact.status,
    }
    field |= {f"{name}_wrench_N_Nm": side.wrench for name, side in contact.sides.items()}
    surfaces: dict[str, tuple[Floats, Faces, dict[str, Floats]]] = {
        "femur": (contact.femur_vertices, contact.femur_faces, {})
    } | {
        f"insert_{name}": (
            side.vertices,
            side.faces,
            {"depth": side.depth, "pressure": side.pressure},
        )
        for name, side in contact.sides.items()
    }
    made = []
    for name, (vertices, faces, cells) in surfaces.items():
        file = directory / f"{name}.vtp"
        try:
            directory.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputDataError(f"{directory}: cannot be made: {error.strerror}") from error
        write_whole(file, _text(vtk, _surface(vtk, vertices, faces, cells, field)))
        made.append(file)
    return made


def _vtk() -> Any:
    """The parts of vtk that a surface file needs, in one namespace; the whole package takes seconds to import."""
    from types import SimpleNamespace

    try:
        from vtkmodules.util import numpy_support
        from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
        from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
    except ImportError as error:
        raise InputDataError(
            "VTP files need the package vtk: pip install 'condyle[vtk]'"
        ) from error
    return SimpleNamespace(
        array=numpy_support.numpy_to_vtk,
        ids=numpy_support.numpy_to_vtkIdTypeArray,
        Points=vtkPoints,
        StringArray=vtkStringArray,
        CellArray=vtkCellArray,
        PolyData=vtkPolyData,
        Writer=vtkXMLPolyDataWriter,
    )


def _named(vtk: Any, name: str, values: Floats | str) -> Any:
    if isinstance(values, str):
        array = vtk.StringArray()
        array.InsertNextValue(values)
    else:
        array = vtk.array(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def _surface(
    vtk: Any,
    vertices: Floats,
    faces: Faces,
    cells: dict[str, Floats],
    field: dict[str, Floats | str],
) -> Any:
    points = vtk.Points()
    points.SetData(vtk.array(np.ascontiguousarray(vertices, dtype=np.float64), deep=True))
    corners = vtk.CellArray()
    offsets = np.arange(0, 3 * len(faces) + 1, 3, dtype=np.int64)
    connectivity = np.ascontiguousarray(faces, dtype=np.int64).ravel()
    corners.SetData(vtk.ids(offsets, deep=True), vtk.ids(connectivity, deep=True))
    surface = vtk.PolyData()
    surface.SetPoints(points)
    surface.SetPolys(corners)
    for name, values in cells.items():
        surface.GetCellData().AddArray(_named(vtk, name, values))
    if "pressure" in cells:
        surface.GetCellData().SetActiveScalars("pressure")
    for name, value in field.items():
        surface.GetFieldData().AddArray(_named(vtk, name, value))
    return surface


def _text(vtk: Any, surface: Any) -> str:
    writer = vtk.Writer()
    writer.SetInputData(surface)
    writer.SetDataModeToBinary()  # base64: text that write_whole can put down whole
    writer.WriteToOutputStringOn()
    if writer.Write() != 1:
        raise InputDataError("VTK could not write a surface")
    return str(writer.GetOutputString())
