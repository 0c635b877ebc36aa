# SPDX-License-Identifier: Apache-2.0
"""Ligament bundles for the knee simulator."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from condyle._core import common as _common
from condyle._core import fdk as _fdk
from condyle.conventions import SideOfBody
from condyle.errors import InputDataError


def default_ligaments(side_of_body: SideOfBody, reference_pose: ArrayLike) -> list[_fdk.Ligament]:
    """Eight tibiofemoral bundles of a cruciate-retaining knee replacement (Blankevoort's law, straight lines).

    Assign them to ``KneeSimulatorSettings.ligaments``. Attachments and stiffnesses are those of one
    subject: a starting point.

    Args:
        side_of_body: ``left`` or ``right``.
        reference_pose: (6,) where the reference strains hold: a settled pose near extension.

    Raises:
        InputDataError: An argument is out of range.
    """
    pose = np.ascontiguousarray(reference_pose, dtype=np.float64)
    if pose.shape != (6,) or not np.all(np.isfinite(pose)):
        raise InputDataError(f"reference_pose is {pose}: six finite values are needed")
    try:
        side = _common.side_of_body(side_of_body)
    except ValueError as error:
        raise InputDataError(str(error)) from error
    return list(_fdk.default_ligaments(side, pose))
