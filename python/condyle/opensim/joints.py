# SPDX-License-Identifier: Apache-2.0
"""Joints of OpenSim as six axes: three body-fixed rotations after three translations of the parent frame.

Ball and free joints have quaternions inside OpenSim; their coordinates, which is what a model and a
trial are written in, are the body-fixed x-y-z angles. Source: Seth, Sherman, Eastman & Delp 2010,
Multibody Syst Dyn 23:295–318.
"""

from __future__ import annotations

from typing import Any, Final

from condyle.errors import InputDataError
from condyle.opensim.findings import Findings
from condyle.opensim.frames import compose, frame_in_body, vector
from condyle.opensim.functions import NotRepresentable, Sum, to_sum
from condyle.opensim.library import OpenSimModel, opensim_library

_UNIT: Final = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
#: Which coordinate turns about x, y, z and shifts along x, y, z, by class of joint.
_PLAIN_JOINTS: Final[dict[str, tuple[int | None, ...]]] = {
    "WeldJoint": (None, None, None, None, None, None),
    "PinJoint": (None, None, 0, None, None, None),
    "SliderJoint": (None, None, None, 0, None, None),
    "UniversalJoint": (0, 1, None, None, None, None),
    "PlanarJoint": (None, None, 0, 1, 2, None),
    "BallJoint": (0, 1, 2, None, None, None),
    "GimbalJoint": (0, 1, 2, None, None, None),
    "FreeJoint": (0, 1, 2, 3, 4, 5),
}


def describe_joints(loaded: OpenSimModel, findings: Findings) -> list[dict[str, Any]]:
    """The joints that hang every body on the tree; one that closes a loop is a finding.

    Raises:
        InputDataError: A joint has ground as its child.
    """
    joints, hung = [], set()
    for joint in loaded.model.getJointList():
        child = joint.getChildFrame().findBaseFrame().getName()
        if child == "ground":
            raise InputDataError(
                f"{loaded.file}: joint {joint.getName()}: its child is ground: "
                "swap parent and child (the tree begins at ground)"
            )
        if child in hung:
            findings.add("joints that close a loop of bodies", joint.getName())
            continue
        hung.add(child)
        joints.append(_describe(loaded, joint, findings))
    return joints


def joint_coordinates(joint: Any) -> list[str]:
    """Names of a joint's coordinates, in its order."""
    return [joint.get_coordinates(i).getName() for i in range(joint.numCoordinates())]


def _describe(loaded: OpenSimModel, joint: Any, findings: Findings) -> dict[str, Any]:
    kind = joint.getConcreteClassName()
    parent = frame_in_body(joint.getParentFrame())
    if kind == "CustomJoint":
        axes = _custom_axes(loaded, joint, findings)
    else:
        names = joint_coordinates(joint)
        if kind not in _PLAIN_JOINTS:
            reason = f"joints of class {kind} (welded in their default pose, coordinates left out)"
            findings.add(reason, " ".join([joint.getName(), *names]))
            parent = _default_pose(loaded, joint)
        axes = [
            _axis(_UNIT[i % 3], _identity(names[j]) if j is not None else Sum())
            for i, j in enumerate(_PLAIN_JOINTS.get(kind, (None,) * 6))
        ]
    return {
        "name": joint.getName(),
        "parent": parent,
        "child": frame_in_body(joint.getChildFrame()),
        "rotations": axes[:3],
        "translations": axes[3:],
    }


def _custom_axes(loaded: OpenSimModel, joint: Any, findings: Findings) -> list[dict[str, Any]]:
    transform = opensim_library().CustomJoint.safeDownCast(joint).getSpatialTransform()
    axes = []
    for i, label in enumerate(f"{what} {n}" for what in ("rotation", "translation") for n in "123"):
        axis = transform.getTransformAxis(i)
        names = axis.getCoordinateNamesInArray()
        coordinates = [names.get(k) for k in range(names.getSize())]
        amount = Sum()
        if axis.hasFunction():
            try:
                amount = to_sum(axis.getFunction(), coordinates)
            except NotRepresentable as what:
                findings.add(
                    "joint axes whose function a model file has no kind for (held at their value "
                    "in the default pose)",
                    f"{joint.getName()} {label} ({what})",
                )
                amount = Sum(constant=axis.getValue(loaded.state))
        axes.append(_axis(vector(axis.getAxis()), amount))
    return axes


def _identity(coordinate: str) -> Sum:
    function = {"kind": "linear", "slope": 1.0, "intercept": 0.0}
    return Sum(terms=[{"coordinate": coordinate, "function": function}])


def _axis(direction: list[float], amount: Sum) -> dict[str, Any]:
    return {"axis": list(direction), "constant": amount.constant, "terms": amount.terms}


def _default_pose(loaded: OpenSimModel, joint: Any) -> dict[str, Any]:
    """Where the child frame stands in the parent's body in the default pose."""
    loaded.model.realizePosition(loaded.state)
    parent, child = joint.getParentFrame(), joint.getChildFrame()
    return compose(parent, child.findTransformBetween(loaded.state, parent))
