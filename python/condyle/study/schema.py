# SPDX-License-Identifier: Apache-2.0
"""What a study file may say: one TOML file that describes implant, contact law, sampling, training and activities.

Every section has defaults, every key its unit and limits; an unknown key is an error. File paths are relative to the
study file.
"""

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from condyle.study.body_sections import BodySection, TrialSection
from condyle.study.curve_sections import ActivityCurvesSection, CurvesSection
from condyle.study.law_sections import LawSection, LinearVolumeSection
from condyle.study.section import Section
from condyle.study.training_section import TrainingSection

Seed = Annotated[int, Field(ge=0, lt=2**63)]
#: Built-in load cases, of the kinds that the paper sampled around (condyle.activities.BUILT_IN; a test compares).
BUILT_IN_ACTIVITIES = (
    "iso_like_gait",
    "turn_like_gait",
    "leg_swing_like",
    "chair_rise_like",
    "squat_like",
)
_SENSITIVE = (["y", "theta_x"], ["y"])
#: Names that are names of folders, too.
_NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]*$"


class ImplantSection(Section):
    """The implant: a parametric preset, or meshes in files.

    Attributes:
        side_of_body: left or right knee; decides which compartment is medial.
        preset: built-in parametric implant, ``curved`` or ``flat``.
        size: scale of the preset (1 is a femoral component about 65 mm from front to back).
        mesh_edge_mm: edge length of the preset's meshes.
        femur: femoral component's surface (STL, OBJ, PLY, OFF), in the femoral frame.
        insert: insert's surface, both compartments, split by face centroid at z = 0; or
        insert_medial, insert_lateral: one surface each.
        units: unit of the mesh files.
    """

    side_of_body: Literal["left", "right"] = "right"
    preset: Literal["curved", "flat"] | None = None
    size: Annotated[float, Field(ge=0.75, le=1.35)] = 1.0
    mesh_edge_mm: Annotated[float, Field(ge=0.2, le=3.0)] | None = None
    femur: Path | None = None
    insert: Path | None = None
    insert_medial: Path | None = None
    insert_lateral: Path | None = None
    units: Literal["m", "mm"] = "mm"

    @model_validator(mode="after")
    def _one_way_to_say_it(self) -> Self:
        files = [
            n for n in ("femur", "insert", "insert_medial", "insert_lateral") if getattr(self, n)
        ]
        if self.preset is not None and files:
            raise ValueError(f"give either preset or mesh files, not both (preset and {files[0]})")
        if self.preset is None:
            if self.femur is None:
                raise ValueError("give a preset, or femur and insert mesh files")
            halves = self.insert_medial is not None and self.insert_lateral is not None
            if (self.insert is not None) == halves or len(files) > 3:
                raise ValueError("give either insert, or both insert_medial and insert_lateral")
        return self


class ContactSection(Section):
    """The contact law and how it is evaluated.

    Attributes:
        law: which law and its parameters, see :mod:`condyle.study.law_sections`; the default serves forces and
            kinematics, not pressure.
        pressure_law: the law for pressure maps alone, at the loads that ``law`` gives; ``law`` itself if not given.
        evaluation: ``fast`` (smooth distance field) or ``exact`` (the triangles themselves).
        field_spacing_mm: cells of that field; finer ones follow the triangles' facets more closely, at more memory.
        integration: whose faces are integrated: ``insert``, ``femur`` or ``both`` (the mean); pressure maps are always
            of the insert's.
        plausible_depth_mm: overlaps deeper than this are flagged, and rejected by sampling.
    """

    law: LawSection = LinearVolumeSection()
    pressure_law: LawSection | None = None
    evaluation: Literal["fast", "exact"] = "fast"
    field_spacing_mm: Annotated[float, Field(ge=0.1, le=2)] = 0.3
    integration: Literal["insert", "femur", "both"] = "insert"
    plausible_depth_mm: Annotated[float, Field(gt=0, le=10)] = 2.0


class SimulatorSection(Section):
    """What holds the knee in the simulator beside the contact: restraint springs, and ligaments if wanted.

    Attributes:
        ap_stiffness_N_per_mm: spring on x about the settled pose (ISO-like).
        ie_stiffness_Nm_per_deg: spring on θy.
        ml_stiffness_N_per_mm: spring on z; simulators leave it free.
        ligaments: add eight Blankevoort bundles with one subject's attachments and stiffnesses; their reference
            strains hold at the settled pose.
    """

    ap_stiffness_N_per_mm: Annotated[float, Field(ge=0, le=1e4)] = 30.0
    ie_stiffness_Nm_per_deg: Annotated[float, Field(ge=0, le=1e3)] = 0.6
    ml_stiffness_N_per_mm: Annotated[float, Field(ge=0, le=1e4)] = 0.0
    ligaments: bool = False


