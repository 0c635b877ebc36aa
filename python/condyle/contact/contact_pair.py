# SPDX-License-Identifier: Apache-2.0
"""The contact of any two bodies: a moving surface and the compartments of a fixed one."""

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import contact as _contact
from condyle._core.common import side_of_body as _side_of_body
from condyle._core.geometry import Mesh
from condyle.contact.laws import ContactLaw, LinearVolumeLaw
from condyle.contact.layers import FaceLayers, layer_table
from condyle.conventions import POSE_COLUMNS, SideOfBody
from condyle.errors import InputDataError

EvaluationName = Literal["exact", "fast"]
IntegrationName = Literal["fixed", "moving", "both"]

_DEFAULT_LAW = LinearVolumeLaw()


@dataclass(frozen=True, kw_only=True)
class PairLoads:
    """Loads of c compartments at n poses; axis 1 is the compartment, in the pair's order.

    Attributes:
        wrench: (n, c, 6) on the moving body, at its origin, in the fixed frame [N, Nm].
        stiffness: (n, c, 6, 6) ∂wrench_i/∂pose_j, or None if not asked for.
        energy: (n, c) [J].
        volume: (n, c) Σ A·d [m³].
        area: (n, c) of loaded faces [m²].
        border_area: (n, c) of overlapping faces closest to the other surface's open border: not counted [m²].
        max_depth: (n, c) [m].
        peak_pressure: (n, c) [Pa].
        centre_of_pressure: (n, c, 3) in the fixed frame [m]; zero out of contact.
    """

    wrench: NDArray[np.float64]
    stiffness: NDArray[np.float64] | None
    energy: NDArray[np.float64]
    volume: NDArray[np.float64]
    area: NDArray[np.float64]
    border_area: NDArray[np.float64]
    max_depth: NDArray[np.float64]
    peak_pressure: NDArray[np.float64]
    centre_of_pressure: NDArray[np.float64]


class ContactPair:
    """Frictionless elastic contact of any two bodies: femur and insert, patellar button and trochlea.

    Energy U = Σ A·W(d) over the faces of one body, d the depth of a face's centroid below the other's surface; loads
    are its derivatives. For a knee's two sides with their names and checks use :class:`condyle.contact.MeshContact`.

    Args:
        moving: surface of the moving body in its own frame, normals out of it.
        fixed: surfaces of the fixed body's compartments in its frame, by name, normals out of it.
        law: W(d), see :mod:`condyle.contact.laws`.
        evaluation: "exact", distances to the triangles themselves, or "fast", through smooth fields of them.
        integration: whose faces are integrated: "fixed", "moving", or "both" for their mean, which alone is the same
            when the bodies change roles.
        cache_directory: where "fast" keeps its distance fields between runs.
        moving_layers: the elastic layer under each face of ``moving``, for laws that have one.
        fixed_layers: likewise of compartments, by name.

    Raises:
        ValueError: a mesh is not well formed, a name is unknown, or layers do not match; the text says which.
    """

    def __init__(
        self,
        moving: Mesh,
        fixed: Mapping[str, Mesh],
        *,
        law: ContactLaw = _DEFAULT_LAW,
        evaluation: EvaluationName = "exact",
        integration: IntegrationName = "fixed",
        cache_directory: str | PathLike[str] | None = None,
        moving_layers: FaceLayers | None = None,
        fixed_layers: Mapping[str, FaceLayers] | None = None,
    ) -> None:
        by_name = dict(fixed_layers or {})
        for name in by_name:
            if name not in fixed:
                raise InputDataError(f"fixed_layers names {name!r}: must be one of {list(fixed)}")
        settings = _contact.PairSettings()
        settings.evaluation = _contact.evaluation(evaluation)
        settings.integration = _contact.integration(integration)
        if cache_directory is not None:
            settings.cache_directory = Path(cache_directory)
        self.names = tuple(fixed)
        self._core = _contact.ContactPair(
            moving,
            list(fixed.values()),
            law.core,
            settings,
            layer_table(moving_layers, len(moving.faces)),
            [layer_table(by_name.get(name), len(mesh.faces)) for name, mesh in fixed.items()],
        )

    def evaluate(self, poses: ArrayLike, *, stiffness: bool = False, threads: int = 0) -> PairLoads:
        """Loads of every compartment at poses.

        Args:
            poses: (n, 6) pose of the moving body's frame in the fixed body's: x, y, z, theta_x, theta_y, theta_z
                [m, rad].
            stiffness: also ∂wrench/∂pose.
            threads: 0 means all cores. The result does not depend on it.

        Raises:
            ValueError: poses are not (n, 6), or one is not finite.
        """
        table = np.ascontiguousarray(poses, dtype=np.float64)
        if table.ndim != 2 or table.shape[1] != len(POSE_COLUMNS):
            raise InputDataError(f"poses of shape {table.shape}: must be (n, 6)")
        wanted = _contact.Derivatives.stiffness if stiffness else _contact.Derivatives.none
        loads = self._core.evaluate(table, wanted, threads)
        n, c = len(table), len(self.names)
        return PairLoads(
            wrench=np.asarray(loads.wrench),
            stiffness=np.asarray(loads.stiffness).reshape(n, c, 6, 6) if stiffness else None,
            energy=np.asarray(loads.energy),
            volume=np.asarray(loads.volume),
            area=np.asarray(loads.area),
            border_area=np.asarray(loads.border_area),
            max_depth=np.asarray(loads.max_depth),
            peak_pressure=np.asarray(loads.peak_pressure),
            centre_of_pressure=np.asarray(loads.centre_of_pressure),
        )

    def face_pressure(self, pose: ArrayLike, compartment: str) -> NDArray[np.float64]:
        """(m,) pressure of each face [Pa] of a compartment; of ``moving`` where only its faces are integrated.

        Args:
            pose: (6,) one pose [m, rad].
            compartment: its name.

        Raises:
            ValueError: the name is unknown, or the pose is not finite.
        """
        if compartment not in self.names:
            raise InputDataError(f"compartment {compartment!r}: must be one of {list(self.names)}")
        one = np.ascontiguousarray(pose, dtype=np.float64)
        return np.asarray(self._core.face_pressure(one, self.names.index(compartment))[1])

    def as_contact_model(
        self, side_of_body: SideOfBody, *, plausible_depth: float = 2e-3
    ) -> _contact.ContactModel:
        """This pair for whatever takes a contact model of a joint: a simulation's patellofemoral contact.

        All compartments together are given as the medial side; the lateral one carries nothing.

        Args:
            side_of_body: of the joint.
            plausible_depth: beyond which an overlap is flagged [m].

        Raises:
            ValueError: ``plausible_depth`` is not finite and above 0.
        """
        return _contact.PairContactModel(
            self._core, _side_of_body(side_of_body), _contact.Side.medial, plausible_depth
        )
