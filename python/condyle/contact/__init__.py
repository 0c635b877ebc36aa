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
from condyle.contact.contact_map import CompartmentMap, ContactMap, contact_map
from condyle.contact.contact_pair import ContactPair, PairLoads
from condyle.contact.fast_error import (
    FastError,
    LoadRangeError,
    WrenchError,
    measure_fast_error,
)
from condyle.contact.implant_doctor import (
    Finding,
    ImplantExamination,
    MeshExamination,
    TrialContact,
    examine_implant,
    examine_mesh,
)
from condyle.contact.implant_files import ImplantMeshes, read_implant
from condyle.contact.law_table import read_table_law
from condyle.contact.laws import (
    ContactLaw,
    LinearVolumeLaw,
    PowerLaw,
    TableLaw,
    ThinLayerLinearLaw,
    ThinLayerLogarithmicLaw,
    pressure_modulus,
    youngs_modulus,
)
from condyle.contact.layers import FaceLayers
from condyle.contact.load_table import evaluate_pair_table, evaluate_table, write_table
from condyle.contact.mesh_contact import MeshContact
from condyle.contact.mesh_files import inspect_mesh, read_mesh, write_mesh
from condyle.contact.mesh_refinement import mean_edge_length, refine_mesh
from condyle.contact.overlap import (
    OverlapSolid,
    OverlapVolume,
    add_overlap_columns,
    overlap_volume,
    read_solid,
)

__all__ = [
    "CompartmentMap",
    "ContactLaw",
    "ContactMap",
    "ContactModel",
    "ContactPair",
    "Derivatives",
    "FaceLayers",
    "FastError",
    "Finding",
    "ImplantExamination",
    "ImplantMeshes",
    "LinearVolumeLaw",
    "LoadArrays",
    "LoadRangeError",
    "Mesh",
    "MeshContact",
    "MeshExamination",
    "MeshReport",
    "OverlapSolid",
    "OverlapVolume",
    "PairLoads",
    "PowerLaw",
    "SignedDistance",
    "TableLaw",
    "ThinLayerLinearLaw",
    "ThinLayerLogarithmicLaw",
    "TrialContact",
    "WrenchError",
    "add_overlap_columns",
    "contact_map",
    "content_hash",
    "evaluate_pair_table",
    "evaluate_table",
    "examine_implant",
    "examine_mesh",
    "inspect_mesh",
    "mean_edge_length",
    "measure_fast_error",
    "overlap_volume",
    "pressure_modulus",
    "read_implant",
    "read_mesh",
    "read_poses",
    "read_solid",
    "read_table_law",
    "refine_mesh",
    "rotation_TF",
    "write_mesh",
    "write_table",
    "youngs_modulus",
]