class SamplingSection(Section):
    """The sampling plan.

    Attributes:
        preset: numbers of samples: ``quick`` or ``standard`` (domains 2 to 6), ``paper_tenth`` or ``paper`` (all six).
        targets: numbers by domain, overriding the preset: ``"2" = {train = 5000, test = 900}``; ``train = 0`` leaves
            it out.
        seed: of the design and of the split.
        curves: what to sample around, see :mod:`condyle.study.curve_sections`; the study's activities by default.
        sensitive_directions: where loads are sampled, not the pose: ``["y", "theta_x"]`` (Fy and Mx), ``["y"]`` (Fy,
            and theta_x as part of the pose), or ``auto``: the first, if the contact's stiffness agrees.
        margin_x_mm: reference curves are thickened by ± this in x before the domains are drawn around them.
        margin_z_mm: likewise in z.
        margin_theta_y_deg: likewise in θy.
        dataset: directory of samples that are there already, imported ones for instance (docs/samples.md); nothing is
            sampled then, and no other key of this section goes with it.
    """

    preset: Literal["quick", "standard", "paper_tenth", "paper"] = "quick"
    targets: dict[
        Literal["1", "2", "3", "4", "5", "6"],
        dict[Literal["train", "test"], Annotated[int, Field(ge=0)]],
    ] = Field(default_factory=dict)
    seed: Seed = 2017
    curves: CurvesSection = ActivityCurvesSection()
    sensitive_directions: Literal["auto"] | tuple[str, ...] = "auto"
    margin_x_mm: Annotated[float, Field(ge=0, le=20)] = 1.0
    margin_z_mm: Annotated[float, Field(ge=0, le=20)] = 1.0
    margin_theta_y_deg: Annotated[float, Field(ge=0, le=25)] = 1.0
    dataset: Path | None = None

    @model_validator(mode="after")
    def _samples_or_a_plan(self) -> Self:
        others = sorted(self.model_fields_set - {"dataset"})
        if self.dataset is not None and others:
            raise ValueError(f"{others[0]} does not go with dataset: nothing is sampled")
        return self

    @field_validator("sensitive_directions", mode="before")
    @classmethod
    def _can_be_solved_for(cls, value: Any) -> Any:
        if value == "auto" or (isinstance(value, (list, tuple)) and list(value) in _SENSITIVE):
            return value
        raise ValueError(f'{value!r}: must be "auto", ["y", "theta_x"] or ["y"]')


class SimulateSection(Section):
    """What the activities are simulated with, beside the reference contact.

    Attributes:
        contact: ``surrogate``; ``hybrid``, the surrogate where its trust is high, the reference where it is low, a
            blend between; or both.
    """

    contact: Annotated[tuple[Literal["surrogate", "hybrid"], ...], Field(min_length=1)] = (
        "surrogate",
    )

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        if len(set(self.contact)) != len(self.contact):
            raise ValueError("contact names a model twice")
        return self


class Study(Section):
    """A whole study.

    Attributes:
        name: of the run directory, ``runs/<name>``.
        activities: built-in load cases by name, or CSV files (columns time_s, flexion_deg, axial_force_N,
            ap_force_N, ie_torque_Nm); none, unless named, where there are trials.
        body: the musculoskeletal model that trials are of.
        trials: recorded activities of that body, by name.
    """

    name: Annotated[str, Field(pattern=_NAME)]
    activities: tuple[str, ...] = BUILT_IN_ACTIVITIES
    implant: ImplantSection = ImplantSection(preset="curved")
    contact: ContactSection = ContactSection()
    simulator: SimulatorSection = SimulatorSection()
    sampling: SamplingSection = SamplingSection()
    training: TrainingSection = TrainingSection()
    simulate: SimulateSection = SimulateSection()
    body: BodySection | None = None
    trials: dict[Annotated[str, Field(pattern=_NAME)], TrialSection] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _trials_alone(cls, content: Any) -> Any:
        """Whoever has trials means these."""
        if isinstance(content, dict) and content.get("trials") and "activities" not in content:
            return {**content, "activities": ()}
        return content

    @model_validator(mode="after")
    def _has_activities(self) -> Self:
        if not self.activities and not self.trials:
            raise ValueError("activities is empty: name at least one load case")
        if len(set(self.activities)) != len(self.activities):
            raise ValueError("activities names a load case twice")
        known = {Path(activity).stem for activity in self.activities}
        for name in self.trials:
            if name in known:
                raise ValueError(f"trials.{name}: an activity has that name")
        return self

    @model_validator(mode="after")
    def _body_and_trials(self) -> Self:
        if (self.body is None) != (not self.trials):
            given, missing = ("body", "trials") if self.body is not None else ("trials", "body")
            raise ValueError(f"{given} needs {missing}: trials are of a body")
        if self.body is not None and not self.body.imported:
            for name, trial in self.trials.items():
                if trial.markers is not None and self.body.ik_model is None:
                    raise ValueError(f"trials.{name}.markers needs body.ik_model, an .osim")
        return self

    @model_validator(mode="after")
    def _samples_around_what_it_has(self) -> Self:
        curves = self.sampling.curves
        if isinstance(curves, ActivityCurvesSection):
            known = [*(Path(a).stem for a in self.activities), *self.trials]
            for name in curves.names:
                if name not in known:
                    raise ValueError(
                        f"sampling.curves.names: {name!r} is none of the study's activities: {', '.join(known)}"
                    )
        return self

    @model_validator(mode="after")
    def _uses_what_it_says(self) -> Self:
        """A dataset brings no contact that could be evaluated, so nothing is simulated."""
        unused = sorted(
            self.model_fields_set
            & {"activities", "body", "contact", "implant", "simulate", "simulator", "trials"}
            # Where there are trials, whoever wrote the study need not have named any.
            - (set() if self.activities else {"activities"})
        )
        if self.sampling.dataset is not None and unused:
            raise ValueError(
                f"{unused[0]} does not go with sampling.dataset: the samples say whose they are, and there is "
                "no reference contact to simulate with"
            )
        return self

    def canonical(self, *sections: str) -> dict[str, Any]:
        """The values of some sections as plain JSON data, for hashing.

        A contact law stands there by its parameters, so that a table counts by its points and not by its file's name;
        ``pressure_law``, on which nothing but the report depends, is left out.
        """
        values = self.model_dump(mode="json", include=set(sections))
        if "contact" in values:
            del values["contact"]["pressure_law"]
            values["contact"]["law"] = self.contact.law.make().describe()
        if "sampling" in values:
            values["sampling"]["curves"] = self.sampling.curves.canonical()
        return values
