# SPDX-License-Identifier: Apache-2.0
"""Puts an OpenSim model into the postures of a recorded motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from condyle.errors import InputDataError
from condyle.opensim.library import OpenSimModel, opensim_library
from condyle.opensim.motion import Motion

Array = npt.NDArray[np.float64]


class Postures:
    """Sets a model's coordinates from the columns of a motion.

    Coordinates without a column stay at their default; one that is coupled to another and has no
    column follows it.
    """

    def __init__(self, loaded: OpenSimModel, motion: Motion) -> None:
        """Checks the motion's columns.

        Raises:
            InputDataError: The motion and the model share no coordinate, or the motion has a column
                that the model does not know.
        """
        library = opensim_library()
        self._loaded = loaded
        coordinates = {c.getName(): c for c in loaded.model.getCoordinateSet()}
        if unknown := [name for name in motion.names if name not in coordinates]:
            raise InputDataError(
                f"{motion.source}: column {', '.join(unknown)}: no coordinate of "
                f"{loaded.file.name} (it has: {', '.join(coordinates)})"
            )
        self._columns = [coordinates[name] for name in motion.names]
        self._values = motion.values.copy()
        turning = [c.getMotionType() == library.Coordinate.Rotational for c in self._columns]
        if motion.in_degrees:
            self._values[:, turning] = np.deg2rad(self._values[:, turning])
        self._couplers = [
            (coordinates[name], follow)
            for name, follow in _couplers(loaded, coordinates).items()
            if name not in motion.names
        ]
        for coordinate in coordinates.values():
            coordinate.setLocked(loaded.state, False)

    @property
    def n(self) -> int:
        """Number of time frames."""
        return len(self._values)

    def set(self, frame: int) -> Any:
        """Sets the state to a time frame and realizes positions; returns the state."""
        state = self._loaded.state
        # False: as they are, neither clamped nor assembled.
        for coordinate, value in zip(self._columns, self._values[frame], strict=True):
            coordinate.setValue(state, float(value), False)
        for coordinate, follow in self._couplers:
            coordinate.setValue(state, follow(state), False)
        self._loaded.model.realizePosition(state)
        return state


def _couplers(loaded: OpenSimModel, coordinates: dict[str, Any]) -> dict[str, Any]:
    """For each coordinate that a coupler sets: the function of the state that gives its value."""
    library = opensim_library()
    followers: dict[str, Any] = {}
    for constraint in loaded.model.getConstraintSet():
        coupler = library.CoordinateCouplerConstraint.safeDownCast(constraint)
        if coupler is None or not constraint.get_isEnforced():
            continue
        names = coupler.getIndependentCoordinateNames()
        independents = [coordinates[names.get(i)] for i in range(names.getSize())]
        scale = float(coupler.getPropertyByName("scale_factor").toString())
        function = coupler.getFunction()

        def follow(
            state: Any, q: list[Any] = independents, f: Any = function, k: float = scale
        ) -> float:
            arguments = library.Vector(len(q), 0.0)
            for i, coordinate in enumerate(q):
                arguments.set(i, coordinate.getValue(state))
            return k * float(f.calcValue(arguments))

        followers[coupler.getDependentCoordinateName()] = follow
    return followers
