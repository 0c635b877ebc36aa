# SPDX-License-Identifier: Apache-2.0
"""What every stage of a study works with: settings, paths, and the reference contact, made when first needed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from condyle.errors import CondyleError
from condyle.study.reporter import Reporter
from condyle.study.run_directory import RunDirectory, digest_of_file
from condyle.study.schema import Study

if TYPE_CHECKING:
    from condyle.activities import LoadCase
    from condyle.contact import ContactLaw, MeshContact
    from condyle.contact.mesh_contact import IntegrationName
    from condyle.study.activity import Activity
    from condyle.study.body import StudyBody


@dataclass(frozen=True)
class StudyContext:
    """A study being run.

    Attributes:
        study: its settings.
        directory: its run directory.
        threads: for contact and sampling; 0 means all cores. No result depends on it.
        reporter: told of progress.
        scheduler: address of a Dask scheduler whose workers evaluate the samples; None: this machine does. No result
            depends on it either.
    """

    study: Study
    directory: RunDirectory
    threads: int
    reporter: Reporter
    scheduler: str | None = None

    @cached_property
    def reference(self) -> MeshContact:
        """The reference contact of the run's own implant files."""
        contact = self.study.contact
        return self._mesh_contact(contact.law.make(), contact.integration)

    @cached_property
    def pressure_contact(self) -> MeshContact:
        """The contact for pressure maps, over the insert's faces: under ``pressure_law`` if the study names one."""
        contact = self.study.contact
        if contact.pressure_law is None and contact.integration == "insert":
            return self.reference
        return self._mesh_contact((contact.pressure_law or contact.law).make(), "insert")

    def _mesh_contact(self, law: ContactLaw, integration: IntegrationName) -> MeshContact:
        from condyle.contact import MeshContact

        contact = self.study.contact
        return MeshContact.from_files(
            femur=self.directory.implant / "femur.stl",
            insert_medial=self.directory.implant / "insert_medial.stl",
            insert_lateral=self.directory.implant / "insert_lateral.stl",
            units="m",
            side_of_body=self.study.implant.side_of_body,
            law=law,
            evaluation=contact.evaluation,
            integration=integration,
            plausible_depth=1e-3 * contact.plausible_depth_mm,
            cache_directory=self.directory.cache,
            field_spacing=1e-3 * contact.field_spacing_mm,
        )

    @cached_property
    def load_cases(self) -> dict[str, LoadCase]:
        """The study's activities by name."""
        from condyle.activities import load_case

        cases = [load_case(activity) for activity in self.study.activities]
        return {case.name: case for case in cases}

    @cached_property
    def body(self) -> StudyBody:
        """The body around the knee, of a study that has one."""
        from condyle.study.body import StudyBody

        assert self.study.body is not None
        return StudyBody(self, self.study.body)

    @cached_property
    def activities(self) -> dict[str, Activity]:
        """All that is simulated, by name: load cases of the knee simulator, then trials of the body."""
        from condyle.study.simulate import LoadCaseActivity
        from condyle.study.trial_activity import TrialActivity

        found: dict[str, Activity] = {
            name: LoadCaseActivity(case, self) for name, case in self.load_cases.items()
        }
        for name, trial in self.study.trials.items():
            found[name] = TrialActivity(name, trial, self.body)
        return found

    def outputs_of(self, stage: str) -> dict[str, str]:
        """Digests of what an earlier stage made.

        Raises:
            CondyleError: it has not finished.
        """
        outputs = self.directory.stage_outputs(stage)
        if outputs is None:
            raise CondyleError(f"{self.directory.root}: stage '{stage}' has not finished")
        return outputs

    @property
    def samples_directory(self) -> Path:
        """The dataset: the run's own, or the one that the study names."""
        return self.study.sampling.dataset or self.directory.samples

    def activity_digests(self) -> dict[str, Any]:
        """What the activities are: the content of all files that they are read from."""
        from condyle.activities import load_case_file

        found: dict[str, Any] = {
            a: digest_of_file(load_case_file(a)) for a in self.study.activities
        }
        for name, trial in self.study.trials.items():
            found[name] = self.body.digests(name, trial) | {
                "window": [trial.start_s, trial.end_s, trial.negligible_force_N]
            }
        return found

    def identity(self) -> dict[str, Any]:
        """What a sample or a surrogate of this study is of: implant meshes and contact law, by content.

        Of samples from elsewhere, what their own manifest says, with their provenance.
        """
        if self.study.sampling.dataset is not None:
            from condyle.sampling.manifest import read_manifest

            manifest = read_manifest(self.samples_directory)
            return {**manifest["identity"], "provenance": manifest.get("provenance")}
        contact = self.study.contact
        return {
            "side_of_body": self.study.implant.side_of_body,
            "implant": {
                name.removeprefix("implant/"): digest
                for name, digest in self.outputs_of("implant").items()
                if name.endswith(".stl")
            },
            "contact_law": {
                **contact.law.make().describe(),
                "evaluation": contact.evaluation,
                "integration": contact.integration,
                "plausible_depth": 1e-3 * contact.plausible_depth_mm,
                # The triangles themselves have no field.
                **(
                    {"field_spacing": 1e-3 * contact.field_spacing_mm}
                    if contact.evaluation == "fast"
                    else {}
                ),
            },
        }
