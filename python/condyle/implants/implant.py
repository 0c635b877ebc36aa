# SPDX-License-Identifier: Apache-2.0
"""A whole knee replacement: parameters in, oriented contact surfaces out."""

from dataclasses import dataclass

from condyle.conventions import medial_direction
from condyle.implants.femur import femur_mesh
from condyle.implants.insert import insert_mesh
from condyle.implants.mesh import SurfaceMesh
from condyle.implants.parameters import ImplantParameters


@dataclass(frozen=True, eq=False)
class Implant:
    """The articulating surfaces of a knee replacement, each one open surface.

    Attributes:
        parameters: the design.
        femur: femoral component in the femoral frame F, normals towards the insert.
        insert: both compartments and the eminence in the insert frame T, normals up.
        insert_medial: the insert's faces medial of z = 0 (no face crosses it).
        insert_lateral: the insert's faces lateral of z = 0.
    """

    parameters: ImplantParameters
    femur: SurfaceMesh
    insert: SurfaceMesh
    insert_medial: SurfaceMesh
    insert_lateral: SurfaceMesh

    def meshes(self) -> dict[str, SurfaceMesh]:
        """The four surfaces by the names their files carry."""
        return {
            "femur": self.femur,
            "insert": self.insert,
            "insert_medial": self.insert_medial,
            "insert_lateral": self.insert_lateral,
        }


def generate(parameters: ImplantParameters) -> Implant:
    """Generates the surfaces of a design; the same parameters give the same bytes.

    A left implant is the right one mirrored in z with its faces flipped.

    Raises:
        InputDataError: parameters that cannot be combined.
    """
    femur, insert = femur_mesh(parameters), insert_mesh(parameters)
    if parameters.side_of_body == "left":
        femur, insert = femur.mirrored(), insert.mirrored()
    medial = medial_direction(parameters.side_of_body) * insert.centroids()[:, 2] > 0.0
    return Implant(parameters, femur, insert, insert.part(medial), insert.part(~medial))
