# SPDX-License-Identifier: Apache-2.0
"""The body of a study: its model, where the implant is in it, and the patella's contact, made when first needed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from condyle.errors import InputDataError
from condyle.study.body_sections import BodySection, TrialSection
from condyle.study.run_directory import digest_of_file

if TYPE_CHECKING:
    from condyle.contact import Mesh
    from condyle.conventions import SideOfBody
    from condyle.fdk import JointContact
    from condyle.model import (
        JointSurfaces,
        MuscleSettings,
        MusculoskeletalModel,
        SurfaceFile,
        Trial,
    )
    from condyle.study.context import StudyContext

#: Corners this near to each other are the same: single precision at a tenth of a metre is 1e-8 [m].
_SAME: Final = 1e-6


@dataclass(frozen=True)
class StudyBody:
    """What all trials of a study share.

    Attributes:
        context: the study; its stage ``body`` has run.
        section: its section.
    """

    context: StudyContext
    section: BodySection

    @property
    def folder(self) -> Path:
        """Where stage ``body`` puts the model, and what it makes for each trial."""
        return self.context.directory.root / "body"

    @property
    def model_file(self) -> Path:
        """The model that is simulated."""
        return self.folder / "model.json"

    def motion_file(self, name: str, trial: TrialSection) -> Path:
        """A trial's coordinates: the study's file, or those from its markers."""
        return trial.motion or self.folder / name / "coordinates.sto"

    def paths_file(self, name: str, trial: TrialSection) -> Path | None:
        """Its path snapshots: the study's, those made from OpenSim's model, or none."""
        if trial.paths is not None or not self.section.imported:
            return trial.paths
        return self.folder / name / "paths.json"

    @cached_property
    def model(self) -> MusculoskeletalModel:
        """The model that is simulated."""
        from condyle.model import MusculoskeletalModel

        return MusculoskeletalModel.read(self.model_file)

    @cached_property
    def surfaces(self) -> dict[str, SurfaceFile]:
        """Contact surfaces on the model's bodies."""
        from condyle.model import surface_files

        return surface_files(self.model, [self.section.surfaces])

    @cached_property
    def joint(self) -> JointSurfaces:
        """Which of them the knee has."""
        from condyle.model.joint_surfaces import NO_PATELLA, joint_surfaces

        section = self.section
        joint = joint_surfaces(
            self.model,
            femur=section.femur,
            insert=section.insert,
            patella=section.patella or NO_PATELLA,
        )
        self._require_own_femur(joint)
        return joint

    def _require_own_femur(self, joint: JointSurfaces) -> None:
        """A frame is that of its mesh: another femoral component's would put the study's somewhere else.

        Raises:
            InputDataError: the surface's mesh is not the study's; or there is none, and the patella needs one.
        """
        from condyle.contact import read_mesh

        place = self.surfaces.get(joint.femur)
        file = None if place is None else place.file
        if file is None and joint.patella is None:
            return
        own = read_mesh(self.context.directory.implant / "femur.stl", "m")
        if file is None or not _same_mesh(read_mesh(file, "m"), own):
            found = "none is named" if file is None else f"{file} is another one"
            raise InputDataError(
                f"{self.section.surfaces}: the mesh of surface {joint.femur!r} must be the study's femoral component "
                f"(implant.femur): {found}"
            )

    @property
    def side_of_body(self) -> SideOfBody:
        """Of the implant."""
        return self.context.study.implant.side_of_body

    @cached_property
    def muscles(self) -> MuscleSettings:
        """How muscles share load."""
        from condyle.model import MuscleSettings

        section = self.section
        return MuscleSettings(
            criterion=section.criterion,
            strength=section.strength,
            reserve_moment=section.reserve_Nm,
        )

    @cached_property
    def patella(self) -> JointContact | None:
        """The patella's contact, by the meshes; None: the study wants none."""
        from condyle.fdk import ReferenceSettings, patellofemoral_contact

        if self.joint.patella is None:
            return None
        contact = self.context.study.contact
        return patellofemoral_contact(
            self.surfaces,
            self.joint,
            self.side_of_body,
            contact.evaluation,
            settings=ReferenceSettings(
                law=contact.law.make(),
                # A button may sink in deeper than a condyle: its rim is narrow.
                plausible_depth=2e-3 * contact.plausible_depth_mm,
                cache_directory=self.context.directory.cache,
            ),
        )

    def read_trial(self, name: str, trial: TrialSection) -> Trial:
        """Motion, loads and paths of a trial.

        Raises:
            ValueError: files that do not fit, by name.
        """
        from condyle.model import read_trial

        return read_trial(
            self.model,
            self.motion_file(name, trial),
            external_loads=trial.external_loads,
            snapshots=self.paths_file(name, trial),
            start=trial.start_s,
            end=trial.end_s,
            negligible_force=trial.negligible_force_N,
        )

    def input_files(self, name: str, trial: TrialSection) -> dict[str, Path | None]:
        """Every file that a trial's simulation reads, by what it is."""
        from condyle.model.external_loads_table import external_loads_table

        return {
            "model": self.model_file,
            "surfaces": self.section.surfaces,
            "patella_mesh": self._patella_mesh(),
            "motion": self.motion_file(name, trial),
            "external_loads": trial.external_loads,
            "external_loads_table": external_loads_table(trial.external_loads),
            "paths": self.paths_file(name, trial),
        }

    def _patella_mesh(self) -> Path | None:
        place = None if self.section.patella is None else self.surfaces.get(self.section.patella)
        return None if place is None else place.file

    def digests(self, name: str, trial: TrialSection) -> dict[str, str]:
        """Content of these files."""
        files = self.input_files(name, trial)
        return {what: digest_of_file(file) for what, file in files.items() if file is not None}


def _same_mesh(one: Mesh, other: Mesh) -> bool:
    """Whether two meshes have the same faces, to the rounding of file formats and units."""
    a, b = (np.asarray(mesh.vertices)[np.asarray(mesh.faces)] for mesh in (one, other))
    return a.shape == b.shape and np.allclose(a, b, rtol=0.0, atol=_SAME)
