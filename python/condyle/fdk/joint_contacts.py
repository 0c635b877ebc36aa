# SPDX-License-Identifier: Apache-2.0
"""The contacts of a knee in a musculoskeletal model, by the name of what evaluates them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal

from condyle._core.contact import ContactModel
from condyle._core.geometry import content_hash
from condyle.contact.contact_pair import ContactPair
from condyle.contact.laws import ContactLaw, LinearVolumeLaw
from condyle.contact.mesh_contact import MeshContact
from condyle.contact.mesh_files import read_mesh
from condyle.conventions import SideOfBody
from condyle.errors import InputDataError
from condyle.fdk.body_contact import BodyContact, placed_surface
from condyle.model import JointSurfaces, SurfaceFile
from condyle.surrogate import HybridContactModel, OnnxContactModel
from condyle.surrogate.same_contact import require_same_law, require_same_meshes
from condyle.whole_files import content_hash as bytes_hash

ContactKind = Literal["exact", "fast", "surrogate", "hybrid"]
TIBIOFEMORAL: Final = "tibiofemoral"
PATELLOFEMORAL: Final = "patellofemoral"


@dataclass(frozen=True, kw_only=True)
class ReferenceSettings:
    """How the meshes' own contact is evaluated.

    Attributes:
        law: W(d), see :mod:`condyle.contact.laws`.
        plausible_depth: beyond which an overlap is flagged [m].
        cache_directory: where ``fast`` keeps its distance fields between runs, and its measured error, which is then
            told; None: nothing is kept or measured.
    """

    law: ContactLaw = field(default_factory=LinearVolumeLaw)
    plausible_depth: float = 2e-3
    cache_directory: str | PathLike[str] | None = None


@dataclass(frozen=True, kw_only=True)
class JointContact:
    """A contact of a simulation, and what it was made from.

    Attributes:
        contact: for :func:`condyle.fdk.simulate_trial`.
        kind: what evaluates it while equilibrium is sought.
        reference: the meshes' own contact, for pressures; None where no meshes are at hand or none are wanted.
        identity: surfaces, meshes by content, law, surrogate: plain values, for a record.
    """

    contact: BodyContact
    kind: ContactKind
    reference: MeshContact | ContactPair | None
    identity: Mapping[str, Any]


def tibiofemoral_contact(
    surfaces: Mapping[str, SurfaceFile],
    joint: JointSurfaces,
    side_of_body: SideOfBody,
    kind: ContactKind = "fast",
    *,
    settings: ReferenceSettings | None = None,
    surrogate: OnnxContactModel | None = None,
    pressures: bool | None = None,
) -> JointContact:
    """Femoral component (F) on insert (T).

    Args:
        surfaces: as :func:`condyle.model.surface_files` finds them; the insert is one mesh, split at z = 0.
        joint: which of them.
        side_of_body: of the knee.
        kind: ``surrogate`` needs no meshes, the others do; ``hybrid`` is the surrogate, ``fast`` where it does not
            trust itself, and a blend in between.
        settings: of the meshes' own contact.
        surrogate: for ``surrogate`` and ``hybrid``; where meshes are at hand it has to be of these.
        pressures: make a reference for them, ``exact`` beside a surrogate. None: where meshes are at hand.

    Raises:
        ValueError: a surface or mesh is missing or no such part of a knee; a surrogate is missing, one too many,
            without stiffness, of other meshes or of another law; the text names it.
    """
    settings = settings or ReferenceSettings()
    _require_matching(kind, surrogate, side_of_body)
    files = _files(TIBIOFEMORAL, surfaces, {"femur": joint.femur, "insert": joint.insert})
    meshes = {part: file for part, file in files.items() if file is not None}
    if kind != "surrogate" or pressures:
        _require_meshes(TIBIOFEMORAL, kind, files)
    reference = None
    if len(meshes) == len(files):
        reference = MeshContact.from_files(
            femur=meshes["femur"],
            insert=meshes["insert"],
            units="m",
            side_of_body=side_of_body,
            law=settings.law,
            evaluation="fast" if kind in ("fast", "hybrid") else "exact",
            plausible_depth=settings.plausible_depth,
            cache_directory=settings.cache_directory if kind in ("fast", "hybrid") else None,
        )
    model = _model(kind, reference, surrogate)
    contact = BodyContact.between(
        TIBIOFEMORAL, model, surfaces, joint.femur, joint.insert, side_of_body
    )
    identity = _identity(contact, kind, joint.femur, joint.insert)
    if reference is not None:
        identity["meshes"] = reference.mesh_hashes()
        identity["reference"] = _law(settings, reference.settings.pair.evaluation.name)
        if settings.cache_directory is not None and (error := reference.fast_error) is not None:
            identity["reference"]["error_against_exact"] = error.sentence()
    if surrogate is not None:
        identity["surrogate"] = _surrogate(surrogate, reference, meshes, settings.law)
    return JointContact(
        contact=contact,
        kind=kind,
        reference=None if pressures is False else reference,
        identity=identity,
    )


def patellofemoral_contact(
    surfaces: Mapping[str, SurfaceFile],
    joint: JointSurfaces,
    side_of_body: SideOfBody,
    evaluation: Literal["exact", "fast"] = "fast",
    *,
    settings: ReferenceSettings | None = None,
    pressures: bool = True,
) -> JointContact:
    """Femoral component (F, moving) against patellar button (T, fixed), over the button's faces.

    Args:
        surfaces: as for :func:`tibiofemoral_contact`.
        joint: with a patella.
        side_of_body: of the knee.
        evaluation: of the meshes.
        settings: likewise.
        pressures: keep the pair as the reference.

    Raises:
        ValueError: as :func:`tibiofemoral_contact`; ``joint`` has no patella.
    """
    settings = settings or ReferenceSettings()
    if joint.patella is None:
        raise InputDataError(f"contact {PATELLOFEMORAL!r}: no surface of a patella is named")
    files = _files(PATELLOFEMORAL, surfaces, {"femur": joint.femur, "patella": joint.patella})
    _require_meshes(PATELLOFEMORAL, evaluation, files)
    meshes = {part: read_mesh(file, "m") for part, file in files.items() if file is not None}
    pair = ContactPair(
        meshes["femur"],
        {"patella": meshes["patella"]},
        law=settings.law,
        evaluation=evaluation,
        cache_directory=settings.cache_directory if evaluation == "fast" else None,
    )
    contact = BodyContact.between(
        PATELLOFEMORAL,
        pair.as_contact_model(side_of_body, plausible_depth=settings.plausible_depth),
        surfaces,
        joint.femur,
        joint.patella,
        side_of_body,
    )
    identity = _identity(contact, evaluation, joint.femur, joint.patella)
    identity["meshes"] = {name: content_hash(mesh) for name, mesh in meshes.items()}
    identity["reference"] = _law(settings, evaluation)
    return JointContact(
        contact=contact,
        kind=evaluation,
        reference=pair if pressures else None,
        identity=identity,
    )


def _require_matching(
    kind: ContactKind, surrogate: OnnxContactModel | None, side_of_body: SideOfBody
) -> None:
    if kind not in ("surrogate", "hybrid"):
        if surrogate is not None:
            raise InputDataError(
                f"{surrogate.file}: does not go with contact {kind!r}: must be surrogate or hybrid"
            )
        return
    if surrogate is None:
        raise InputDataError(f"contact {kind!r} needs a surrogate file")
    if not surrogate.has_stiffness:
        raise InputDataError(
            f"{surrogate.file}: holds wrenches only: a simulation needs stiffness and trust too, which are in the "
            "full file"
        )
    if surrogate.side_of_body.name != side_of_body:
        raise InputDataError(
            f"{surrogate.file}: metadata condyle.side_of_body is {surrogate.side_of_body.name!r}: must be "
            f"{side_of_body!r} as the knee"
        )


def _files(
    contact: str, surfaces: Mapping[str, SurfaceFile], names: Mapping[str, str]
) -> dict[str, Path | None]:
    """Mesh files by part of the joint; of surfaces that are placed."""
    for name in names.values():
        placed_surface(contact, surfaces, name)
    return {part: surfaces[name].file for part, name in names.items()}


def _require_meshes(contact: str, kind: ContactKind, files: Mapping[str, Path | None]) -> None:
    for part, file in files.items():
        if file is None:
            raise InputDataError(
                f"contact {contact!r}: the {part}'s surface has no mesh: {kind} contact with pressures needs one"
                if kind == "surrogate"
                else f"contact {contact!r}: the {part}'s surface has no mesh: {kind} contact needs one"
            )


def _surrogate(
    surrogate: OnnxContactModel,
    reference: MeshContact | None,
    meshes: Mapping[str, Path],
    law: ContactLaw,
) -> dict[str, Any]:
    """The surrogate by content; refuses one of another contact than the reference."""
    compared = False
    if reference is not None:
        compared = require_same_meshes(surrogate, reference, meshes)
        require_same_law(surrogate, law)
    return {
        "name": surrogate.file.name,
        "sha256": bytes_hash(surrogate.file.read_bytes()),
        "architecture": surrogate.metadata["condyle.architecture"],
        "meshes_compared": compared,
    }


def _model(
    kind: ContactKind, reference: MeshContact | None, surrogate: OnnxContactModel | None
) -> ContactModel:
    if surrogate is None:
        assert reference is not None
        return reference
    if kind == "surrogate":
        return surrogate
    assert reference is not None
    return HybridContactModel(surrogate, reference)


def _identity(contact: BodyContact, kind: str, moving: str, fixed: str) -> dict[str, Any]:
    return {
        "name": contact.name,
        "contact": kind,
        "side_of_body": contact.side_of_body,
        "moving": {
            "surface": moving,
            "body": contact.moving_body,
            "placement": contact.X_BF.tolist(),
        },
        "fixed": {"surface": fixed, "body": contact.fixed_body, "placement": contact.X_BT.tolist()},
    }


def _law(settings: ReferenceSettings, evaluation: str) -> dict[str, Any]:
    return {
        "evaluation": evaluation,
        "law": settings.law.describe(),
        "plausible_depth_m": settings.plausible_depth,
    }
