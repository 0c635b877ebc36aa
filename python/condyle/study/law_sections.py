# SPDX-License-Identifier: Apache-2.0
"""How a study file names a contact law: ``law = {kind = "linear_volume", modulus = 9.3e9}``, for instance."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal, Self

from pydantic import Field, model_validator

from condyle.study.section import Positive, Section

if TYPE_CHECKING:
    from condyle.contact import ContactLaw


class LinearVolumeSection(Section):
    """p = K·d.

    Attributes:
        kind: which law.
        modulus: K [N/m³]; 9.3e9 serves forces and kinematics (Marra et al. 2015), not pressure.
    """

    kind: Literal["linear_volume"] = "linear_volume"
    modulus: Positive = 9.3e9

    def make(self) -> ContactLaw:
        """The law."""
        from condyle.contact import LinearVolumeLaw

        return LinearVolumeLaw(modulus=self.modulus)


class _ThinLayerSection(Section):
    youngs_modulus_MPa: Positive
    poissons_ratio: Annotated[float, Field(gt=-1, lt=0.5)]
    thickness_mm: Positive


class ThinLayerLinearSection(_ThinLayerSection):
    """A thin elastic layer under small strain.

    Attributes:
        kind: which law.
        youngs_modulus_MPa: E.
        poissons_ratio: ν.
        thickness_mm: h.
    """

    kind: Literal["thin_layer_linear"]

    def make(self) -> ContactLaw:
        """The law."""
        from condyle.contact import ThinLayerLinearLaw

        return ThinLayerLinearLaw(
            youngs_modulus=1e6 * self.youngs_modulus_MPa,
            poissons_ratio=self.poissons_ratio,
            thickness=1e-3 * self.thickness_mm,
        )


class ThinLayerLogarithmicSection(_ThinLayerSection):
    """A thin elastic layer that stiffens as it is squeezed; attributes as of the linear one."""

    kind: Literal["thin_layer_logarithmic"]

    def make(self) -> ContactLaw:
        """The law."""
        from condyle.contact import ThinLayerLogarithmicLaw

        return ThinLayerLogarithmicLaw(
            youngs_modulus=1e6 * self.youngs_modulus_MPa,
            poissons_ratio=self.poissons_ratio,
            thickness=1e-3 * self.thickness_mm,
        )


class PowerSection(Section):
    """p = c·dⁿ.

    Attributes:
        kind: which law.
        coefficient: c [Pa/mⁿ].
        exponent: n, at least 1.
    """

    kind: Literal["power"]
    coefficient: Positive
    exponent: Annotated[float, Field(ge=1, allow_inf_nan=False)]

    def make(self) -> ContactLaw:
        """The law."""
        from condyle.contact import PowerLaw

        return PowerLaw(coefficient=self.coefficient, exponent=self.exponent)


class TableSection(Section):
    """Measured pressures.

    Attributes:
        kind: which law.
        file: CSV with columns depth_mm, pressure_MPa (or depth_m, pressure_Pa), from (0, 0).
    """

    kind: Literal["table"]
    file: Path

    @model_validator(mode="after")
    def _is_a_law(self) -> Self:
        self.make()
        return self

    def make(self) -> ContactLaw:
        """The law."""
        from condyle.contact import read_table_law

        return read_table_law(self.file)


LawSection = Annotated[
    LinearVolumeSection
    | ThinLayerLinearSection
    | ThinLayerLogarithmicSection
    | PowerSection
    | TableSection,
    Field(discriminator="kind"),
]

#: The sections by their kind.
LAW_SECTIONS: Final[dict[str, type[Section]]] = {
    "linear_volume": LinearVolumeSection,
    "thin_layer_linear": ThinLayerLinearSection,
    "thin_layer_logarithmic": ThinLayerLogarithmicSection,
    "power": PowerSection,
    "table": TableSection,
}
