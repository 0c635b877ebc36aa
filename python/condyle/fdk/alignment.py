# SPDX-License-Identifier: Apache-2.0
"""Where a surgeon puts the implant's parts on the bones, in the words of a surgeon.

An :class:`Alignment` moves a component from where a model has it. Angles turn it about the origin of its mesh's frame,
in the order flexion or slope (z), varus (x), rotation (y), each about the axis that the ones before have left, as in
clinical kinematics (Grood and Suntay 1983); distances are along the frame's axes as they were. Words mean the same in
a right and in a left knee: a varus component tilts the leg below the knee inwards, an externally rotated one faces
outwards, ``lateral`` is away from the other knee.

    component   angle                positive
    femoral     varus                its medial condyle is higher: the leg turns into varus
                external rotation    its front turns outwards
                flexion              its front turns downwards: the leg is flexed when the components are not
    tibial      varus                its medial side is lower: the leg turns into varus
                external rotation    its front turns outwards
                posterior slope      its back is lower
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import SideOfBody, medial_direction
from condyle.errors import InputDataError
from condyle.fdk.body_contact import BodyContact
from condyle.fdk.joint_contacts import TIBIOFEMORAL

Array = NDArray[np.float64]

#: Beyond these it is no alignment of an implant any more.
_LIMITS: Final = {"deg": 20.0, "mm": 20.0}


@dataclass(frozen=True, kw_only=True)
class Alignment:
    """By how much the components are moved on their bones; nothing where not given.

    Attributes:
        femoral_varus_deg: of the femoral component; each within ±20°.
        femoral_external_rotation_deg: likewise.
        femoral_flexion_deg: likewise.
        femoral_anterior_mm: along x of its frame; each within ±20 mm.
        femoral_proximal_mm: along y.
        femoral_lateral_mm: along z or against it, by the side of the body.
        tibial_varus_deg: of the insert, with what holds it.
        tibial_external_rotation_deg: likewise.
        tibial_posterior_slope_deg: likewise.
        tibial_anterior_mm: along x of its frame.
        tibial_proximal_mm: along y.
        tibial_lateral_mm: along z or against it, by the side of the body.

    Raises:
        InputDataError: a value that is not finite or beyond its limit.
    """

    femoral_varus_deg: float = 0.0
    femoral_external_rotation_deg: float = 0.0
    femoral_flexion_deg: float = 0.0
    femoral_anterior_mm: float = 0.0
    femoral_proximal_mm: float = 0.0
    femoral_lateral_mm: float = 0.0
    tibial_varus_deg: float = 0.0
    tibial_external_rotation_deg: float = 0.0
    tibial_posterior_slope_deg: float = 0.0
    tibial_anterior_mm: float = 0.0
    tibial_proximal_mm: float = 0.0
    tibial_lateral_mm: float = 0.0

    def __post_init__(self) -> None:
        """Checks the values."""
        for field in fields(self):
            value, unit = getattr(self, field.name), field.name.rpartition("_")[2]
            if not (math.isfinite(value) and abs(value) <= _LIMITS[unit]):
                raise InputDataError(
                    f"alignment: {field.name} is {value:g}: must be within ±{_LIMITS[unit]:g}"
                )

    def femoral_motion(self, side_of_body: SideOfBody) -> Array:
        """(4, 4) where the femoral component's frame goes, in that frame as it was [m]."""
        medial = medial_direction(side_of_body)
        return _motion(
            flexion_z=-self.femoral_flexion_deg,
            varus_x=-medial * self.femoral_varus_deg,
            rotation_y=medial * self.femoral_external_rotation_deg,
            displacement_mm=(
                self.femoral_anterior_mm,
                self.femoral_proximal_mm,
                -medial * self.femoral_lateral_mm,
            ),
        )

    def tibial_motion(self, side_of_body: SideOfBody) -> Array:
        """(4, 4) likewise of the tibial component."""
        medial = medial_direction(side_of_body)
        return _motion(
            flexion_z=self.tibial_posterior_slope_deg,
            varus_x=medial * self.tibial_varus_deg,
            rotation_y=medial * self.tibial_external_rotation_deg,
            displacement_mm=(
                self.tibial_anterior_mm,
                self.tibial_proximal_mm,
                -medial * self.tibial_lateral_mm,
            ),
        )

    def sentence(self) -> str:
        """What is not 0, in words."""
        signs = {"deg": "°", "mm": " mm"}
        said = []
        for field in fields(self):
            words, _, unit = field.name.replace("_", " ").rpartition(" ")
            if (value := getattr(self, field.name)) != 0.0:
                said.append(f"{words} {value:g}{signs[unit]}")
        return ", ".join(said) or "as placed"


def alignment_grid(**values: Sequence[float]) -> tuple[Alignment, ...]:
    """Every combination of values, the last name's fastest.

    Args:
        values: by attribute of :class:`Alignment`.

    Raises:
        InputDataError: there is no such attribute, or as :class:`Alignment`.
    """
    known = [field.name for field in fields(Alignment)]
    for name in values:
        if name not in known:
            raise InputDataError(f"alignment has no {name!r}: must be one of {', '.join(known)}")
    return tuple(
        Alignment(**dict(zip(values, combination, strict=True)))
        for combination in itertools.product(*values.values())
    )


def aligned_contacts(
    contacts: Sequence[BodyContact], alignment: Alignment, tibiofemoral: str = TIBIOFEMORAL
) -> tuple[BodyContact, ...]:
    """The contacts where an alignment puts them; their models are the same objects.

    The femoral component moves on its bone in every contact with that bone as moving body, the trochlea with the
    condyles; the tibial one in the tibiofemoral contact.

    Args:
        contacts: of a simulation.
        alignment: what is moved.
        tibiofemoral: name of the contact of femoral and tibial component.

    Raises:
        InputDataError: none of the contacts has that name.
    """
    knee = next((contact for contact in contacts if contact.name == tibiofemoral), None)
    if knee is None:
        names = ", ".join(contact.name for contact in contacts) or "none"
        raise InputDataError(f"no contact is called {tibiofemoral!r} (there are: {names})")
    femoral = knee.X_BF @ alignment.femoral_motion(knee.side_of_body)
    tibial = alignment.tibial_motion(knee.side_of_body)
    moved = []
    for contact in contacts:
        if contact.moving_body == knee.moving_body:
            contact = replace(contact, X_BF=femoral @ _beside(knee.X_BF, contact.X_BF))
        if contact.name == tibiofemoral:
            contact = replace(contact, X_BT=contact.X_BT @ tibial)
        moved.append(contact)
    return tuple(moved)


def _beside(X_BF: Array, X_BS: Array) -> Array:
    """(4, 4) a surface of the femoral component in F; exactly none where it has F as its frame."""
    return np.eye(4) if np.array_equal(X_BF, X_BS) else np.asarray(np.linalg.inv(X_BF) @ X_BS)


def _motion(
    *,
    flexion_z: float,
    varus_x: float,
    rotation_y: float,
    displacement_mm: tuple[float, float, float],
) -> Array:
    """R = Rz·Rx·Ry of angles in degrees, and a displacement."""
    a, b, c = np.radians([flexion_z, varus_x, rotation_y])
    Rz = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    Rx = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    Ry = np.array([[np.cos(c), 0, np.sin(c)], [0, 1, 0], [-np.sin(c), 0, np.cos(c)]])
    X = np.eye(4)
    X[:3, :3] = Rz @ Rx @ Ry
    X[:3, 3] = 1e-3 * np.array(displacement_mm)
    return X
