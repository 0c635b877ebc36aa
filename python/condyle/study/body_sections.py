# SPDX-License-Identifier: Apache-2.0
"""How a study says which body its knee is in, and which recorded trials that body goes through."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self, cast

from pydantic import (
    Field,
    ValidationError,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_validator,
)

from condyle.study.section import Section

#: Forces without a point of application count as none up to this [N]: a laboratory's threshold.
NEGLIGIBLE_FORCE_N = 20.0


class BodySection(Section):
    """A musculoskeletal model around the study's implant (docs/simulation.md).

    Attributes:
        model: model file (.json), or an OpenSim model (.osim) that is imported with the package ``opensim``.
        surfaces: JSON file of contact_surfaces: where meshes in Condyle's axes are on the model's bodies.
        femur: the surface of the femoral component there; the implant's femoral frame is its mesh's.
        insert: the surface of the insert; the tibial frame is its mesh's.
        patella: the surface of the patellar component, which then touches the femoral one under the study's law, by its
            mesh; None: no such contact.
        force_dependent: of an .osim: coordinates to be solved for, names or patterns.
        muscles: of an .osim: coordinates that muscles balance, names or patterns; None: the turning ones they cross.
        ik_model: .osim for marker kinematics; None: ``model``.
        criterion: p of min Σ(f/N)^p, or ``min_max``.
        strength: ``hill`` or ``constant``.
        reserve_Nm: strength of a reserve actuator on every rotation that muscles balance; 0: none.
    """

    model: Path
    surfaces: Path
    femur: str
    insert: str
    patella: str | None = None
    force_dependent: tuple[str, ...] = ()
    muscles: tuple[str, ...] | None = None
    ik_model: Path | None = None
    criterion: Annotated[float, Field(ge=1, le=20)] | Literal["min_max"] = 3.0
    strength: Literal["hill", "constant"] = "hill"
    reserve_Nm: Annotated[float, Field(ge=0, le=1e4)] = 0.0

    @property
    def imported(self) -> bool:
        """Whether the model comes from OpenSim."""
        return self.model.suffix == ".osim"

    @field_validator("criterion", mode="wrap")
    @classmethod
    def _power_or_min_max(
        cls, value: Any, check: ValidatorFunctionWrapHandler
    ) -> float | Literal["min_max"]:
        try:
            return cast(float | Literal["min_max"], check(value))
        except ValidationError:
            raise ValueError(f'{value!r}: must be a power of 1 to 20, or "min_max"') from None

    @model_validator(mode="after")
    def _importing(self) -> Self:
        if not self.imported and (self.force_dependent or self.muscles is not None):
            key = "force_dependent" if self.force_dependent else "muscles"
            raise ValueError(
                f"{key} is for an .osim: a model file says it itself ({self.model.name})"
            )
        if self.ik_model is not None and self.ik_model.suffix != ".osim":
            raise ValueError(f"ik_model is {self.ik_model.name}: must be an .osim")
        return self

    @model_validator(mode="after")
    def _each_surface_once(self) -> Self:
        names = [name for name in (self.femur, self.insert, self.patella) if name is not None]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"femur, insert and patella: {name!r} is named twice")
        return self


class TrialSection(Section):
    """A recorded activity.

    Attributes:
        motion: coordinates over time, STO or MOT.
        markers: TRC or C3D instead: inverse kinematics with the package ``opensim``.
        marker_weights: OpenSim's ik_setup.xml; only its markers are followed.
        filter_hz: cut-off of the low-pass on the coordinates from markers; 0: none.
        external_loads: OpenSim's XML file.
        paths: path snapshots of the motion; of an .osim they are made where none are given.
        start_s: first time taken; the motion's if not given.
        end_s: last time taken.
        negligible_force_N: loads up to this need no point of application.
    """

    motion: Path | None = None
    markers: Path | None = None
    marker_weights: Path | None = None
    filter_hz: Annotated[float, Field(ge=0, le=100)] = 6.0
    external_loads: Path | None = None
    paths: Path | None = None
    start_s: float | None = None
    end_s: float | None = None
    negligible_force_N: Annotated[float, Field(ge=0, le=1e3)] = NEGLIGIBLE_FORCE_N

    @model_validator(mode="after")
    def _one_motion(self) -> Self:
        if (self.motion is None) == (self.markers is None):
            raise ValueError("give either motion or markers")
        if self.markers is None and self.marker_weights is not None:
            raise ValueError("marker_weights goes with markers")
        if self.markers is not None and self.paths is not None:
            raise ValueError("paths does not go with markers: snapshots are of one motion")
        if self.start_s is not None and self.end_s is not None and not self.start_s < self.end_s:
            raise ValueError(f"start_s is {self.start_s:g}: must be below end_s, {self.end_s:g}")
        return self
