# SPDX-License-Identifier: Apache-2.0
"""Which contact model acts between which bodies of a musculoskeletal model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from condyle._core import common as _common
from condyle._core import fdk as _fdk
from condyle._core.contact import ContactModel
from condyle.conventions import SideOfBody
from condyle.errors import InputDataError
from condyle.model import SurfaceFile

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BodyContact:
    """A contact of a simulation: the pose of F in T comes from the bodies, the loads go back to them.

    Attributes:
        name: in results and messages, ``tibiofemoral`` for instance.
        model: any contact model with stiffness: reference, surrogate, hybrid, or a pair of other bodies
            (:meth:`condyle.contact.ContactPair.as_contact_model`).
        moving_body: that F is fixed to (the femur).
        fixed_body: that T is fixed to (the tibia).
        X_BF: (4, 4) placement of F in the moving body [m].
        X_BT: (4, 4) placement of T in the fixed body [m].
        side_of_body: of the joint; a model of the other knee is refused.
    """

    name: str
    model: ContactModel
    moving_body: str
    fixed_body: str
    X_BF: Array = field(default_factory=lambda: np.eye(4))
    X_BT: Array = field(default_factory=lambda: np.eye(4))
    side_of_body: SideOfBody = "right"

    @classmethod
    def between(
        cls,
        name: str,
        model: ContactModel,
        surfaces: Mapping[str, SurfaceFile],
        moving: str,
        fixed: str,
        side_of_body: SideOfBody,
    ) -> BodyContact:
        """Between two contact surfaces whose meshes' coordinates are F and T.

        Args:
            name: of the contact.
            model: made of these meshes, or learned from them.
            surfaces: as :func:`condyle.model.surface_files` finds them.
            moving: surface in F.
            fixed: surface in T.
            side_of_body: of the joint.

        Raises:
            InputDataError: a surface is not there, or nothing says where it is on its body.
        """
        moving_body, X_BF = placed_surface(name, surfaces, moving)
        fixed_body, X_BT = placed_surface(name, surfaces, fixed)
        return cls(
            name=name,
            model=model,
            moving_body=moving_body,
            fixed_body=fixed_body,
            X_BF=X_BF,
            X_BT=X_BT,
            side_of_body=side_of_body,
        )

    def core(self) -> _fdk.BodyContact:
        """As the C++ core has it."""
        return _fdk.BodyContact(
            self.name,
            self.model,
            self.moving_body,
            self.fixed_body,
            np.ascontiguousarray(self.X_BF, dtype=np.float64),
            np.ascontiguousarray(self.X_BT, dtype=np.float64),
            _common.side_of_body(self.side_of_body),
        )


def placed_surface(
    contact: str, surfaces: Mapping[str, SurfaceFile], name: str
) -> tuple[str, Array]:
    """Body that a surface is on, and (4, 4) its mesh's coordinates in it.

    Args:
        contact: for messages.
        surfaces: as :func:`condyle.model.surface_files` finds them.
        name: of the surface.

    Raises:
        InputDataError: as :meth:`BodyContact.between`.
    """
    if name not in surfaces:
        raise InputDataError(
            f"contact {contact!r}: no mesh of surface {name!r} (there are: {', '.join(surfaces) or 'none'}): name a "
            "JSON file of contact_surfaces (docs/simulation.md)"
        )
    surface = surfaces[name]
    if surface.body is None:
        raise InputDataError(
            f"contact {contact!r}: surface {name!r} ({surface.file}) needs body and placement of a mesh in Condyle's "
            "axes (x anterior, y superior, z right): name a JSON file of contact_surfaces, or the model's own file if "
            "its meshes are in these axes (docs/simulation.md)"
        )
    return surface.body, surface.placement
