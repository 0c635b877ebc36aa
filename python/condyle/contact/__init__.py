# SPDX-License-Identifier: Apache-2.0
"""Contact between a femoral component and an insert, from their meshes.

Use :class:`MeshContact` as the reference that everything else is measured against; use
:mod:`condyle.surrogate` where its answer must come in microseconds. Poses are (n, 6) arrays
``x, y, z, theta_x, theta_y, theta_z`` [m, rad] of the femoral frame in the tibial frame; wrenches are
(n, 2, 6) arrays on the femur, at its origin, in the tibial frame [N, Nm], axis 1 (medial, lateral).
"""

from condyle._core.common import rotation_TF
from condyle._core.contact import ContactModel, Derivatives, LoadArrays
from condyle._core.geometry import Mesh, MeshReport, SignedDistance, content_hash
from condyle._core.io import read_poses
from condyle.contact.implant_files import ImplantMeshes, read_implant
from condyle.contact.load_table import evaluate_table, write_table
from condyle.contact.mesh_contact import MeshContact
from condyle.contact.mesh_files import inspect_mesh, read_mesh, write_mesh

__all__ = [
    "ContactModel",
    "Derivatives",
    "ImplantMeshes",
    "LoadArrays",
    "Mesh",
    "MeshContact",
    "MeshReport",
    "SignedDistance",
    "content_hash",
    "evaluate_table",
    "inspect_mesh",
    "read_implant",
    "read_mesh",
    "read_poses",
    "rotation_TF",
    "write_mesh",
    "write_table",
]
