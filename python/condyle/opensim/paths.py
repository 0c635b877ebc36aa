# SPDX-License-Identifier: Apache-2.0
"""Paths over bodies: fixed, conditional and moving points, and the surfaces they go around."""

from __future__ import annotations

from typing import Any

from condyle.opensim.findings import Findings
from condyle.opensim.frames import compose, point_in_body, rotation_matrix, vector
from condyle.opensim.functions import NotRepresentable, to_sum
from condyle.opensim.library import OpenSimModel, opensim_library

_KINDS = {
    "WrapCylinder": "cylinder",
    "WrapEllipsoid": "ellipsoid",
    "WrapSphere": "sphere",
    "WrapTorus": "torus",
}


class WrapNames:
    """Names of wrapping surfaces that are unique in a model, by their path in it.

    OpenSim's are unique within a body: a name that came before gets its body in front.
    """

    def __init__(self) -> None:
        self._by_path: dict[str, str] = {}

    def add(self, wrap: Any) -> str:
        """Takes a surface up; returns its name."""
        name = wrap.getName()
        if name in self._by_path.values():
            name = f"{wrap.getFrame().findBaseFrame().getName()}/{name}"
        return self._by_path.setdefault(wrap.getAbsolutePathString(), name)

    def get(self, wrap: Any) -> str | None:
        """The name of a surface, None of one that is left out."""
        return self._by_path.get(wrap.getAbsolutePathString()) if wrap is not None else None


def describe_wraps(
    loaded: OpenSimModel, findings: Findings
) -> tuple[list[dict[str, Any]], WrapNames]:
    """All wrapping surfaces of a model."""
    library = opensim_library()
    names, wraps = WrapNames(), []
    for component in loaded.model.getComponentsList():
        wrap = library.WrapObject.safeDownCast(component)
        if wrap is None:
            continue
        kind = _KINDS.get(wrap.getConcreteClassName())
        if kind is None:
            reason = f"wrapping surfaces of class {wrap.getConcreteClassName()}"
            findings.add(reason, wrap.getName())
            continue
        quadrant = str(wrap.get_quadrant()).strip().lower().lstrip("+")
        wraps.append(
            {
                "name": names.add(wrap),
                "kind": kind,
                "frame": compose(wrap.getFrame(), wrap.getTransform()),
                **_dimensions(kind, getattr(library, wrap.getConcreteClassName()), wrap),
                "quadrant": "all" if quadrant in ("", "unassigned") else quadrant,
                "active": bool(wrap.get_active()),
            }
        )
    return wraps, names


def _dimensions(kind: str, class_: Any, wrap: Any) -> dict[str, Any]:
    shape = class_.safeDownCast(wrap)
    if kind == "cylinder":
        return {"radius": shape.get_radius(), "length": shape.get_length()}
    if kind == "ellipsoid":
        return {"semi_axes": vector(shape.get_dimensions())}
    if kind == "sphere":
        return {"radius": shape.get_radius()}
    return {"inner_radius": shape.get_inner_radius(), "outer_radius": shape.get_outer_radius()}


def describe_path(
    owner: str, path: Any, names: WrapNames, state: Any, findings: Findings
) -> dict[str, Any]:
    """A GeometryPath.

    Args:
        owner: Name of the muscle or ligament, for findings.
        path: ``opensim.GeometryPath``.
        names: Names of the surfaces.
        state: The default state: where a moving point stands whose functions do not fit.
        findings: What is left out.
    """
    points = path.getPathPointSet()
    wraps = path.getWrapSet()
    described: dict[str, Any] = {
        "points": [
            _describe_point(owner, points.get(i), state, findings) for i in range(points.getSize())
        ]
    }
    list_ = []
    for i in range(wraps.getSize()):
        wrap = wraps.get(i)
        name = names.get(wrap.getWrapObject())
        if name is None:
            findings.add("wrapping of a path around a surface that is left out", owner)
            continue
        # OpenSim counts points from 1; -1 is an end in both.
        first, last = wrap.get_range(0), wrap.get_range(1)
        list_.append(
            {
                "wrap": name,
                "method": wrap.getMethodName().lower(),
                "first_point": first - 1 if first >= 1 else -1,
                "last_point": last - 1 if last >= 1 else -1,
            }
        )
    return described | ({"wraps": list_} if list_ else {})


def _describe_point(owner: str, point: Any, state: Any, findings: Findings) -> dict[str, Any]:
    library = opensim_library()
    kind = point.getConcreteClassName()
    if kind == "MovingPathPoint":
        moving = library.MovingPathPoint.safeDownCast(point)
        return _moving_point(owner, moving, state, findings)
    body, location = point_in_body(point.getParentFrame(), point.getLocation(state))
    described: dict[str, Any] = {"body": body, "location": location}
    if kind == "ConditionalPathPoint":
        conditional = library.ConditionalPathPoint.safeDownCast(point)
        described["condition"] = {
            "coordinate": conditional.getCoordinate().getName(),
            "min": conditional.get_range(0),
            "max": conditional.get_range(1),
        }
    elif kind != "PathPoint":
        findings.add(
            f"path points of class {kind} (held to their body)", f"{owner} {point.getName()}"
        )
    return described


def _moving_point(owner: str, point: Any, state: Any, findings: Findings) -> dict[str, Any]:
    """A place plus Σ terms per component, in the body: an offset frame's rotation mixes components."""
    sums = []
    for axis in "xyz":
        function = getattr(point, f"get_{axis}_location")()
        has = getattr(point, f"has{axis.upper()}Coordinate")()
        names = [getattr(point, f"get{axis.upper()}Coordinate")().getName()] if has else []
        try:
            sums.append(to_sum(function, names))
        except NotRepresentable as what:
            findings.add(
                "moving path points whose function a model file has no kind for (held to their "
                "body where they stand in the default pose)",
                f"{owner} {point.getName()} ({what})",
            )
            body, location = point_in_body(point.getParentFrame(), point.getLocation(state))
            return {"body": body, "location": location}
    findings.add(
        "moving path points beyond their coordinate's range (OpenSim holds them at its end, "
        "a model file lets them go on)",
        f"{owner} {point.getName()}",
    )
    frame = point.getParentFrame()
    library = opensim_library()
    body, location = point_in_body(frame, library.Vec3(*(each.constant for each in sums)))
    X = frame.findTransformInBaseFrame()  # a name of its own: R() is a view into it
    R = rotation_matrix(X.R())
    moving = {
        axis: [
            term
            for j in range(3)
            if R[i, j] != 0.0
            for term in sums[j].scaled(float(R[i, j])).terms
        ]
        for i, axis in enumerate("xyz")
    }
    return {"body": body, "location": location, "moving": moving}
