# SPDX-License-Identifier: Apache-2.0
"""Coordinates, their couplings and springs."""

from __future__ import annotations

from typing import Any

from condyle.opensim.findings import Findings
from condyle.opensim.functions import NotRepresentable, scaled_function, to_function
from condyle.opensim.library import OpenSimModel, opensim_library

_LEFT_OUT = "(their coordinate is left out)"


def describe_coordinates(
    loaded: OpenSimModel, used: set[str], findings: Findings
) -> list[dict[str, Any]]:
    """The coordinates that an axis of a joint depends on; all driven, balanced by a reaction.

    Args:
        loaded: The model.
        used: Names of coordinates in joints that are described.
        findings: What is left out.
    """
    library = opensim_library()
    coordinates = []
    for coordinate in loaded.model.getCoordinateSet():
        name = coordinate.getName()
        if name not in used:
            findings.add("coordinates that move no joint of the model file", name)
            continue
        if coordinate.getDefaultIsPrescribed():
            findings.add("coordinates prescribed over time (free here; a trial gives them)", name)
        motion = coordinate.getMotionType()
        if motion not in (library.Coordinate.Rotational, library.Coordinate.Translational):
            findings.add("coordinates of a coupled motion type (taken as rotational)", name)
        is_shift = motion == library.Coordinate.Translational
        coordinates.append(
            {
                "name": name,
                "motion": "translational" if is_shift else "rotational",
                "default": coordinate.getDefaultValue(),
                "range": [coordinate.getRangeMin(), coordinate.getRangeMax()],
                "locked": coordinate.getDefaultLocked(),
                "role": "driven",
                "balanced_by": "reaction",
            }
        )
    return coordinates


def describe_couplings(
    loaded: OpenSimModel, used: set[str], findings: Findings
) -> list[dict[str, Any]]:
    """CoordinateCouplerConstraints of one coordinate; any other constraint is a finding."""
    couplings = []
    for constraint in loaded.model.getConstraintSet():
        name, kind = constraint.getName(), constraint.getConcreteClassName()
        if not constraint.get_isEnforced():
            findings.add("constraints that are not enforced", name)
        elif kind != "CoordinateCouplerConstraint":
            findings.add(f"constraints of class {kind}", name)
        else:
            coupling = _coupling(constraint, used, findings)
            couplings += [coupling] if coupling else []
    return couplings


def _coupling(constraint: Any, used: set[str], findings: Findings) -> dict[str, Any] | None:
    coupler = opensim_library().CoordinateCouplerConstraint.safeDownCast(constraint)
    names = coupler.getIndependentCoordinateNames()
    independents = [names.get(i) for i in range(names.getSize())]
    dependent = coupler.getDependentCoordinateName()
    if len(independents) != 1:
        findings.add("couplings to several coordinates", constraint.getName())
        return None
    if not {dependent, *independents} <= used:
        findings.add(f"couplings {_LEFT_OUT}", constraint.getName())
        return None
    try:
        scale = float(coupler.getPropertyByName("scale_factor").toString())
        function = scaled_function(to_function(coupler.getFunction()), scale)
    except NotRepresentable as what:
        reason = "couplings whose function a model file has no kind for"
        findings.add(reason, f"{constraint.getName()} ({what})")
        return None
    return {"dependent": dependent, "independent": independents[0], "function": function}


def describe_spring(force: Any, used: set[str], findings: Findings) -> dict[str, Any] | None:
    """A SpringGeneralizedForce; None, and a finding, where its coordinate is left out."""
    spring = opensim_library().SpringGeneralizedForce.safeDownCast(force)
    if spring.get_coordinate() not in used:
        findings.add(f"springs {_LEFT_OUT}", force.getName())
        return None
    return {
        "coordinate": spring.get_coordinate(),
        "stiffness": spring.getStiffness(),
        "rest": spring.getRestLength(),
        "viscosity": spring.getViscosity(),
    }
