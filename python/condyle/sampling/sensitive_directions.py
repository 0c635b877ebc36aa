# SPDX-License-Identifier: Apache-2.0
"""Sensitive directions: in which a small change of pose changes the contact loads most.

There the load is sampled, not the pose (Marra 2017): of y and θx, a tenth of a millimetre and a tenth
of a degree are hundreds of newtons, so evenly spread poses would be overlaps and gaps, and hardly a
plausible load among them. Which directions these are is the implant's to say: those of the greatest
generalised stiffness −∂Q_j/∂p_j among the translations and among the rotations that are free, the
femur pressed down where it seats. Flexion is driven, so θz is told but not a candidate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle.contact import ContactModel
from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS
from condyle.errors import CondyleError, InputDataError
from condyle.fdk import load_seated, seated_pose
from condyle.sampling.equilibrium_protocol import SENSITIVE_COLUMNS

#: Load under which the stiffnesses are taken [N]: some 1.3 body weights, both sides well in contact.
SEATING_LOAD: Final = 1000.0
_TRANSLATIONS: Final = POSE_COLUMNS[:3]
_FREE_ROTATIONS: Final = ("theta_x", "theta_y")
_N_PER_MM: Final = 1e-3
_NM_PER_DEG: Final = math.pi / 180.0


@dataclass(frozen=True)
class SensitiveDirections:
    """What the contact's stiffness at the seat says.

    Attributes:
        pose: (6,) of the femur pressed down [m, rad].
        Fy: Load there [N].
        stiffness: (6,) −∂Q_j/∂p_j, in the order of POSE_COLUMNS [N/m, Nm/rad]; a negative one helps
            a displacement on.
    """

    pose: NDArray[np.float64]
    Fy: float
    stiffness: NDArray[np.float64]

    @property
    def found(self) -> tuple[str, str]:
        """The stiffest translation and the stiffest free rotation."""
        return self._by_stiffness(_TRANSLATIONS)[0], self._by_stiffness(_FREE_ROTATIONS)[0]

    def times_stiffer(self, name: str) -> float:
        """How much stiffer one of ``found`` is than the next of its kind; infinite if that gives way."""
        kind = _TRANSLATIONS if name in _TRANSLATIONS else _FREE_ROTATIONS
        next_one = self._of(self._by_stiffness(kind)[1])
        return self._of(name) / next_one if next_one > 0.0 else math.inf

    def sentence(self) -> str:
        """For people: what is sensitive, by how much, and everything else."""
        first, second = (
            f"{name} ({self._text(name)}, {_times(self.times_stiffer(name))})"
            for name in self.found
        )
        rest = ", ".join(
            f"{name} {self._text(name)}" for name in POSE_COLUMNS if name not in self.found
        )
        return f"sensitive directions under {self.Fy:.0f} N: {first} and {second}; {rest}"

    def to_json(self) -> dict[str, Any]:
        """For a table: stiffnesses in N/mm and Nm/deg."""
        ratios = {name: self.times_stiffer(name) for name in self.found}
        return {
            "found": list(self.found),
            "Fy_N": self.Fy,
            "pose": self.pose.tolist(),
            "stiffness": {
                name: {"value": self._scaled(name), "unit": _unit(name)} for name in POSE_COLUMNS
            },
            "times_stiffer_than_next": {
                name: ratio if math.isfinite(ratio) else None for name, ratio in ratios.items()
            },
        }

    def _of(self, name: str) -> float:
        return float(self.stiffness[POSE_COLUMNS.index(name)])

    def _scaled(self, name: str) -> float:
        return self._of(name) * (_N_PER_MM if name in _TRANSLATIONS else _NM_PER_DEG)

    def _text(self, name: str) -> str:
        return f"{self._scaled(name):.3g} {_unit(name)}"

    def _by_stiffness(self, names: Sequence[str]) -> list[str]:
        return sorted(names, key=self._of, reverse=True)


def find_sensitive_directions(model: ContactModel, Fy: float = SEATING_LOAD) -> SensitiveDirections:
    """Seats the femur at full extension, presses it down and takes the stiffnesses.

    Args:
        model: Any contact model with stiffness.
        Fy: Load [N].

    Raises:
        CondyleError: The femur finds no seat, or the seat does not carry the load.
    """
    seat = seated_pose(model, 0.0)
    if not seat.converged:
        raise CondyleError(
            f"sensitive directions: the femur finds no seat at full extension: {seat.advice}"
        )
    loaded = load_seated(model, seat, Fy, Mx=0.0)
    if not loaded.converged[0]:
        raise CondyleError(
            f"sensitive directions: the seat does not carry {Fy:.6g} N: {loaded.status[0]}"
        )
    pose = np.asarray(loaded.poses[0])
    return SensitiveDirections(pose, Fy, diagonal_stiffness(pose, loaded.stiffness[0].sum(axis=0)))


def diagonal_stiffness(
    pose: NDArray[np.float64], stiffness: NDArray[np.float64]
) -> NDArray[np.float64]:
    """−∂Q_j/∂p_j (6,) of Q = Gᵀ·wrench, from ∂wrench/∂pose (6, 6) at a pose (6,).

    Row j of Gᵀ does not depend on coordinate j (pose.hpp: Q_θy turns with θx alone, Q_θz with θx and
    θy), so on the diagonal the wrench's derivative is all there is.
    """
    theta_x, theta_y = pose[POSE_COLUMNS.index("theta_x")], pose[POSE_COLUMNS.index("theta_y")]
    sin_x, cos_x, sin_y, cos_y = (
        f(angle) for angle in (theta_x, theta_y) for f in (np.sin, np.cos)
    )
    Mx, My, Mz = (LOAD_COLUMNS.index(name) for name in ("Mx", "My", "Mz"))
    result = np.diag(stiffness).copy()
    result[3] = -stiffness[Mx, 3]
    result[4] = -cos_x * stiffness[My, 4] + sin_x * stiffness[Mz, 4]
    result[5] = (
        sin_y * stiffness[Mx, 5]
        - cos_y * sin_x * stiffness[My, 5]
        - cos_y * cos_x * stiffness[Mz, 5]
    )
    return -result


def require_solvable(found: SensitiveDirections) -> None:
    """Refuses to sample {Fy, Mx} of an implant whose sensitive directions are others.

    Raises:
        InputDataError: Names what was found, and how to sample all the same.
    """
    if found.found != SENSITIVE_COLUMNS:
        raise InputDataError(
            f"sampling.sensitive_directions = 'auto': {found.sentence()}; static equilibria can be "
            "solved for y and theta_x only. Turn the implant's frames so that y is along the load, or "
            'say sensitive_directions = ["y", "theta_x"] (or ["y"]) to sample with these anyway'
        )


def _unit(name: str) -> str:
    return "N/mm" if name in _TRANSLATIONS else "Nm/deg"


def _times(ratio: float) -> str:
    return f"{ratio:.3g} times the next" if math.isfinite(ratio) else "the next gives way"
