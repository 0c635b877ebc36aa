# SPDX-License-Identifier: Apache-2.0
"""How a study file says where its reference curves come from: ``curves = {kind = "activities"}``, for instance."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, Self

from pydantic import Field, model_validator

from condyle.study.section import Positive, Section

if TYPE_CHECKING:
    from condyle.sampling import ReferenceCurves
    from condyle.sampling.conformity_settings import ConformitySettings


class ActivityCurvesSection(Section):
    """The study's own activities, simulated with the reference contact.

    Attributes:
        kind: which way.
        names: of the activities and trials to sample around; all of them if none is named.
    """

    kind: Literal["activities"] = "activities"
    names: tuple[str, ...] = ()

    def canonical(self) -> dict[str, Any]:
        """The values as plain JSON data, for hashing."""
        return {"kind": self.kind, **({"names": list(self.names)} if self.names else {})}


class TableCurvesSection(Section):
    """Tables of the user's own, see :mod:`condyle.sampling.curve_files`.

    Attributes:
        kind: which way.
        files: .csv, .sto or .mot; each activity once.
    """

    kind: Literal["table"]
    files: Annotated[tuple[Path, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _are_curves(self) -> Self:
        self.read()
        return self

    def read(self) -> ReferenceCurves:
        """The curves."""
        from condyle.sampling import read_tables

        return read_tables(self.files)

    def canonical(self) -> dict[str, Any]:
        """The values as plain JSON data, for hashing: the curves count, not their files' places."""
        return {"kind": self.kind, "curves": self.read().content_hash()}


class ConformityCurvesSection(Section):
    """None at hand: what the implant's own shape bears under published loads, see :mod:`condyle.sampling.conformity`.

    Attributes:
        kind: which way.
        body_weight_N: that forces are multiples of.
        max_flexion_deg: flexion goes from 0 to this, or as far as the implant bears the loads.
        axial_force_BW: lightest and highest load.
        walking_force_BW: load under which shear and torque count.
        medial_share: least and greatest share of the load on the medial side.
        ap_shear_BW: that the knee balances along x.
        ml_shear_BW: likewise along z.
        torque_Nm: likewise about y.
        travel_x_mm: at most this from the settled pose, either way.
        travel_z_mm: likewise.
        travel_theta_y_deg: likewise.
    """

    kind: Literal["conformity"]
    body_weight_N: Annotated[float, Field(ge=50, le=3000)] = 750.0
    max_flexion_deg: Annotated[float, Field(ge=10, le=150)] = 90.0
    axial_force_BW: tuple[Positive, Positive] = (0.1, 3.46)
    walking_force_BW: Positive = 2.3
    medial_share: tuple[Positive, Positive] = (0.3, 0.8)
    ap_shear_BW: Positive = 0.30
    ml_shear_BW: Positive = 0.23
    torque_Nm: Annotated[float, Field(ge=0.01, le=100)] = 10.5
    travel_x_mm: Annotated[float, Field(ge=0.1, le=20)] = 5.0
    travel_z_mm: Annotated[float, Field(ge=0.1, le=20)] = 2.0
    travel_theta_y_deg: Annotated[float, Field(ge=0.1, le=25)] = 10.0

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        self.settings()
        return self

    def settings(self) -> ConformitySettings:
        """In SI."""
        from condyle.sampling.conformity_settings import ConformitySettings

        return ConformitySettings(
            body_weight=self.body_weight_N,
            max_flexion=math.radians(self.max_flexion_deg),
            low_force=self.axial_force_BW[0],
            walking_force=self.walking_force_BW,
            high_force=self.axial_force_BW[1],
            medial_share=self.medial_share,
            ap_shear=self.ap_shear_BW,
            ml_shear=self.ml_shear_BW,
            torque=self.torque_Nm,
            travel_x=1e-3 * self.travel_x_mm,
            travel_z=1e-3 * self.travel_z_mm,
            travel_theta_y=math.radians(self.travel_theta_y_deg),
        )

    def canonical(self) -> dict[str, Any]:
        """The values as plain JSON data, for hashing."""
        return self.model_dump(mode="json")


CurvesSection = Annotated[
    ActivityCurvesSection | TableCurvesSection | ConformityCurvesSection,
    Field(discriminator="kind"),
]

#: The sections by their kind.
CURVE_SECTIONS: Final[dict[str, type[Section]]] = {
    "activities": ActivityCurvesSection,
    "table": TableCurvesSection,
    "conformity": ConformityCurvesSection,
}
