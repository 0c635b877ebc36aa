# SPDX-License-Identifier: Apache-2.0
"""The reference contact of two meshes."""

from os import PathLike
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import contact as _contact
from condyle._core.common import side_of_body as _side_of_body
from condyle._core.geometry import Mesh, content_hash
from condyle.contact.implant_files import read_implant
from condyle.contact.laws import ContactLaw, LinearVolumeLaw
from condyle.contact.mesh_files import MeshFile, Units
from condyle.conventions import SideOfBody

EvaluationName = Literal["exact", "fast"]

#: K = 9.3e9 N/m³ (Marra et al. 2015), for forces and kinematics.
_DEFAULT_LAW = LinearVolumeLaw()


class MeshContact(_contact.MeshContact):
    """Frictionless elastic contact between a femoral component and an insert's two compartments.

    Energy U = Σ A·W(d) over the insert's faces, d the depth of a face's centroid below the femoral
    surface; loads are its derivatives. Quasi-static; the bodies are rigid under their surface layer.

    Args:
        femur: surface of the femoral component in the femoral frame, normals out of it.
        insert_medial: medial compartment in the tibial frame, normals out of the insert (up).
        insert_lateral: lateral compartment.
        side_of_body: which knee it is.
        law: W(d), see :mod:`condyle.contact.laws`; by default p = K·d with K = 9.3e9 N/m³ (Marra et al. 2015).
        evaluation: "exact", distances to the triangles themselves, or "fast", through a smooth field of them.
        plausible_depth: depth beyond which an overlap is flagged [m]; the core's default (2 mm) if not given.
        cache_directory: where "fast" keeps its distance field between runs.

    Raises:
        ValueError: a mesh's normals point inwards, sides are swapped, or a setting is out of range.
    """

    def __init__(
        self,
        femur: Mesh,
        insert_medial: Mesh,
        insert_lateral: Mesh,
        side_of_body: SideOfBody,
        *,
        law: ContactLaw = _DEFAULT_LAW,
        evaluation: EvaluationName = "exact",
        plausible_depth: float | None = None,
        cache_directory: str | PathLike[str] | None = None,
    ) -> None:
        settings = _contact.MeshContactSettings()
        settings.evaluation = _contact.evaluation(evaluation)
        if plausible_depth is not None:
            settings.plausible_depth = plausible_depth
        if cache_directory is not None:
            settings.cache_directory = Path(cache_directory)
        side = _side_of_body(side_of_body)
        super().__init__(femur, insert_medial, insert_lateral, side, law.core, settings)

    @classmethod
    def from_files(
        cls,
        *,
        femur: MeshFile,
        insert: MeshFile | None = None,
        insert_medial: MeshFile | None = None,
        insert_lateral: MeshFile | None = None,
        units: Units,
        side_of_body: SideOfBody,
        law: ContactLaw = _DEFAULT_LAW,
        evaluation: EvaluationName = "exact",
        plausible_depth: float | None = None,
        cache_directory: str | PathLike[str] | None = None,
    ) -> Self:
        """The contact of an implant in files; arguments as :func:`read_implant` and the class.

        Raises:
            ValueError: as :func:`read_implant` and the class.
        """
        implant = read_implant(
            femur=femur,
            insert=insert,
            insert_medial=insert_medial,
            insert_lateral=insert_lateral,
            units=units,
            side_of_body=side_of_body,
        )
        return cls(
            implant["femur"],
            implant["insert_medial"],
            implant["insert_lateral"],
            side_of_body,
            law=law,
            evaluation=evaluation,
            plausible_depth=plausible_depth,
            cache_directory=cache_directory,
        )

    def face_pressures(self, pose: ArrayLike) -> list[NDArray[np.float64]]:
        """Pressure of each face [Pa] of the medial and of the lateral compartment.

        Args:
            pose: (6,) one pose [m, rad].
        """
        one = np.ascontiguousarray(pose, dtype=np.float64)
        sides = (_contact.Side.medial, _contact.Side.lateral)
        return [np.asarray(self.face_pressure(one, side)[1]) for side in sides]

    def mesh_hashes(self) -> dict[str, str]:
        """SHA-256 of each surface's content, for metadata."""
        return {
            "femur": content_hash(self.femur),
            "insert_medial": content_hash(self.insert_medial),
            "insert_lateral": content_hash(self.insert_lateral),
        }
