# SPDX-License-Identifier: Apache-2.0
"""Whether a surrogate stands for a given contact: made of these meshes, under this law.

A study's surrogate names the SHA-256 of the mesh files that it was made of (metadata ``condyle.implant``), and its
law (``condyle.contact_law``). What a file does not name is not compared.
"""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle._core.geometry import Mesh
from condyle.contact.laws import ContactLaw
from condyle.contact.mesh_contact import MeshContact
from condyle.contact.mesh_files import read_mesh, write_mesh
from condyle.errors import InputDataError
from condyle.surrogate.library import OnnxContactModel
from condyle.whole_files import content_hash

_PARTS: Final = ("femur", "insert_medial", "insert_lateral")


def require_same_meshes(
    surrogate: OnnxContactModel, contact: MeshContact, files: Mapping[str, Path]
) -> bool:
    """Refuses a surrogate that was made of other meshes than a contact.

    A part is the surrogate's where its file has the hash; where the surface has it once it is written as a study
    writes it; or where the file beside the insert's that has it (``insert_medial.stl``) holds the same triangles.

    Args:
        surrogate: the surrogate.
        contact: made of the meshes.
        files: that the meshes are from: ``femur``, ``insert`` or its parts.

    Returns:
        False where the surrogate does not say what it was made of.

    Raises:
        InputDataError: another mesh; names the field, both hashes and what to do.
    """
    known = _metadata(surrogate, "condyle.implant")
    wanted = {part: known[f"{part}.stl"] for part in _PARTS if f"{part}.stl" in known}
    for part, digest in wanted.items():
        found = _digests(getattr(contact, part), part, files)
        if digest not in found:
            file = files.get(part, files.get("insert"))
            raise InputDataError(
                f"{surrogate.file}: metadata condyle.implant: {part}.stl is {digest[:12]}…; the {part} of {file} is "
                f"{found[0][:12]}…: it was made of another mesh; name that (it is in its study's implant folder), "
                "or train a surrogate of this one"
            )
    return bool(wanted)


def require_same_law(surrogate: OnnxContactModel, law: ContactLaw) -> None:
    """Refuses a surrogate of another contact law, or of other parameters.

    Raises:
        InputDataError: another law; names the field and both values.
    """
    known = _metadata(surrogate, "condyle.contact_law")
    for key, value in law.describe().items():
        if key in known and not _same(known[key], value):
            raise InputDataError(
                f"{surrogate.file}: metadata condyle.contact_law: {key} is {known[key]}; the reference contact's is "
                f"{value}: give both the same law"
            )


def _metadata(surrogate: OnnxContactModel, key: str) -> dict[str, Any]:
    try:
        content = json.loads(surrogate.metadata[key])
    except (KeyError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return math.isclose(a, b, rel_tol=1e-12)
    return bool(a == b)


def _digests(mesh: Mesh, part: str, files: Mapping[str, Path]) -> list[str]:
    """Hashes that a study may have recorded of a part, the surface's own first."""
    with tempfile.TemporaryDirectory() as folder:
        written = Path(folder) / "mesh.stl"
        write_mesh(written, mesh)
        found = [content_hash(written.read_bytes())]
    if part in files:
        found.append(content_hash(files[part].read_bytes()))
    elif "insert" in files:
        beside = files["insert"].with_name(f"{part}.stl")
        if beside.is_file() and _same_triangles(read_mesh(beside, "m"), mesh):
            found.append(content_hash(beside.read_bytes()))
    return found


def _same_triangles(a: Mesh, b: Mesh) -> bool:
    return np.array_equal(_triangles(a), _triangles(b))


def _triangles(mesh: Mesh) -> NDArray[np.float32]:
    """(m, 9) corners in single precision, as STL has them, in an order that does not depend on the file's."""
    corners = np.asarray(mesh.vertices, dtype=np.float32)[np.asarray(mesh.faces)]
    rows = np.arange(len(corners))
    first = np.lexsort(corners.transpose(2, 0, 1)[::-1], axis=1)[:, 0]
    turned = [corners[rows, (first + k) % 3] for k in range(3)]
    flat = np.concatenate(turned, axis=1)
    return flat[np.lexsort(flat.T[::-1])]
