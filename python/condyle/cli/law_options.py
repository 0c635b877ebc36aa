# SPDX-License-Identifier: Apache-2.0
"""The options by which a command is told the contact law."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import typer

from condyle.errors import InputDataError

if TYPE_CHECKING:
    from condyle.contact import ContactLaw

LawName = Literal["linear_volume", "thin_layer_linear", "thin_layer_logarithmic", "power", "table"]
_LAYER: Final = ("youngs_modulus_mpa", "poissons_ratio", "thickness_mm")
#: The options that are a law's parameters; each is needed, but for the modulus, which has a default.
_OPTIONS_OF: Final[dict[str, tuple[str, ...]]] = {
    "linear_volume": ("modulus",),
    "thin_layer_linear": _LAYER,
    "thin_layer_logarithmic": _LAYER,
    "power": ("coefficient", "exponent"),
    "table": ("law_table",),
}

Law = Annotated[LawName, typer.Option(help="Contact law.")]
Modulus = Annotated[
    float | None, typer.Option(help="linear_volume: K in p = K·d [N/m³], by default 9.3e9.")
]
YoungsModulus = Annotated[float | None, typer.Option(help="thin_layer_*: Young's modulus E.")]
PoissonsRatio = Annotated[float | None, typer.Option(help="thin_layer_*: Poisson's ratio.")]
Thickness = Annotated[float | None, typer.Option(help="thin_layer_*: thickness of the layer.")]
Coefficient = Annotated[float | None, typer.Option(help="power: c in p = c·dⁿ [Pa/mⁿ].")]
Exponent = Annotated[float | None, typer.Option(help="power: n in p = c·dⁿ, at least 1.")]
LawTable = Annotated[
    Path | None,
    typer.Option(help="table: CSV of depth_mm,pressure_MPa (or depth_m,pressure_Pa)."),
]


def read_law(
    law: LawName,
    *,
    modulus: float | None,
    youngs_modulus_mpa: float | None,
    poissons_ratio: float | None,
    thickness_mm: float | None,
    coefficient: float | None,
    exponent: float | None,
    law_table: Path | None,
) -> ContactLaw:
    """The law of the options.

    Raises:
        InputDataError: an option is missing or belongs to another law, or a value is out of range.
    """
    from condyle import contact

    options = {
        "modulus": modulus,
        "youngs_modulus_mpa": youngs_modulus_mpa,
        "poissons_ratio": poissons_ratio,
        "thickness_mm": thickness_mm,
        "coefficient": coefficient,
        "exponent": exponent,
        "law_table": law_table,
    }
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if name not in _OPTIONS_OF[law]:
            if value is not None:
                raise InputDataError(f"{flag} does not go with --law {law}")
        elif value is None and name != "modulus":
            raise InputDataError(f"--law {law} needs {flag}")
    if law_table is not None:
        return contact.read_table_law(law_table)
    if coefficient is not None and exponent is not None:
        return contact.PowerLaw(coefficient=coefficient, exponent=exponent)
    if youngs_modulus_mpa is None or poissons_ratio is None or thickness_mm is None:
        return (
            contact.LinearVolumeLaw()
            if modulus is None
            else contact.LinearVolumeLaw(modulus=modulus)
        )
    layer = {
        "youngs_modulus": 1e6 * youngs_modulus_mpa,
        "poissons_ratio": poissons_ratio,
        "thickness": 1e-3 * thickness_mm,
    }
    if law == "thin_layer_linear":
        return contact.ThinLayerLinearLaw(**layer)
    return contact.ThinLayerLogarithmicLaw(**layer)
