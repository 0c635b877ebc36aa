# SPDX-License-Identifier: Apache-2.0
"""The potential surrogate: one energy a side, its gradient the load. Conservative by construction.

    U_side(pose) = c·max(N_side(pose), 0)^p,    Q = −∂U/∂pose,    wrench = G⁻ᵀ·Q

N is a scalar network that is positive where the side is loaded: something like a penetration depth,
so nearly linear in y, and smooth through lift-off, where the loads themselves bend. The power p
carries that bend: energy grows with the 3rd power of the depth between surfaces that touch in a
point, with the 2.5th of those that touch along a line, both under pressure proportional to depth.
With p > 2 the wrench is exactly zero where N ≤ 0 and continuous with its first derivative there.

A closed path does no work, ∂Q/∂pose is symmetric, and each sample teaches one function six things.

Units: poses m and rad, loads N and Nm; wrench on the femur at Fo in T.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.errors import InputDataError
from condyle.training.generalised_force import wrench_and_stiffness_of
from condyle.training.input_data import as_poses
from condyle.training.potential_network import PotentialNetwork
from condyle.training.torch_file import read_torch_file, write_atomically

_FORMAT = "condyle potential surrogate, version 1"
#: Rows at a time: the tangents of one pass stay within a few hundred megabytes.
_CHUNK = 8192


@dataclass(frozen=True)
class SideEnergy:
    """U = c·max(N, 0)^p of one side.

    Attributes:
        network: N.
        scale: c > 0 [J].
        power: p > 2.
    """

    network: PotentialNetwork
    scale: float
    power: float

    def energy(self, pose: Tensor) -> Tensor:
        """U (n,) [J] at poses (n, 6)."""
        return self.scale * self.network.value(pose).clamp(min=0) ** self.power

    def wrench_and_stiffness(self, pose: Tensor) -> tuple[Tensor, Tensor]:
        """(n, 6) and (n, 6, 6) at poses (n, 6)."""
        value, gradient, hessian = self.network.second_order(pose)
        depth, p = value.clamp(min=0), self.power
        force = self.scale * p * depth ** (p - 1)
        curve = self.scale * p * (p - 1) * depth ** (p - 2)
        # Where the side is lifted both factors are exactly zero.
        Q = -force[:, None] * gradient
        Q_derivative = -(
            force[:, None, None] * hessian
            + curve[:, None, None] * gradient[:, :, None] * gradient[:, None, :]
        )
        return wrench_and_stiffness_of(pose, Q, Q_derivative)

    def to_dict(self) -> dict[str, Any]:
        """Plain values and tensors, for a file."""
        return {"network": self.network.to_dict(), "scale": self.scale, "power": self.power}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> SideEnergy:
        """Inverse of :meth:`to_dict`."""
        network = PotentialNetwork.from_dict(values["network"])
        return cls(network, values["scale"], values["power"])


class PotentialSurrogate:
    """See the module docstring. Immutable once built; evaluation is thread-safe.

    Args:
        sides: (medial, lateral).
    """

    architecture = "potential"

    def __init__(self, sides: tuple[SideEnergy, SideEnergy]) -> None:
        for name, side in zip(SIDES, sides, strict=True):
            if not side.power > 2:
                raise InputDataError(
                    f"{name} energy has power {side.power}; it must exceed 2 for a wrench that is "
                    "continuously differentiable at lift-off"
                )
        self.sides = sides

    def energy(self, poses: ArrayLike) -> NDArray[np.float64]:
        """Energy of both sides (n, 2) [J] at poses (n, 6)."""
        pose = torch.from_numpy(as_poses(poses))
        with torch.no_grad():
            energy = torch.stack([side.energy(pose) for side in self.sides], dim=1)
        result: NDArray[np.float64] = energy.numpy()
        return result

    def wrench(self, poses: ArrayLike) -> NDArray[np.float64]:
        """Wrench (n, 2, 6) [N, Nm] at poses (n, 6) [m, rad].

        Raises:
            InputDataError: Poses of the wrong shape or not finite.
        """
        return self.wrench_and_stiffness(poses)[0]

    def wrench_and_stiffness(
        self, poses: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Wrench (n, 2, 6) and ∂wrench_i/∂pose_j (n, 2, 6, 6) at poses (n, 6).

        Raises:
            InputDataError: Poses of the wrong shape or not finite.
        """
        pose = torch.from_numpy(as_poses(poses))
        n, n_sides, n_loads = len(pose), len(SIDES), len(LOAD_COLUMNS)
        wrench = pose.new_zeros(n, n_sides, n_loads)
        stiffness = pose.new_zeros(n, n_sides, n_loads, pose.shape[1])
        with torch.no_grad():
            for start in range(0, n, _CHUNK):
                rows = slice(start, start + _CHUNK)
                for index, side in enumerate(self.sides):
                    wrench[rows, index], stiffness[rows, index] = side.wrench_and_stiffness(
                        pose[rows]
                    )
        return wrench.numpy(), stiffness.numpy()

    def stiffness(self, poses: ArrayLike) -> NDArray[np.float64]:
        """The stiffness alone, see :meth:`wrench_and_stiffness`."""
        return self.wrench_and_stiffness(poses)[1]

    def to_dict(self) -> dict[str, Any]:
        """Plain values and tensors, for a file."""
        sides = {name: side.to_dict() for name, side in zip(SIDES, self.sides, strict=True)}
        return {"format": _FORMAT, "sides": sides}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> PotentialSurrogate:
        """Inverse of :meth:`to_dict`."""
        medial, lateral = (SideEnergy.from_dict(values["sides"][name]) for name in SIDES)
        return cls((medial, lateral))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the networks to a torch file, whole or not at all."""
        write_atomically(path, self.to_dict())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> PotentialSurrogate:
        """Reads what :meth:`save` wrote.

        Raises:
            InputDataError: Not such a file.
        """
        return cls.from_dict(read_torch_file(path, _FORMAT))
