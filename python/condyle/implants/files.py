# SPDX-License-Identifier: Apache-2.0
"""Writing implants: binary STL in metres, and the design's parameters as JSON."""

import dataclasses
import json
from pathlib import Path
from typing import Final

import numpy as np

from condyle.errors import InputDataError
from condyle.implants.implant import Implant
from condyle.implants.mesh import SurfaceMesh
from condyle.implants.parameters import ImplantParameters

#: Binary STL: 80 bytes of header (must not begin with "solid"), face count, then 50 bytes a face.
_HEADER: Final = b"binary STL, unit: metre".ljust(80)
_FACE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_UNITS: Final = {"length": "m", "angle": "rad"}


def write_stl(path: Path | str, mesh: SurfaceMesh) -> None:
    """Writes a binary STL in metres (single precision, as the format prescribes)."""
    record = np.zeros(len(mesh.faces), dtype=_FACE)
    record["normal"] = mesh.face_normals()
    record["corners"] = mesh.vertices[mesh.faces]
    count = np.array([len(record)], dtype="<u4")
    Path(path).write_bytes(_HEADER + count.tobytes() + record.tobytes())


def write_implant(directory: Path | str, implant: Implant) -> None:
    """Writes femur.stl, insert.stl, insert_medial.stl, insert_lateral.stl and parameters.json."""
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    for name, mesh in implant.meshes().items():
        write_stl(directory / f"{name}.stl", mesh)
    content = {"units": _UNITS, "parameters": dataclasses.asdict(implant.parameters)}
    text = json.dumps(content, indent=2) + "\n"
    (directory / "parameters.json").write_text(text, encoding="utf-8")


def read_parameters(path: Path | str) -> ImplantParameters:
    """Reads the parameters.json that :func:`write_implant` wrote.

    Raises:
        InputDataError: not such a file, other units, or a parameter missing, unknown or bad.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputDataError(f"{path}: not a readable JSON file ({error})") from error
    if not isinstance(content, dict) or content.get("units") != _UNITS:
        found = content.get("units") if isinstance(content, dict) else content
        raise InputDataError(f"{path}: units = {found!r}: must be {_UNITS}")
    values = content.get("parameters")
    known = {field.name for field in dataclasses.fields(ImplantParameters)}
    given = set(values) if isinstance(values, dict) else set()
    if not isinstance(values, dict) or given != known:
        raise InputDataError(
            f"{path}: parameters: missing {sorted(known - given)}, unknown {sorted(given - known)}"
        )
    try:
        return ImplantParameters(**values)
    except InputDataError as error:
        raise InputDataError(f"{path}: {error}") from error
