# SPDX-License-Identifier: Apache-2.0
"""The body of a study: its model, where the implant is in it, and the patella's contact, made when first needed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from condyle.errors import InputDataError
from condyle.study.body_sections import BodySection, TrialSection
from condyle.study.run_directory import digest_of_file

if TYPE_CHECKING:
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
        return joint_surfaces(
            self.model,
            femur=section.femur,
            insert=section.insert,
            patella=section.patella or NO_PATELLA,
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
        """The patella's contact, by the meshes; None: the model has none, or the study wants none.

        Raises:
            InputDataError: it would meet another femoral component than the study's.
        """
        from condyle.contact import content_hash, read_mesh
        from condyle.fdk import ReferenceSettings, patellofemoral_contact

        if self.joint.patella is None:
            return None
        place = self.surfaces[self.joint.femur]
        own = read_mesh(self.context.directory.implant / "femur.stl", "m")
        if place.file is None or content_hash(read_mesh(place.file, "m")) != content_hash(own):
            raise InputDataError(
                f"{self.section.surfaces}: the mesh of surface {self.joint.femur!r} ({place.file}) is not the study's "
                "femoral component (implant.femur): the patella would meet another one"
            )
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
        return {
            "model": self.model_file,
            "surfaces": self.section.surfaces,
            "motion": self.motion_file(name, trial),
            "external_loads": trial.external_loads,
            "external_loads_table": external_loads_table(trial.external_loads),
            "paths": self.paths_file(name, trial),
        }

    def digests(self, name: str, trial: TrialSection) -> dict[str, str]:
        """Content of these files."""
        files = self.input_files(name, trial)
        return {what: digest_of_file(file) for what, file in files.items() if file is not None}


def external_loads_table(file: Path | None) -> Path | None:
    """The table that an external-loads file names, if it does and it is there."""
    import xml.etree.ElementTree as ElementTree

    if file is None:
        return None
    try:
        named = ElementTree.parse(file).findtext(".//datafile")
    except (OSError, ElementTree.ParseError):
        return None  # whoever reads the file for its loads says what is wrong with it
    table = None if named is None else file.parent / named.strip()
    return table if table is not None and table.is_file() else None
