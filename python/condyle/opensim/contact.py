# SPDX-License-Identifier: Apache-2.0
"""Contact surfaces and pairs as OpenSim-JAM writes them; the library of OpenSim 4.6 does not know them."""

from __future__ import annotations

from typing import Any

from condyle.errors import InputDataError
from condyle.opensim.document import CONTACT_FORCE, CONTACT_MESH, RemovedComponent
from condyle.opensim.findings import Findings
from condyle.opensim.frames import find_frame, frame_in_body
from condyle.opensim.library import OpenSimModel

#: Of Smith2018ContactMesh, where a file leaves them out [Pa, -, m].
_DEFAULTS = {"elastic_modulus": 1e6, "poissons_ratio": 0.5, "thickness": 0.005}


def describe_contact_surfaces(loaded: OpenSimModel, findings: Findings) -> list[dict[str, Any]]:
    """The surfaces, in frames fixed to bodies.

    Raises:
        InputDataError: A surface's frame is not in the model.
    """
    surfaces = []
    for mesh in loaded.document.removed_of(CONTACT_MESH):
        path = mesh.text("socket_frame", "")
        frame = find_frame(loaded.model, path or "")
        if frame is None:
            raise InputDataError(
                f"{loaded.file}: {CONTACT_MESH} {mesh.name}: socket_frame is '{path}': "
                "no such frame in the model"
            )
        if [float(s) for s in (mesh.text("scale_factors", "1 1 1") or "").split()] != [1.0] * 3:
            findings.add("scale factors of contact meshes", mesh.name)
        if mesh.text("use_variable_thickness", "false") == "true":
            findings.add("variable thickness of contact meshes", mesh.name)
        surfaces.append(
            {
                "name": mesh.name,
                "frame": frame_in_body(frame),
                "mesh": mesh.text("mesh_file", "") or "",
            }
        )
    return surfaces


def describe_contact_pairs(loaded: OpenSimModel, findings: Findings) -> list[dict[str, Any]]:
    """The pairs: first is JAM's target mesh, second its casting mesh.

    The two layers are one, as in JAM's lumped model (Bei & Fregly 2004): the sum of the thicknesses, the
    mean of the moduli and of Poisson's ratios.

    Raises:
        InputDataError: A pair names a mesh that is not in the file.
    """
    meshes = {mesh.name: mesh for mesh in loaded.document.removed_of(CONTACT_MESH)}
    pairs = []
    for force in loaded.document.removed_of(CONTACT_FORCE):
        names = [_mesh_of(loaded, force, meshes, end) for end in ("target", "casting")]
        layers = [{key: _number(meshes[n], key) for key in _DEFAULTS} for n in names]
        lumped = force.text("use_lumped_contact_model", "true") == "true"
        if not lumped and layers[0] != layers[1]:
            findings.add(
                "contact pairs of two different layers (taken as one, averaged)", force.name
            )
        if force.text("elastic_foundation_formulation", "linear") != "linear":
            findings.add("nonlinear pressure law of contact pairs", force.name)
        if force.text("appliesForce", "true") == "false":
            findings.add("contact pairs that are switched off (taken as on)", force.name)
        pairs.append(
            {
                "name": force.name,
                "first": names[0],
                "second": names[1],
                "youngs_modulus": (layers[0]["elastic_modulus"] + layers[1]["elastic_modulus"]) / 2,
                "poissons_ratio": (layers[0]["poissons_ratio"] + layers[1]["poissons_ratio"]) / 2,
                "thickness": layers[0]["thickness"] + layers[1]["thickness"],
            }
        )
    return pairs


def _mesh_of(
    loaded: OpenSimModel,
    force: RemovedComponent,
    meshes: dict[str, RemovedComponent],
    end: str,
) -> str:
    path = force.text(f"socket_{end}_mesh", "") or ""
    name = path.rsplit("/", 1)[-1]
    if name not in meshes:
        raise InputDataError(
            f"{loaded.file}: {CONTACT_FORCE} {force.name}: socket_{end}_mesh is '{path}': "
            f"no {CONTACT_MESH} of that name (there are: {', '.join(meshes) or 'none'})"
        )
    return name


def _number(mesh: RemovedComponent, key: str) -> float:
    return float(mesh.text(key) or _DEFAULTS[key])
