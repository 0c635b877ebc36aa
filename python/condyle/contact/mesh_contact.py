# SPDX-License-Identifier: Apache-2.0
"""The reference contact of two meshes."""

import os
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import contact as _contact
from condyle._core.common import side_of_body as _side_of_body
from condyle._core.geometry import Mesh, content_hash
from condyle.contact.contact_pair import EvaluationName
from condyle.contact.fast_error import FastError, measure_fast_error, stored_fast_error
from condyle.contact.implant_files import read_implant
from condyle.contact.laws import ContactLaw, LinearVolumeLaw
from condyle.contact.layers import FaceLayers, layer_table
from condyle.contact.mesh_files import MeshFile, Units
from condyle.conventions import SideOfBody
from condyle.whole_files import content_hash as bytes_hash

IntegrationName = Literal["insert", "femur", "both"]

#: K = 9.3e9 N/m³ (Marra et al. 2015), for forces and kinematics.
_DEFAULT_LAW = LinearVolumeLaw()


class MeshContact(_contact.MeshContact):
    """Frictionless elastic contact between a femoral component and an insert's two compartments.

    Energy U = Σ A·W(d) over the insert's faces (or the femur's, or the mean of both), d the depth of a face's centroid
    below the other surface; loads are its derivatives. Quasi-static; the bodies are rigid under their surface layer.

    Args:
        femur: surface of the femoral component in the femoral frame, normals out of it.
        insert_medial: medial compartment in the tibial frame, normals out of the insert (up).
        insert_lateral: lateral compartment.
        side_of_body: which knee it is.
        law: W(d), see :mod:`condyle.contact.laws`; by default p = K·d with K = 9.3e9 N/m³ (Marra et al. 2015).
        evaluation: "exact", distances to the triangles themselves, or "fast", through a smooth field of them.
        integration: whose faces are integrated: "insert", "femur", or "both" for their mean.
        plausible_depth: depth beyond which an overlap is flagged [m]; the core's default (2 mm) if not given.
        cache_directory: where "fast" keeps its distance fields between runs, and its measured error.
        field_spacing: edge of a cell of the distance fields of "fast" [m]; the core's default (0.3 mm) if not given.
        femur_layers: the elastic layer under each of the femur's faces, for laws that have one.
        insert_layers: likewise of the medial and the lateral compartment.

    Raises:
        ValueError: a mesh's normals point inwards, sides are swapped, layers do not match, or a setting is out of
            range.
    """

    def __init__(
        self,
        femur: Mesh,
        insert_medial: Mesh,
        insert_lateral: Mesh,
        side_of_body: SideOfBody,
        *,
        law: ContactLaw = _DEFAULT_LAW,
        evaluation: EvaluationName = "exact",
        integration: IntegrationName = "insert",
        plausible_depth: float | None = None,
        cache_directory: str | PathLike[str] | None = None,
        field_spacing: float | None = None,
        femur_layers: FaceLayers | None = None,
        insert_layers: tuple[FaceLayers, FaceLayers] | None = None,
    ) -> None:
        settings = _settings(
            evaluation, integration, plausible_depth, cache_directory, field_spacing
        )
        self._law = law
        side = _side_of_body(side_of_body)
        of_medial, of_lateral = insert_layers if insert_layers is not None else (None, None)
        self._layers = (
            layer_table(femur_layers, len(femur.faces)),
            layer_table(of_medial, len(insert_medial.faces)),
            layer_table(of_lateral, len(insert_lateral.faces)),
        )
        super().__init__(
            femur, insert_medial, insert_lateral, side, law.core, settings, *self._layers
        )
        if cache_directory is not None:
            _ = self.fast_error  # belongs to what is built once and kept

    def __reduce__(self) -> tuple[Any, ...]:
        """What it was made from: surfaces, law and settings; whoever unpickles it makes it again.

        In the other process distance fields are kept where the environment variable CONDYLE_CACHE says; else in this
        contact's cache_directory where that exists, else in the user's cache folder. Without a cache_directory and the
        variable they are kept nowhere.
        """
        pair = self.settings.pair
        kept = pair.cache_directory != Path()
        settings = {
            "evaluation": pair.evaluation.name,
            "integration": pair.integration.name,
            "plausible_depth": self.settings.plausible_depth,
            "cache_directory": str(pair.cache_directory) if kept else None,
            "field_spacing": pair.field_spacing,
        }
        surfaces = tuple(
            (np.array(mesh.vertices), np.array(mesh.faces))
            for mesh in (self.femur, self.insert_medial, self.insert_lateral)
        )
        side = self.side_of_body.name
        return _remade, (type(self), surfaces, side, self._law, self._layers, settings)

    @classmethod
    def from_files(
        cls,
        *,
        femur: MeshFile,
        insert: MeshFile | None = None,
        insert_medial: MeshFile | None = None,
        insert_lateral: MeshFile | None = None,
        units: Units,
        side_of_body: SideOfBody,
        law: ContactLaw = _DEFAULT_LAW,
        evaluation: EvaluationName = "exact",
        integration: IntegrationName = "insert",
        plausible_depth: float | None = None,
        cache_directory: str | PathLike[str] | None = None,
        field_spacing: float | None = None,
    ) -> Self:
        """The contact of an implant in files; arguments as :func:`read_implant` and the class.

        Raises:
            ValueError: as :func:`read_implant` and the class.
        """
        implant = read_implant(
            femur=femur,
            insert=insert,
            insert_medial=insert_medial,
            insert_lateral=insert_lateral,
            units=units,
            side_of_body=side_of_body,
        )
        return cls(
            implant["femur"],
            implant["insert_medial"],
            implant["insert_lateral"],
            side_of_body,
            law=law,
            evaluation=evaluation,
            integration=integration,
            plausible_depth=plausible_depth,
            cache_directory=cache_directory,
            field_spacing=field_spacing,
        )

    @cached_property
    def fast_error(self) -> FastError | None:
        """How far this pair is from its exact evaluation over plausible poses; None if it is exact itself.

        Measured when first asked for, in a few seconds; with a ``cache_directory`` when the contact is made, unless a
        record of this pair is there.
        """
        pair = self.settings.pair
        if pair.evaluation != _contact.Evaluation.fast:
            return None
        spacing = pair.field_spacing

        def measure() -> FastError:
            return measure_fast_error(self, self._exact, spacing=spacing)

        if pair.cache_directory == Path():
            return measure()
        identity = {
            **self.mesh_hashes(),
            "side_of_body": self.side_of_body.name,
            "law": self._law.describe(),
            "layers": [bytes_hash(layer.tobytes()) for layer in self._layers],
            "integration": pair.integration.name,
            "spacing": spacing,
        }
        return stored_fast_error(pair.cache_directory, identity, measure)

    def _exact(self) -> _contact.MeshContact:
        settings = _contact.MeshContactSettings()
        exact = _contact.PairSettings()
        exact.integration = self.settings.pair.integration
        settings.pair = exact
        surfaces = (self.femur, self.insert_medial, self.insert_lateral)
        return _contact.MeshContact(
            *surfaces, self.side_of_body, self._law.core, settings, *self._layers
        )

    def face_pressures(self, pose: ArrayLike) -> list[NDArray[np.float64]]:
        """Pressure of each face [Pa] of the medial and of the lateral compartment.

        Args:
            pose: (6,) one pose [m, rad].
        """
        one = np.ascontiguousarray(pose, dtype=np.float64)
        sides = (_contact.Side.medial, _contact.Side.lateral)
        return [np.asarray(self.face_pressure(one, side)[1]) for side in sides]

    def mesh_hashes(self) -> dict[str, str]:
        """SHA-256 of each surface's content, for metadata."""
        return {
            "femur": content_hash(self.femur),
            "insert_medial": content_hash(self.insert_medial),
            "insert_lateral": content_hash(self.insert_lateral),
        }


