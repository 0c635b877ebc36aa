# SPDX-License-Identifier: Apache-2.0
"""Which coordinates a simulation solves for, and whose load muscles carry."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from typing import Any

from condyle.errors import InputDataError


def assign_roles(
    model: dict[str, Any],
    force_dependent: Sequence[str] = (),
    muscles: Sequence[str] | None = None,
) -> None:
    """Sets ``role`` and ``balanced_by`` of a model's coordinates.

    Args:
        model: Content of a model file; its coordinates are changed.
        force_dependent: Names or patterns (``knee_t?_r``) of the coordinates to be solved for. The
            equilibrium itself balances them: no muscle's share is asked for.
        muscles: Names or patterns of the coordinates that muscles balance. None: the rotational
            coordinates that a muscle's path crosses and that are neither locked, nor coupled to
            another, nor force-dependent.

    Raises:
        InputDataError: A pattern fits no coordinate.
    """
    names = [coordinate["name"] for coordinate in model["coordinates"]]
    solved = _fitting(names, force_dependent, "force-dependent coordinates")
    if muscles is None:
        dependent = {coupling["dependent"] for coupling in model.get("couplings", [])}
        crossed = crossed_coordinates(model)
        balanced = {
            coordinate["name"]
            for coordinate in model["coordinates"]
            if coordinate["name"] in crossed - dependent - solved
            and coordinate["motion"] == "rotational"
            and not coordinate["locked"]
        }
    else:
        balanced = _fitting(names, muscles, "coordinates that muscles balance")
        if both := sorted(balanced & solved):
            raise InputDataError(
                f"{', '.join(both)}: force-dependent and balanced by muscles: must be one of the two"
            )
    for coordinate in model["coordinates"]:
        name = coordinate["name"]
        coordinate["role"] = "force_dependent" if name in solved else "driven"
        coordinate["balanced_by"] = "muscles" if name in balanced else "reaction"


def crossed_coordinates(model: dict[str, Any]) -> set[str]:
    """Coordinates that move some bodies of a muscle's path against others of it."""
    joints = {joint["child"]["body"]: joint for joint in model["joints"]}
    crossed: set[str] = set()
    for muscle in model["muscles"]:
        chains = [_joints_to(point["body"], joints) for point in muscle["path"]["points"]]
        shared = set.intersection(*chains)
        for body in set.union(*chains) - shared:
            crossed |= _coordinates_of(joints[body])
    return crossed


def _joints_to(body: str, joints: dict[str, Any]) -> set[str]:
    """Bodies whose joints stand between a body and ground."""
    chain: set[str] = set()
    while body in joints and body not in chain:
        chain.add(body)
        body = joints[body]["parent"]["body"]
    return chain


def _coordinates_of(joint: dict[str, Any]) -> set[str]:
    axes = [*joint["rotations"], *joint["translations"]]
    return {term["coordinate"] for axis in axes for term in axis["terms"]}


def _fitting(names: Sequence[str], patterns: Iterable[str], what: str) -> set[str]:
    chosen: set[str] = set()
    for pattern in patterns:
        fits = {name for name in names if fnmatchcase(name, pattern)}
        if not fits:
            raise InputDataError(
                f"{what}: '{pattern}' fits none of the model's coordinates: {', '.join(names)}"
            )
        chosen |= fits
    return chosen
