# SPDX-License-Identifier: Apache-2.0
"""OpenSim at the door: models, marker kinematics and path snapshots, through the package ``opensim``.

Only files come out of here (docs/opensim.md): a simulation needs neither this package nor
``opensim``. Importing ``condyle.opensim`` does not import ``opensim``; the first call does, and says
how to install it where it is missing.
"""

from condyle.opensim.inverse_kinematics import (
    InverseKinematicsResult,
    inverse_kinematics,
    write_coordinates,
)
from condyle.opensim.model_import import import_model, summary, write_model
from condyle.opensim.snapshots import path_snapshots, write_snapshots

__all__ = [
    "InverseKinematicsResult",
    "import_model",
    "inverse_kinematics",
    "path_snapshots",
    "summary",
    "write_coordinates",
    "write_model",
    "write_snapshots",
]
