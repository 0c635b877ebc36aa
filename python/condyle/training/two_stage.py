# SPDX-License-Identifier: Apache-2.0
"""The two-stage surrogate of Marra et al. (2017): three small networks.

    net I:    pose                     → (Fy, Mx) medial, (Fy, Mx) lateral     the sensitive
    directions net II:   pose, Fy, Mx of medial   → (Fx, Fz, My, Mz) medial
    net III:  pose, Fy, Mx of lateral  → (Fx, Fz, My, Mz) lateral
    gate:     a side with Fy ≤ 0 has all six loads zero

The gate makes the wrench of a lifted side exactly zero and its stiffness too; where a side's
predicted Fy crosses zero the wrench jumps by what the networks predict there for the loads other
than Fy (small, but not nothing).

Since the gate sets every load of a lifted side to zero, net I need not predict those zeros; it
only has to put Fy on the right side of zero. So a lifted side's Fy target can be an upper bound
instead of a value (a censored observation) and its Mx be left out. The network then carries on
smoothly below zero, where "exactly zero" would ask it to bend sharply. On an analytic contact
with 8 000 samples (medial / lateral Fy RMSE over loaded test samples): 10.6 / 18.6 N instead of
22.8 / 45.0 N after 40 epochs, 5.2 / 10.0 N instead of 8.5 / 15.2 N after 60.

Nets II and III learn from the Fy and Mx that net I predicts, which is what they are given in
use. Taught the true ones they trust them too much and amplify net I's errors: with 6 000
samples of the same contact and 60 epochs a net, RMSE of Fx, Fz, My, Mz was 2.2, 1.7 N, 0.051,
0.073 Nm medial and 3.8, 1.3 N, 0.080, 0.191 Nm lateral, against 1.8, 0.35 N, 0.043, 0.066 Nm
and 3.7, 0.48 N, 0.087, 0.130 Nm.

Units: poses m and rad, loads N and Nm; wrench on the femur at Fo in T.

Reference: Marra et al. (2017), J Biomech Eng 139(8), doi:10.1115/1.4036605, "Training of the
Surrogate Contact Model".
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.errors import InputDataError
from condyle.training.input_data import as_poses
from condyle.training.networks import TanhMlp
from condyle.training.torch_file import read_torch_file, write_atomically

#: Loads that net I predicts, and those that nets II and III predict, as indices into LOAD_COLUMNS.
FIRST_STAGE_LOADS = tuple(LOAD_COLUMNS.index(name) for name in ("Fy", "Mx"))
SECOND_STAGE_LOADS = tuple(LOAD_COLUMNS.index(name) for name in ("Fx", "Fz", "My", "Mz"))
#: Names of the networks, in training order.
NET_NAMES = ("I", "II", "III")
_FORMAT = "condyle two_stage surrogate, version 1"


class TwoStageSurrogate:
    """See the module docstring. Immutable once built; evaluation is thread-safe.

    Args:
        first: Net I, 6 inputs and 4 outputs (medial Fy, medial Mx, lateral Fy, lateral Mx).
        second: Nets II and III, 8 inputs (pose, Fy, Mx) and 4 outputs (Fx, Fz, My, Mz).
    """

    architecture = "two_stage"

    def __init__(self, first: TanhMlp, second: tuple[TanhMlp, TanhMlp]) -> None:
        for name, net, n_in in zip(NET_NAMES, (first, *second), (6, 8, 8), strict=True):
            if (net.widths[0], net.widths[-1]) != (n_in, 4):
                raise InputDataError(
                    f"net {name} has {net.widths[0]} inputs and {net.widths[-1]} outputs; "
                    f"it must have {n_in} and 4"
                )
        self.first = first
        self.second = second

    def wrench(self, poses: ArrayLike) -> NDArray[np.float64]:
        """Wrench (n, 2, 6) [N, Nm] at poses (n, 6) [m, rad].

        Raises:
            InputDataError: Poses of the wrong shape or not finite.
        """
        pose = torch.from_numpy(as_poses(poses))
        result = pose.new_zeros(len(pose), len(SIDES), len(LOAD_COLUMNS))
        with torch.no_grad():
            first = self.first(pose).view(-1, len(SIDES), 2)
            for side, net in enumerate(self.second):
                result[:, side, FIRST_STAGE_LOADS] = first[:, side]
                result[:, side, SECOND_STAGE_LOADS] = net(torch.cat([pose, first[:, side]], dim=1))
        wrench: NDArray[np.float64] = _gated(result, first).numpy()
        return wrench

    def wrench_and_stiffness(
        self, poses: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Wrench (n, 2, 6) and its analytic derivative (n, 2, 6, 6) at poses (n, 6).

        stiffness[i][j] = ∂wrench_i/∂pose_j, in N/m, N/rad, Nm/m, Nm/rad. On a lifted side both
        are zero.

        Raises:
            InputDataError: Poses of the wrong shape or not finite.
        """
        pose = torch.from_numpy(as_poses(poses))
        n, n_sides, n_loads, n_pose = len(pose), len(SIDES), len(LOAD_COLUMNS), pose.shape[1]
        result = pose.new_zeros(n, n_sides, n_loads)
        stiffness = pose.new_zeros(n, n_sides, n_loads, n_pose)
        with torch.no_grad():
            outputs, jacobian = self.first.forward_and_jacobian(pose)
            first, d_first = outputs.view(n, n_sides, 2), jacobian.view(n, n_sides, 2, n_pose)
            for side, net in enumerate(self.second):
                outputs, jacobian = net.forward_and_jacobian(
                    torch.cat([pose, first[:, side]], dim=1)
                )
                result[:, side, FIRST_STAGE_LOADS] = first[:, side]
                result[:, side, SECOND_STAGE_LOADS] = outputs
                stiffness[:, side, FIRST_STAGE_LOADS] = d_first[:, side]
                # Chain rule through the Fy and Mx that the second stage is given.
                stiffness[:, side, SECOND_STAGE_LOADS] = (
                    jacobian[:, :, :n_pose] + jacobian[:, :, n_pose:] @ d_first[:, side]
                )
        return _gated(result, first).numpy(), _gated(stiffness, first).numpy()

    def stiffness(self, poses: ArrayLike) -> NDArray[np.float64]:
        """The stiffness alone, see :meth:`wrench_and_stiffness`."""
        return self.wrench_and_stiffness(poses)[1]

    def ungated_fy(self, poses: ArrayLike) -> NDArray[np.float64]:
        """Net I's Fy (n, 2) [N] before the gate, negative on a lifted side."""
        with torch.no_grad():
            first = self.first(torch.from_numpy(as_poses(poses)))
        fy: NDArray[np.float64] = first.view(-1, len(SIDES), 2)[:, :, 0].numpy()
        return fy

    def to_dict(self) -> dict[str, Any]:
        """Plain values and tensors, for a file."""
        nets = zip(NET_NAMES, (self.first, *self.second), strict=True)
        return {"format": _FORMAT, "nets": {name: net.to_dict() for name, net in nets}}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> TwoStageSurrogate:
        """Inverse of :meth:`to_dict`."""
        first, medial, lateral = (TanhMlp.from_dict(values["nets"][name]) for name in NET_NAMES)
        return cls(first, (medial, lateral))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the networks to a torch file, whole or not at all."""
        write_atomically(path, self.to_dict())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> TwoStageSurrogate:
        """Reads what :meth:`save` wrote.

        Raises:
            InputDataError: Not such a file.
        """
        values = read_torch_file(path, _FORMAT)
        return cls.from_dict(values)


def _gated(values: Tensor, first: Tensor) -> Tensor:
    """``values`` (n, 2, ...) with lifted sides (Fy ≤ 0 in ``first`` (n, 2, 2)) set to zero."""
    lifted = first[:, :, 0] <= 0
    return values.masked_fill(lifted.view(*lifted.shape, *(1,) * (values.dim() - 2)), 0.0)
