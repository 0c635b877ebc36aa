# SPDX-License-Identifier: Apache-2.0
"""What ``--volume boolean`` adds to a table of contact loads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from condyle.cli.console import console
from condyle.conventions import SIDES
from condyle.errors import InputDataError

if TYPE_CHECKING:
    from condyle.contact import OverlapSolid
    from condyle.contact.load_table import Columns

_PARTS: Final = ("femur", *SIDES)
_OPTIONS: Final = ("--femur-solid", "--insert-solid-medial", "--insert-solid-lateral")


def read_solids(
    volume: Literal["law", "boolean"],
    units: Literal["m", "mm"],
    *,
    surfaces: tuple[Path | None, ...],
    solids: tuple[Path | None, ...],
) -> dict[str, OverlapSolid] | None:
    """The closed solids by part (femur, medial, lateral); None where only the law's volume is wanted.

    A part without a solid of its own is tried with the surface that its contact is evaluated on.

    Raises:
        InputDataError: a solid is given without ``--volume boolean``, is missing, open or inside out.
    """
    from condyle.contact import read_solid

    if volume == "law":
        for option, file in zip(_OPTIONS, solids, strict=True):
            if file is not None:
                raise InputDataError(f"{option} does not go with --volume law")
        return None
    found = {}
    for part, option, solid, surface in zip(_PARTS, _OPTIONS, solids, surfaces, strict=True):
        file = surface if solid is None else solid
        found[part] = read_solid(file, units, option=option)
        pairs = found[part].self_intersections
        if pairs > 0:
            console.print(
                f"{file}: passes through itself at {pairs} pairs of faces; the status says where a "
                "Boolean volume is touched by it",
                highlight=False,
                soft_wrap=True,
            )
    return found


def add_volumes(columns: Columns, solids: dict[str, OverlapSolid], threads: int) -> Columns:
    """The table with the Boolean volume of each side."""
    from condyle.contact import add_overlap_columns

    inserts = {side: solids[side] for side in SIDES}
    return add_overlap_columns(columns, solids["femur"], inserts, threads=threads)
