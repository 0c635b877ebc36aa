# SPDX-License-Identifier: Apache-2.0
"""DM's tibiofemoral poses over a treadmill gait cycle as fluoroscopy measured them, in Condyle's conventions.

The file's six columns as measured are labelled wrongly; the data's README says what they are: position of the femoral
component in the insert and body-fixed x-y-z angles, in axes that are x posterior, y superior, z medial. Beside them
are rotation matrix and position in x anterior, y superior, z lateral, and only these two are used here; angles are
made anew from them. `other_readings` are what else one might take the columns for: the right one leaves the two parts
in touch.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle._core.common import SideOfBody, clinical_kinematics, pose_from_transform
from condyle.contact import Derivatives, MeshContact

Floats = NDArray[np.float64]
#: The source's axes, seen in ours: half a turn about y.
_TURN: Final = np.diag([-1.0, 1.0, -1.0])
#: A part is looked for within this height of touching the other [m].
_REACH: Final = 6e-3
#: Halvings of that height: to a tenth of a micrometre.
_HALVINGS: Final = 17


@dataclass(frozen=True)
class Fluoroscopy:
    """A gait cycle, one row a percent.

    Attributes:
        poses: (101, 6) of F in T [m, rad].
        kinematics: (101, 6) clinical (Grood and Suntay 1983) [rad, m].
        gaps: (101, 2) vertical, medial and lateral, as the file has them; negative: overlap [m].
        flexion: (101,) as the file has it [deg].
        native_position: (101, 3) in the source's axes [m].
        native_angles: (101, 3) about the source's x, y, z [rad].
        rotations: (101, 3, 3) as the file has them.
    """

    poses: Floats
    kinematics: Floats
    gaps: Floats
    flexion: Floats
    native_position: Floats
    native_angles: Floats
    rotations: Floats


def read_fluoroscopy(file: Path) -> Fluoroscopy:
    """Reads fluoroscopy_gait.csv."""
    table = np.genfromtxt(file, delimiter=",", names=True)

    def columns(*names: str) -> Floats:
        return np.stack([table[name] for name in names], axis=1)

    entries = columns(*(f"R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)))
    rotations = np.ascontiguousarray(entries.reshape(-1, 3, 3))
    poses = to_poses(rotations, columns("tx", "ty", "tz"))
    return Fluoroscopy(
        poses=poses,
        kinematics=np.asarray(clinical_kinematics(poses, SideOfBody.right)),
        gaps=columns("vertical_gap_medial_m", "vertical_gap_lateral_m"),
        flexion=np.asarray(table["flexion_deg"]),
        native_position=columns("xtrans_native_m", "ytrans_native_m", "ztrans_native_m"),
        native_angles=columns("xrot_native_rad", "yrot_native_rad", "zrot_native_rad"),
        rotations=rotations,
    )


def to_poses(rotations: Floats, positions: Floats) -> Floats:
    """Poses (n, 6) of rotation matrices R_TF (n, 3, 3) and positions (n, 3) [m]."""
    return np.array(
        [
            pose_from_transform(np.ascontiguousarray(R), np.ascontiguousarray(p))
            for R, p in zip(rotations, positions, strict=True)
        ]
    )


def body_fixed(angles: Floats, order: str) -> Floats:
    """Rotations (n, 3, 3) of angles (n, 3) about x, y, z, carried out in an order such as ``xyz``, body-fixed."""
    product = np.broadcast_to(np.eye(3), (len(angles), 3, 3))
    for axis in order:
        i = "xyz".index(axis)
        j, k = (i + 1) % 3, (i + 2) % 3
        turn = np.zeros((len(angles), 3, 3))
        cosine, sine = np.cos(angles[:, i]), np.sin(angles[:, i])
        turn[:, i, i] = 1.0
        turn[:, j, j] = turn[:, k, k] = cosine
        turn[:, k, j], turn[:, j, k] = sine, -sine
        product = product @ turn
    return np.asarray(product)


def vertical_gaps(contact: MeshContact, poses: Floats) -> Floats:
    """How far the femoral component is above the insert's medial and lateral side, along y_T, (n, 2) [m].

    Negative: by how much it would have to be raised for that side not to carry anything.
    """
    gaps = np.empty((len(poses), 2))
    for side in range(2):
        low, high = np.full(len(poses), -_REACH), np.full(len(poses), _REACH)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            lowered = poses.copy()
            lowered[:, 1] -= middle
            loads = contact.evaluate(np.ascontiguousarray(lowered), Derivatives.none, 1)
            touches = loads.wrench[:, side, 1] > 0.0
            high, low = np.where(touches, middle, high), np.where(touches, low, middle)
        gaps[:, side] = 0.5 * (low + high)
    return gaps


def other_readings(measured: Fluoroscopy) -> dict[str, Floats]:
    """Poses by the right reading of the measured columns, and by others that one might take it for."""
    angles, position = measured.native_angles, measured.native_position
    here = position @ _TURN

    def turned(given: Floats, order: str) -> Floats:
        return np.asarray(_TURN @ body_fixed(given, order) @ _TURN)

    return {
        "R and t of the file": measured.poses,
        "body-fixed x-y-z, axes turned": to_poses(turned(angles, "xyz"), here),
        "body-fixed z-y-x": to_poses(turned(angles, "zyx"), here),
        "x, z not turned": to_poses(turned(angles, "xyz"), position),
        "adduction reversed": to_poses(turned(angles * [-1, 1, 1], "xyz"), here),
        "rotation reversed": to_poses(turned(angles * [1, -1, 1], "xyz"), here),
    }