def _settings(
    evaluation: EvaluationName,
    integration: IntegrationName,
    plausible_depth: float | None,
    cache_directory: str | PathLike[str] | None,
    field_spacing: float | None = None,
) -> _contact.MeshContactSettings:
    settings = _contact.MeshContactSettings()
    settings.pair.evaluation = _contact.evaluation(evaluation)
    settings.pair.integration = _contact.integration(integration)
    if plausible_depth is not None:
        settings.plausible_depth = plausible_depth
    if cache_directory is not None:
        settings.pair.cache_directory = Path(cache_directory)
    if field_spacing is not None:
        settings.pair.field_spacing = field_spacing
    return settings


def _remade(
    kind: type[MeshContact],
    surfaces: tuple[tuple[NDArray[np.float64], NDArray[np.int32]], ...],
    side_of_body: SideOfBody,
    law: ContactLaw,
    layers: tuple[NDArray[np.float64], ...],
    settings: dict[str, Any],
) -> MeshContact:
    """A contact from what ``__reduce__`` gave; the error of its fast evaluation is measured only if asked for."""
    contact = kind.__new__(kind)
    contact._law = law
    contact._layers = (layers[0], layers[1], layers[2])
    directory = _cache_elsewhere(settings["cache_directory"])
    femur, medial, lateral = (Mesh(vertices, faces) for vertices, faces in surfaces)
    _contact.MeshContact.__init__(
        contact,
        femur,
        medial,
        lateral,
        _side_of_body(side_of_body),
        law.core,
        _settings(**{**settings, "cache_directory": directory}),
        *contact._layers,
    )
    return contact


def _cache_elsewhere(directory: str | None) -> str | None:
    """Where a process that was sent a contact keeps distance fields, see ``MeshContact.__reduce__``."""
    told = os.environ.get("CONDYLE_CACHE")
    if told or directory is None:
        return told or None
    if Path(directory).is_dir():
        return directory
    own = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return str(Path(own) / "condyle")
