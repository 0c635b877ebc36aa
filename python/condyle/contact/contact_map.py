# SPDX-License-Identifier: Apache-2.0
"""The contact at one pose, face by face: what pictures and files of a pressure map show."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import contact as _contact
from condyle._core.common import rotation_TF
from condyle.conventions import SIDES
from condyle.errors import InputDataError

Floats = NDArray[np.float64]
Faces = NDArray[np.int32]


@dataclass(frozen=True)
class CompartmentMap:
    """One compartment of the insert under load.

    Attributes:
        vertices: (n, 3) in T [m].
        faces: (m, 3).
        depth: (m,) of each face's centroid below the femoral surface [m]; 0 where not loaded.
        pressure: (m,) [Pa].
        wrench: (6,) on the femur, at Fo, expressed in T [N, Nm].
        area: Of loaded faces [m²].
        centre_of_pressure: (3,) in T [m]; zero out of contact.
    """

    vertices: Floats
    faces: Faces
    depth: Floats
    pressure: Floats
    wrench: Floats
    area: float
    centre_of_pressure: Floats


@dataclass(frozen=True)
class ContactMap:
    """The contact at one pose.

    Attributes:
        pose: (6,) [m, rad].
        side_of_body: left or right.
        law: Name and parameters of the contact law.
        status: ``ok``, or what is wrong on which side.
        femur_vertices: (n, 3) placed in T [m].
        femur_faces: (m, 3).
        sides: The compartments by name: medial, lateral.
    """

    pose: Floats
    side_of_body: str
    law: str
    status: str
    femur_vertices: Floats
    femur_faces: Faces
    sides: dict[str, CompartmentMap]

    @property
    def peak_pressure(self) -> float:
        """Of both sides [Pa]."""
        return max(float(side.pressure.max(initial=0.0)) for side in self.sides.values())


def contact_map(contact: _contact.MeshContact, pose: ArrayLike) -> ContactMap:
    """Evaluates a mesh contact face by face.

    Args:
        contact: The contact.
        pose: (6,) [m, rad].

    Raises:
        ValueError: The pose is not six finite values.
    """
    one = np.ascontiguousarray(pose, dtype=np.float64)
    if one.shape != (6,):
        raise InputDataError(f"contact map: pose has shape {one.shape}: (6,) is needed")
    detail = contact.evaluate_details(one[None, :], 1)
    meshes = {"medial": contact.insert_medial, "lateral": contact.insert_lateral}
    sides = {}
    for i, name in enumerate(SIDES):
        depth, pressure = contact.face_pressure(one, getattr(_contact.Side, name))
        sides[name] = CompartmentMap(
            np.asarray(meshes[name].vertices),
            np.asarray(meshes[name].faces),
            np.asarray(depth),
            np.asarray(pressure),
            np.asarray(detail.wrench)[0, i],
            float(np.asarray(detail.area)[0, i]),
            np.asarray(detail.centre_of_pressure)[0, i],
        )
    femur = np.asarray(contact.femur.vertices) @ np.asarray(rotation_TF(one)).T + one[:3]
    parameters = ", ".join(f"{key} {value:.6g}" for key, value in contact.law_parameters())
    return ContactMap(
        one,
        contact.side_of_body.name,
        f"{contact.law_name()} ({parameters})",
        detail.status[0],
        femur,
        np.asarray(contact.femur.faces),
        sides,
    )
