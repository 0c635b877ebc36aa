# SPDX-License-Identifier: Apache-2.0
"""Parametric knee replacements: designs, their contact surfaces, and their files.

Use this when no implant of your own is at hand, or to vary one dimension at a time:

    >>> from condyle.implants import generate, preset, write_implant
    >>> implant = generate(preset("curved", size=1.05, side_of_body="left"))
    >>> write_implant("runs/demo/implant", implant)  # doctest: +SKIP

Lengths in m, angles in rad. Axes: x anterior, y superior, z to the subject's right.
"""

from condyle.implants.articulation import SettledPose, settle
from condyle.implants.files import read_parameters, write_implant, write_stl
from condyle.implants.implant import Implant, generate
from condyle.implants.mesh import SurfaceMesh
from condyle.implants.parameters import CoronalProfile, ImplantParameters, preset

__all__ = [
    "CoronalProfile",
    "Implant",
    "ImplantParameters",
    "SettledPose",
    "SurfaceMesh",
    "generate",
    "preset",
    "read_parameters",
    "settle",
    "write_implant",
    "write_stl",
]
