# SPDX-License-Identifier: Apache-2.0
"""Muscles, ligaments and springs; every other force is a finding by its class and name."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from condyle.opensim.coordinates import describe_spring
from condyle.opensim.findings import Findings
from condyle.opensim.library import OpenSimModel, opensim_library
from condyle.opensim.paths import WrapNames, describe_path


@dataclass
class Forces:
    """Lists of a model file."""

    muscles: list[dict[str, Any]] = field(default_factory=list)
    ligaments: list[dict[str, Any]] = field(default_factory=list)
    springs: list[dict[str, Any]] = field(default_factory=list)


def geometry_path(force: Any) -> Any:
    """The GeometryPath of a force, None where it has another kind of path or none."""
    library = opensim_library()
    if not force.hasProperty("path"):
        return None
    whole = library.Muscle.safeDownCast(force)
    if whole is None:  # a class that the library has a name for, or nothing
        typed = getattr(library, force.getConcreteClassName(), None)
        whole = typed.safeDownCast(force) if typed is not None else None
    return library.GeometryPath.safeDownCast(whole.getPath()) if whole is not None else None


def describe_forces(
    loaded: OpenSimModel, names: WrapNames, used: set[str], findings: Findings
) -> Forces:
    """All forces of a model.

    Args:
        loaded: The model.
        names: Names of wrapping surfaces.
        used: Names of the coordinates of the model file.
        findings: What is left out.
    """
    library = opensim_library()
    found = Forces()
    for component in loaded.model.getComponentsList():
        force = library.Force.safeDownCast(component)
        if force is None:
            continue
        kind, name = force.getConcreteClassName(), force.getName()
        muscle = library.Muscle.safeDownCast(force)
        if not force.get_appliesForce():
            findings.add("forces that are switched off (appliesForce)", f"{kind} {name}")
        elif kind == "SpringGeneralizedForce":
            spring = describe_spring(force, used, findings)
            found.springs += [spring] if spring else []
        elif muscle is None and kind not in ("Blankevoort1991Ligament", "PathSpring"):
            findings.add(f"forces of class {kind}", name)
        else:
            _describe_along_path(loaded, force, names, found, findings)
    return found


def _describe_along_path(
    loaded: OpenSimModel, force: Any, names: WrapNames, found: Forces, findings: Findings
) -> None:
    library = opensim_library()
    name, path = force.getName(), geometry_path(force)
    if path is None:
        findings.add("forces along a path that is not a GeometryPath", name)
        return
    described = describe_path(name, path, names, loaded.state, findings)
    muscle = library.Muscle.safeDownCast(force)
    if muscle is not None:
        found.muscles.append(_describe_muscle(muscle, findings) | {"path": described})
        return
    ligament = (
        _describe_blankevoort(library.Blankevoort1991Ligament.safeDownCast(force))
        if force.getConcreteClassName() == "Blankevoort1991Ligament"
        else _describe_path_spring(library.PathSpring.safeDownCast(force), findings)
    )
    found.ligaments.append({"name": name, **ligament, "path": described})


def _describe_muscle(muscle: Any, findings: Findings) -> dict[str, Any]:
    findings.add(
        f"{muscle.getConcreteClassName()}: activation dynamics, tendon compliance and the muscle's "
        "own curves (a model file holds a rigid tendon and Condyle's curves)",
        muscle.getName(),
    )
    return {
        "name": muscle.getName(),
        "max_isometric_force": muscle.getMaxIsometricForce(),
        "optimal_fibre_length": muscle.getOptimalFiberLength(),
        "tendon_slack_length": muscle.getTendonSlackLength(),
        "pennation_at_optimal": muscle.getPennationAngleAtOptimalFiberLength(),
        "max_contraction_velocity": muscle.getMaxContractionVelocity(),
    }


def _describe_blankevoort(ligament: Any) -> dict[str, Any]:
    return {
        "law": "blankevoort",
        "stiffness": ligament.get_linear_stiffness(),
        "slack_length": ligament.get_slack_length(),
        "transition_strain": ligament.get_transition_strain(),
        "damping": ligament.get_damping_coefficient(),
    }


def _describe_path_spring(spring: Any, findings: Findings) -> dict[str, Any]:
    if spring.getDissipation() != 0.0:
        findings.add("dissipation of path springs", spring.getName())
    return {
        "law": "linear",
        "stiffness": spring.getStiffness(),
        "slack_length": spring.getRestingLength(),
    }
