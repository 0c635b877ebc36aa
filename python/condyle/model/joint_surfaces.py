# SPDX-License-Identifier: Apache-2.0
"""Which of a model's contact surfaces are the femur's, the tibia's and the patella's."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Final

from condyle._core.io import model_text
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel

#: What a surface or its body is called, in lower case, by the bone that it belongs to.
_WORDS: Final = {
    "femur": ("femur", "femor", "thigh"),
    "tibia": ("tibia", "insert", "shank", "tray"),
    "patella": ("patella", "button"),
}
#: Said instead of a surface's name.
NO_PATELLA: Final = "none"


@dataclass(frozen=True)
class JointSurfaces:
    """The contact surfaces of a knee, by name.

    Attributes:
        femur: on the femoral component.
        insert: on the insert, both compartments.
        patella: on the patellar button; None: no patellofemoral contact.
    """

    femur: str
    insert: str
    patella: str | None


@dataclass(frozen=True)
class _Pair:
    name: str
    surfaces: tuple[str, str]

    def beside(self, surface: str) -> str | None:
        """The other surface of the pair; None where it is not of this pair."""
        if surface not in self.surfaces:
            return None
        return self.surfaces[1 - self.surfaces.index(surface)]


def joint_surfaces(
    model: MusculoskeletalModel,
    *,
    femur: str | None = None,
    insert: str | None = None,
    patella: str | None = None,
) -> JointSurfaces:
    """Names that are given, and for the others what the model's contact pairs say.

    A pair says it where it alone joins a femur and a tibia, or this femur and a patella: by words in the
    names of the surfaces and of the bodies that they are on.

    Args:
        model: with contact surfaces.
        femur: surface of the femoral component.
        insert: surface of the insert.
        patella: surface of the patellar button; ``none``: no patellofemoral contact.

    Raises:
        InputDataError: a surface that the model has not, or more than one choice; names the surfaces.
    """
    names = list(model.core.contact_surface_names)
    for name in (femur, insert, None if patella == NO_PATELLA else patella):
        if name is not None and name not in names:
            raise InputDataError(
                f"model {model.name!r} has no contact surface {name!r}: must be one of {', '.join(names) or 'none'}"
            )
    content = json.loads(model_text(model.core.description))
    pairs = [
        _Pair(pair["name"], (pair["first"], pair["second"]))
        for pair in content.get("contact_pairs", [])
    ]
    bones = {surface["name"]: _bone(surface) for surface in content.get("contact_surfaces", [])}
    if femur is None or insert is None:
        femur, insert = _knee(model, pairs, bones, femur, insert)
    if femur == insert:
        raise InputDataError(f"femur and insert are both {femur!r}: must be two surfaces")
    if patella == NO_PATELLA:
        return JointSurfaces(femur, insert, None)
    return JointSurfaces(femur, insert, patella or _patella(model, pairs, bones, femur))


def _bone(surface: dict[str, Any]) -> str | None:
    """What the surface's own name says; where that says nothing, its body's."""
    for text in (surface["name"].lower(), surface["frame"]["body"].lower()):
        found = {bone for bone, words in _WORDS.items() if any(word in text for word in words)}
        if len(found) == 1:
            return found.pop()
    return None


def _knee(
    model: MusculoskeletalModel,
    pairs: list[_Pair],
    bones: dict[str, str | None],
    femur: str | None,
    insert: str | None,
) -> tuple[str, str]:
    """The pair of a femur and a tibia; of one that is given, its partner."""
    found: dict[str, tuple[str, str]] = {}
    for pair in pairs:
        for first in pair.surfaces:
            second = pair.beside(first)
            assert second is not None
            is_femur = first == femur if femur is not None else bones[first] == "femur"
            is_insert = second == insert if insert is not None else bones[second] == "tibia"
            if is_femur and is_insert:
                found[pair.name] = (first, second)
    if len(found) == 1:
        return next(iter(found.values()))
    wanted = " and ".join(
        name for name, given in (("femur", femur), ("insert", insert)) if given is None
    )
    surfaces = ", ".join(model.core.contact_surface_names) or "none"
    if not found:
        raise InputDataError(
            f"{wanted}: model {model.name!r} has no contact pair that says which surface that is; name it "
            f"(surfaces: {surfaces})"
        )
    raise InputDataError(f"{wanted}: model {model.name!r} has {_said(found)}; name the surfaces")


def _patella(
    model: MusculoskeletalModel, pairs: list[_Pair], bones: dict[str, str | None], femur: str
) -> str | None:
    found = {
        pair.name: (femur, other)
        for pair in pairs
        if (other := pair.beside(femur)) is not None and bones[other] == "patella"
    }
    if len(found) > 1:
        raise InputDataError(
            f"patella: model {model.name!r} has {_said(found)}; name the surface, or {NO_PATELLA}"
        )
    return next(iter(found.values()))[1] if found else None


def _said(found: dict[str, tuple[str, str]]) -> str:
    listed = "; ".join(f"{name}: {a}, {b}" for name, (a, b) in found.items())
    return f"{len(found)} such contact pairs ({listed})"
