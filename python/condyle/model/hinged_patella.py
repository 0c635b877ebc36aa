# SPDX-License-Identifier: Apache-2.0
"""The patella of Marra et al. 2017: on an ideal hinge of the femur, held by an elastic patellar ligament.

    "we replaced the patellofemoral (PF) joint with an ideal revolute joint and let the only DOF of patella be
    controlled by an elastic patellar ligament (stiffness 1187 N/mm)"       (doi:10.1115/1.4036605)

The paper does not say where the axis is, where on it the patella lies, nor how long the ligament is. Here:

- the axis is that of the cylinder nearest to the trochlea of the femoral component (:mod:`condyle.model.trochlea`);
- at rest the patella is as the model's default posture has it, its button moved along the axis and towards it until it
  is seated in the groove (:mod:`condyle.model.button_seat`): there the turn has the default of the coordinate that it
  takes over;
- the ligament is one line amid the model's strands between patella and tibia: a bundle as wide would hold the tibia
  against turning on a patella that cannot tilt. It is just taut, without force, at the default posture with the patella
  at rest: so it holds the patella at the height that the model gives it, and its stiffness alone decides how far a pull
  raises it. It does not push;
- the patella's mass rides on the femur, where the patella is at rest: the ligament controls the turn, not the weight.
  With it, a patella that nothing pulls would hang from the passive muscles, with a slack ligament and hardly any
  stiffness to find its place by.

The patellofemoral contact is left out: the hinge carries its load. Everything else stays, the ligaments from femur to
patella, too; what they do across the axis the hinge takes.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle._core.geometry import Mesh
from condyle._core.io import model_text, parse_model
from condyle.errors import InputDataError
from condyle.model.button_seat import ButtonSeat, seat_button
from condyle.model.carried_mass import carry_mass
from condyle.model.hinge_joint import (
    Hinge,
    HingeCoordinates,
    joint_coordinates,
    joint_of,
    make_hinge,
    placement_index,
    relative_placement,
)
from condyle.model.joint_surfaces import JointSurfaces
from condyle.model.musculoskeletal_model import MusculoskeletalModel
from condyle.model.patellar_ligament import PatellarLine, make_taut, patellar_strands, put_line
from condyle.model.surface_files import SurfaceFile
from condyle.model.trochlea import Trochlea, fit_trochlea

Array = NDArray[np.float64]
Content = dict[str, Any]

#: Of the patellar ligament, Marra et al. 2017 [N/m].
PATELLAR_LIGAMENT_STIFFNESS: Final = 1.187e6


@dataclass(frozen=True)
class HingedPatella:
    """A model whose patella turns about one axis fixed in the femur, and how it came about.

    Attributes:
        model: the new one.
        trochlea: what the axis was fitted to, in the coordinates of the femoral component's mesh.
        seat: where the button lies, in the same.
        hinge: the axis, and the patella at rest, in the femur's body.
        coordinates: the turn, and what follows it.
        ligament: the patellar one, and the strands that it stands for.
        stiffness: its [N/m].
        slack_length: its [m].
        contact_pairs: names of those that the hinge replaces.
    """

    model: MusculoskeletalModel
    trochlea: Trochlea
    seat: ButtonSeat
    hinge: Hinge
    coordinates: HingeCoordinates
    ligament: PatellarLine
    stiffness: float
    slack_length: float
    contact_pairs: tuple[str, ...]

    def text(self) -> str:
        """Content of the model file."""
        return str(model_text(self.model.core.description))


@dataclass(frozen=True)
class _Placed:
    """A mesh, the body that it is on, and where."""

    name: str
    mesh: Mesh
    body: str
    X_BS: Array


def hinge_patella(
    model: MusculoskeletalModel,
    surfaces: Mapping[str, SurfaceFile],
    joint: JointSurfaces,
    *,
    stiffness: float = PATELLAR_LIGAMENT_STIFFNESS,
) -> HingedPatella:
    """Puts the patella on a hinge fitted to the trochlea, and its ligament on a linear law.

    Args:
        model: whose patella hangs on the femur by six force-dependent coordinates.
        surfaces: with meshes of femoral component and button in Condyle's axes, placed on their bodies
            (:func:`condyle.model.surface_files`).
        joint: which of them; the insert's says which body the tibia is, its mesh is not read.
        stiffness: of the patellar ligament [N/m].

    Raises:
        InputDataError: a surface without mesh or placement; a patella of another kind; no patellar ligament; a mesh
            that is no trochlea, or a button that does not lie in it; says names, values and limits.
    """
    if not (math.isfinite(stiffness) and stiffness > 0.0):
        raise InputDataError(f"stiffness {stiffness:g} N/m: must be above 0")
    if joint.patella is None:
        raise InputDataError(f"model {model.name!r}: no surface of a patella is named")
    content: Content = json.loads(model_text(model.core.description))
    femur, patella = (_placed(surfaces, name) for name in (joint.femur, joint.patella))
    hung = joint_of(content, patella.body)
    if hung["parent"]["body"] != femur.body:
        raise InputDataError(
            f"model {model.name!r}: {patella.body!r} hangs on {hung['parent']['body']!r}: must hang on {femur.body!r}, "
            f"which surface {femur.name!r} is on"
        )
    joint_coordinates(content, hung)
    tibia = _tibia(content, joint.insert)
    strands = patellar_strands(content, patella.body, tibia)
    trochlea = fit_trochlea(femur.mesh, femur.name)
    seat, hinge = _seated(model, femur, patella, trochlea)
    coordinates = make_hinge(model, content, hung, hinge)
    carry_mass(content, patella.body, femur.body, hinge.X_BC)
    ligament = put_line(content, strands, patella.body, tibia, stiffness)
    pairs = _without_contact(content, {femur.name, patella.name})
    slack_length = make_taut(content, _compiled(content, model), ligament)
    fit = trochlea.cylinder
    done = (
        f"{patella.body} on a hinge of {femur.body}: the axis of a cylinder of {1e3 * fit.radius:.3f} mm fitted to "
        f"{fit.points} faces of {femur.name}, RMS {1e3 * fit.rms:.3f} mm"
    )
    _say(content, done, _changed(coordinates, ligament, pairs, patella.body, femur.body))
    return HingedPatella(
        model=_compiled(content, model),
        trochlea=trochlea,
        seat=seat,
        hinge=hinge,
        coordinates=coordinates,
        ligament=ligament,
        stiffness=stiffness,
        slack_length=slack_length,
        contact_pairs=pairs,
    )


def _placed(surfaces: Mapping[str, SurfaceFile], name: str) -> _Placed:
    # At the top this would be a circle: condyle.contact seats implants with condyle.fdk, which knows models.
    from condyle.contact import read_mesh

    if name not in surfaces or surfaces[name].file is None:
        known = ", ".join(key for key, value in surfaces.items() if value.file is not None)
        raise InputDataError(f"no mesh of surface {name!r} (there are: {known or 'none'})")
    surface = surfaces[name]
    if surface.body is None:
        raise InputDataError(
            f"surface {name!r} ({surface.file}) needs body and placement of a mesh in Condyle's axes (x anterior, y "
            "superior, z right): name a JSON file of contact_surfaces, or the model's own file if its meshes are in "
            "these axes (docs/simulation.md)"
        )
    assert surface.file is not None
    return _Placed(name, read_mesh(surface.file, "m"), surface.body, surface.placement)


def _tibia(content: Content, insert: str) -> str:
    surfaces = content.get("contact_surfaces", [])
    return str(next(s["frame"]["body"] for s in surfaces if s["name"] == insert))


def _seated(
    model: MusculoskeletalModel, femur: _Placed, patella: _Placed, trochlea: Trochlea
) -> tuple[ButtonSeat, Hinge]:
    X_BC = relative_placement(
        model,
        model.default_q(),
        placement_index(model, femur.body),
        placement_index(model, patella.body),
    )
    axis, centre = trochlea.cylinder.axis, trochlea.cylinder.centre
    X_FP = np.linalg.inv(femur.X_BS) @ X_BC @ patella.X_BS
    seat = seat_button(femur.mesh, patella.mesh, X_FP, axis, centre, patella.name)
    # The hinge's frame is beside the button: z the axis, x to the button.
    button = seat.X_FP[:3, 3]
    origin = centre + ((button - centre) @ axis) * axis
    x = (button - origin) / np.linalg.norm(button - origin)
    X_FH = np.eye(4)
    X_FH[:3, :3] = np.stack([x, np.cross(axis, x), axis], axis=1)
    X_FH[:3, 3] = origin
    return seat, Hinge(
        X_BH=femur.X_BS @ X_FH, X_BC=femur.X_BS @ seat.X_FP @ np.linalg.inv(patella.X_BS)
    )


def _without_contact(content: Content, surfaces: set[str]) -> tuple[str, ...]:
    """Names of the pairs of these two surfaces, which are taken out."""
    pairs = content.get("contact_pairs", [])
    gone = [pair["name"] for pair in pairs if {pair["first"], pair["second"]} == surfaces]
    content["contact_pairs"] = [pair for pair in pairs if pair["name"] not in gone]
    return tuple(gone)


def _changed(
    coordinates: HingeCoordinates,
    ligament: PatellarLine,
    pairs: tuple[str, ...],
    patella: str,
    femur: str,
) -> dict[str, tuple[str, ...]]:
    """Names by what has become of them."""
    others = tuple(name for name in ligament.strands if name != ligament.name)
    return {
        f"coordinates that follow {coordinates.turn} and move nothing": coordinates.followers,
        f"stiffness of the patellar ligament's strands ({ligament.name} has it)": others,
        "contact whose place the hinge takes": pairs,
        f"mass, which is on {femur}": (patella,),
    }


def _say(content: Content, done: str, changed: dict[str, tuple[str, ...]]) -> None:
    """In the model file's own places for it: its source, and what is not as it was."""
    content["source"] = "; ".join(filter(None, [content.get("source"), done]))
    sentences = [f"{what}: {', '.join(names)}" for what, names in changed.items() if names]
    content["not_supported"] = [*content.get("not_supported", []), *sentences]


def _compiled(content: Content, model: MusculoskeletalModel) -> MusculoskeletalModel:
    source = f"{model.name}, patella on a hinge"
    return MusculoskeletalModel(parse_model(json.dumps(content), source), model.folder)
