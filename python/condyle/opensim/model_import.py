# SPDX-License-Identifier: Apache-2.0
"""An .osim model as Condyle's model file."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from condyle.opensim.contact import describe_contact_pairs, describe_contact_surfaces
from condyle.opensim.coordinates import describe_coordinates, describe_couplings
from condyle.opensim.document import CONTACT_FORCE, CONTACT_MESH
from condyle.opensim.findings import Findings
from condyle.opensim.forces import describe_forces
from condyle.opensim.frames import point_in_body, vector
from condyle.opensim.joints import describe_joints
from condyle.opensim.library import OpenSimModel, load_model, opensim_library
from condyle.opensim.paths import describe_wraps
from condyle.opensim.roles import assign_roles
from condyle.whole_files import write_whole

#: Sets of a model that are described elsewhere in this package, by where they stand in it.
_DESCRIBED: Final = (
    "bodyset",
    "jointset",
    "constraintset",
    "forceset",
    "markerset",
    "ground",
)
#: What needs no counterpart: containers, and axes that are drawn.
_NOTHING: Final = {
    "FrameGeometry",
    "WrapObjectSet",
    "PhysicalOffsetFrame",
    "ComponentSet",
    "ContactGeometrySet",
    "ControllerSet",
    "ProbeSet",
}


def import_model(
    file: Path,
    *,
    force_dependent: Sequence[str] = (),
    muscles: Sequence[str] | None = None,
) -> dict[str, Any]:
    """Reads an OpenSim model as the content of a model file (docs/opensim.md).

    Args:
        file: .osim, of any version that OpenSim upgrades, OpenSim-JAM's contact included.
        force_dependent: Names or patterns of the coordinates to be solved for.
        muscles: Names or patterns of the coordinates that muscles balance; None: those of
            :func:`condyle.opensim.roles.assign_roles`.

    Returns:
        The model in SI and radians; whatever did not fit is in ``not_supported``, in words.

    Raises:
        InputDataError: No such file, not a model, or one that OpenSim refuses; a pattern that
            fits no coordinate; the package ``opensim`` is not installed.
    """
    loaded = load_model(file)
    model = describe_model(loaded)
    assign_roles(model, force_dependent, muscles)
    return model


def describe_model(loaded: OpenSimModel) -> dict[str, Any]:
    """As :func:`import_model`, of a model that is loaded; every coordinate driven by a reaction."""
    findings = Findings()
    joints = describe_joints(loaded, findings)
    axes = [axis for joint in joints for axis in [*joint["rotations"], *joint["translations"]]]
    used = {term["coordinate"] for axis in axes for term in axis["terms"]}
    wraps, names = describe_wraps(loaded, findings)
    forces = describe_forces(loaded, names, used, findings)
    model = {
        "format": "condyle-model",
        "version": 1,
        "name": loaded.model.getName(),
        "source": loaded.file.name,
        "gravity": vector(loaded.model.get_gravity()),
        "bodies": [_describe_body(body, findings) for body in loaded.model.getBodySet()],
        "joints": joints,
        "coordinates": describe_coordinates(loaded, used, findings),
        "couplings": describe_couplings(loaded, used, findings),
        "springs": forces.springs,
        "wraps": wraps,
        "muscles": forces.muscles,
        "ligaments": forces.ligaments,
        "markers": [_describe_marker(marker) for marker in loaded.model.getMarkerSet()],
        "contact_surfaces": describe_contact_surfaces(loaded, findings),
        "contact_pairs": describe_contact_pairs(loaded, findings),
    }
    _find_the_rest(loaded, findings)
    return model | {"not_supported": findings.sentences()}


def write_model(file: Path, model: dict[str, Any]) -> None:
    """Writes a model file: JSON, a list of numbers on one line."""
    write_whole(file, to_text(model))


def to_text(content: dict[str, Any]) -> str:
    """JSON with indents, where a list of plain numbers, or strings, stays on one line."""
    text = json.dumps(content, ensure_ascii=False, allow_nan=False, indent=1)
    return re.sub(r"\[\n[^][{}]*\]", lambda found: _on_one_line(found.group()), text) + "\n"


def summary(model: dict[str, Any]) -> str:
    """What a model holds, in one line."""
    words = {"muscles": "muscles", "ligaments": "ligament strands", "wraps": "wrapping surfaces"}
    lists = [
        "bodies", "joints", "coordinates", "couplings", "springs", "muscles", "ligaments", "wraps",
        "markers", "contact_surfaces", "contact_pairs",
    ]  # fmt: skip
    return ", ".join(f"{len(model[k])} {words.get(k, k.replace('_', ' '))}" for k in lists)


def _on_one_line(text: str) -> str:
    return re.sub(r"\n\s*", " ", text).replace("[ ", "[").replace(" ]", "]")


def _describe_body(body: Any, findings: Findings) -> dict[str, Any]:
    inertia = body.get_inertia()
    return {
        "name": body.getName(),
        "mass": body.getMass(),
        "mass_centre": vector(body.getMassCenter()),
        "inertia": [float(inertia.get(i)) for i in range(6)],
        "meshes": _meshes(body, findings),
    }


def _meshes(body: Any, findings: Findings) -> list[str]:
    library = opensim_library()
    files = []
    for i in range(body.getPropertyByName("attached_geometry").size()):
        geometry = body.get_attached_geometry(i)
        mesh = library.Mesh.safeDownCast(geometry)
        if mesh is None:
            kind = geometry.getConcreteClassName()
            findings.add(f"pictures of class {kind}", body.getName())
            continue
        files.append(mesh.get_mesh_file())
        if vector(mesh.get_scale_factors()) != [1.0, 1.0, 1.0]:
            findings.add("scale factors of bodies' pictures (drawn unscaled)", body.getName())
    return files


def _describe_marker(marker: Any) -> dict[str, Any]:
    body, location = point_in_body(marker.getParentFrame(), marker.get_location())
    return {"name": marker.getName(), "body": body, "location": location}


def _find_the_rest(loaded: OpenSimModel, findings: Findings) -> None:
    """Components that nothing above has looked at, by class: pictures on frames, controllers and so on."""
    library = opensim_library()
    for component in loaded.model.getComponentsList():
        kind = component.getConcreteClassName()
        path = component.getAbsolutePathString()
        top = path.split("/")[1]
        if library.Geometry.safeDownCast(component) is not None and kind not in _NOTHING:
            if len(path.split("/")) != 4 or top != "bodyset":
                where = path.rsplit("/", 2)[-2]
                findings.add("pictures on a frame or on ground", where)
            continue
        looked_at = top in _DESCRIBED or library.Force.safeDownCast(component) is not None
        if not looked_at and kind not in _NOTHING:
            findings.add(f"components of class {kind}", component.getName())
    for removed in loaded.document.removed:
        if removed.class_name not in (CONTACT_MESH, CONTACT_FORCE):
            reason = f"components of class {removed.class_name}, which this OpenSim does not know"
            findings.add(reason, removed.name)
