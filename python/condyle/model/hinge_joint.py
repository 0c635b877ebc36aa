# SPDX-License-Identifier: Apache-2.0
"""A joint of six coordinates turned into a hinge, in a model file's own terms.

The hinge is exact: a frame on its axis in the parent, one in the child, and one rotation between them. One of the six
coordinates, the one that turns most about the axis, becomes that rotation and is at its default where the child is at
rest. The five others stay in the model, so that motions and results have the same columns as before: they follow the
first by splines, which say where the hinge has put the child in the terms of the joint that was, and move nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle._core.model import Kinematics
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel

Array = NDArray[np.float64]
Content = dict[str, Any]

_COORDINATES: Final = 6
#: Turns from rest at which the splines have knots [rad]: 1e-7 m and rad lie between them.
_KNOTS: Final = np.radians(np.arange(-60.0, 151.0, 5.0))
#: A coordinate that turns less than this about the axis, of what it turns, is no hinge's [-].
_LEAST_COSINE: Final = 0.8
_STEP: Final = 1e-5  # of central differences [rad, m]
_MAX_NEWTON: Final = 30
_SOLVED: Final = 1e-10  # [rad, m]


@dataclass(frozen=True)
class Hinge:
    """An axis fixed in the parent, and where the child is at rest.

    Attributes:
        X_BH: (4, 4) frame in the parent's body; z is the axis.
        X_BC: (4, 4) the child's body in the parent's, at rest.
    """

    X_BH: Array
    X_BC: Array

    def turned(self, angle: float) -> Array:
        """(4, 4) the child's body in the parent's after a turn about z [rad]."""
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        return self.X_BH @ turn @ np.linalg.inv(self.X_BH) @ self.X_BC


@dataclass(frozen=True)
class HingeCoordinates:
    """What became of a joint's coordinates.

    Attributes:
        turn: the one that turns about the hinge.
        followers: the five that follow it.
    """

    turn: str
    followers: tuple[str, ...]


def joint_of(content: Content, child: str) -> Content:
    """The joint that a body hangs on.

    Raises:
        InputDataError: it is ground, which hangs on nothing.
    """
    for joint in content["joints"]:
        if joint["child"]["body"] == child:
            found: Content = joint
            return found
    raise InputDataError(f"model {content['name']!r}: {child!r} hangs on no joint")


def joint_coordinates(content: Content, joint: Content) -> tuple[str, ...]:
    """Names of the joint's six coordinates, all of them force-dependent and its own.

    Raises:
        InputDataError: there are fewer, or one is driven, coupled or moves another joint.
    """
    where = f"model {content['name']!r}, joint {joint['name']!r}"
    names = _moved_by(joint)
    if len(names) != _COORDINATES:
        raise InputDataError(
            f"{where} has {len(names)} coordinates ({', '.join(names) or 'none'}): must be {_COORDINATES}"
        )
    coordinates = {coordinate["name"]: coordinate for coordinate in content["coordinates"]}
    dependents = {coupling["dependent"] for coupling in content.get("couplings", [])}
    for name in names:
        role = coordinates[name].get("role", "driven")
        if role != "force_dependent":
            raise InputDataError(
                f"{where}: coordinate {name!r} is {role}: must be force_dependent, as a patella's is that is found "
                "from its forces"
            )
        if name in dependents:
            raise InputDataError(f"{where}: coordinate {name!r} follows another: must be free")
        for other in content["joints"]:
            if other is not joint and name in _moved_by(other):
                raise InputDataError(
                    f"{where}: coordinate {name!r} moves joint {other['name']!r}, too: must be of one joint"
                )
    return names


def _moved_by(joint: Content) -> tuple[str, ...]:
    axes = [*joint.get("rotations", []), *joint.get("translations", [])]
    terms = [term["coordinate"] for axis in axes for term in axis.get("terms", [])]
    return tuple(dict.fromkeys(terms))


def make_hinge(
    model: MusculoskeletalModel, content: Content, joint: Content, hinge: Hinge
) -> HingeCoordinates:
    """Puts a hinge into a model file's content in place of a joint of six coordinates.

    Args:
        model: as compiled from ``content``.
        content: is changed.
        joint: of it, with the coordinates of :func:`joint_coordinates`.
        hinge: its parent's and child's bodies are the joint's.

    Raises:
        InputDataError: none of the coordinates turns about the axis, or together they do not reach the hinge's poses.
    """
    names = joint_coordinates(content, joint)
    relative = _Relative(model, joint["parent"]["body"], joint["child"]["body"], names)
    turn, sense = _turn(
        relative, names, hinge, f"model {content['name']!r}, joint {joint['name']!r}"
    )
    rest = float(model.default_q()[model.coordinate(turn)])
    followers = tuple(name for name in names if name != turn)
    tables = _follow(relative, hinge, sense, joint["name"])
    coordinates = {coordinate["name"]: coordinate for coordinate in content["coordinates"]}
    at_rest = int(np.flatnonzero(_KNOTS == 0.0)[0])
    for name in followers:
        values = tables[:, names.index(name)]
        coordinates[name] |= {
            "role": "driven", "balanced_by": "reaction", "default": float(values[at_rest]),
        }  # fmt: skip
        function = {"kind": "simm_spline", "x": (rest + _KNOTS).tolist(), "y": values.tolist()}
        coupling = {"dependent": name, "independent": turn, "function": function}
        content.setdefault("couplings", []).append(coupling)
    linear = {"kind": "linear", "slope": sense, "intercept": -sense * rest}
    joint["parent"] = frame_of(joint["parent"]["body"], hinge.X_BH)
    joint["child"] = frame_of(joint["child"]["body"], np.linalg.inv(hinge.X_BC) @ hinge.X_BH)
    joint["rotations"] = [
        {"axis": [0, 0, 1], "terms": [{"coordinate": turn, "function": linear}]},
        {"axis": [1, 0, 0]},
        {"axis": [0, 1, 0]},
    ]
    joint.pop("translations", None)
    return HingeCoordinates(turn, followers)


def frame_of(body: str, X: Array) -> Content:
    """A frame of a model file: body-fixed x-y-z angles, R = Rx·Ry·Rz."""
    R = X[:3, :3]
    angles = [
        np.arctan2(-R[1, 2], R[2, 2]),
        np.arcsin(np.clip(R[0, 2], -1.0, 1.0)),
        np.arctan2(-R[0, 1], R[0, 0]),
    ]
    return {
        "body": body,
        "translation": [float(value) for value in X[:3, 3]],
        "orientation_xyz": [float(value) for value in angles],
    }


class _Relative:
    """Where a joint's child is in its parent, by the joint's coordinates."""

    def __init__(
        self, model: MusculoskeletalModel, parent: str, child: str, names: tuple[str, ...]
    ) -> None:
        self._model = model
        self._parent, self._child = (placement_index(model, body) for body in (parent, child))
        self._columns = [model.coordinate(name) for name in names]
        self.default: Array = model.default_q()[self._columns]

    def at(self, values: Array) -> Array:
        """(4, 4) of the child's body in the parent's."""
        q = self._model.default_q()
        q[self._columns] = values
        return relative_placement(self._model, q, self._parent, self._child)

    def jacobian(self, values: Array) -> Array:
        """(6, n) displacement [m] and turn [rad] in the parent, per unit of each coordinate."""
        columns = []
        for unit in np.eye(len(values)):
            before, after = self.at(values - _STEP * unit), self.at(values + _STEP * unit)
            columns.append(_difference(before, after) / (2.0 * _STEP))
        return np.stack(columns, axis=1)


def placement_index(model: MusculoskeletalModel, body: str) -> int:
    """Index of a body; −1: ground."""
    return -1 if body == "ground" else model.body(body)


def relative_placement(model: MusculoskeletalModel, q: Array, parent: int, child: int) -> Array:
    """(4, 4) of one body in another, by :func:`placement_index`, at coordinates (n,) [rad, m]."""
    X = np.asarray(Kinematics(model.core, np.ascontiguousarray(q)).body_placements)
    X_GB = np.eye(4) if parent < 0 else X[parent]
    return np.asarray(np.linalg.inv(X_GB) @ X[child])


def _difference(before: Array, after: Array) -> Array:
    """(6,) from one placement to another: displacement, and rotation vector of a small turn."""
    R = after[:3, :3] @ before[:3, :3].T
    skew = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return np.concatenate([after[:3, 3] - before[:3, 3], 0.5 * skew])


def _turn(
    relative: _Relative, names: tuple[str, ...], hinge: Hinge, where: str
) -> tuple[str, float]:
    """The coordinate that turns most about the axis, and its sense about it."""
    turns = relative.jacobian(relative.default)[3:]
    about = hinge.X_BH[:3, 2] @ turns
    best = int(np.argmax(np.abs(about)))
    if abs(about[best]) < _LEAST_COSINE:
        raise InputDataError(
            f"{where}: no coordinate turns about the hinge's axis: {names[best]!r} does most, {abs(about[best]):.3g} "
            f"of its turn: must be at least {_LEAST_COSINE:g}"
        )
    return names[best], float(np.sign(about[best]))


def _follow(relative: _Relative, hinge: Hinge, sense: float, joint: str) -> Array:
    """(knots, 6) the joint's coordinates where the hinge has the child."""
    table = np.empty((len(_KNOTS), _COORDINATES))
    middle = int(np.flatnonzero(_KNOTS == 0.0)[0])
    for order in (range(middle, len(_KNOTS)), range(middle - 1, -1, -1)):
        for knot in order:
            near = table[knot - 1 if knot > middle else knot + 1]
            values = relative.default.copy() if knot == middle else near.copy()
            target = hinge.turned(sense * _KNOTS[knot])
            for _ in range(_MAX_NEWTON):
                left = _difference(relative.at(values), target)
                if np.abs(left).max() < _SOLVED:
                    break
                values += np.linalg.lstsq(relative.jacobian(values), left, rcond=None)[0]
            else:
                raise InputDataError(
                    f"joint {joint!r}: its coordinates do not reach the hinge's pose at a turn of "
                    f"{np.degrees(_KNOTS[knot]):g}°"
                )
            table[knot] = values
    return table
