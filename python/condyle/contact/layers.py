# SPDX-License-Identifier: Apache-2.0
"""Elastic layers that vary from face to face, for the thin-layer laws."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core.contact import layer_of
from condyle.errors import InputDataError

#: No layers: the law's own everywhere.
NO_LAYERS: NDArray[np.float64] = np.zeros((0, 2))


@dataclass(frozen=True, kw_only=True)
class FaceLayers:
    """The layer under each face of a surface; a number stands for all faces.

    Attributes:
        youngs_modulus: E [Pa], > 0, a number or (m,) in the order of the mesh's faces.
        poissons_ratio: ν, between -1 and 0.5, likewise.
        thickness: h [m], > 0, likewise.
    """

    youngs_modulus: ArrayLike
    poissons_ratio: ArrayLike
    thickness: ArrayLike

    def table(self, faces: int) -> NDArray[np.float64]:
        """(m, 2): confined modulus [Pa] and thickness [m] of each of ``faces`` faces.

        Raises:
            InputDataError: an attribute has another number of values, or one is out of range; the text names face,
                attribute, value and limit.
        """
        columns = []
        for name in ("youngs_modulus", "poissons_ratio", "thickness"):
            values = np.asarray(getattr(self, name), dtype=np.float64)
            if values.ndim > 1 or (values.ndim == 1 and len(values) != faces):
                raise InputDataError(
                    f"layers: {name} of shape {values.shape}: must be a number, or one of each of {faces} faces"
                )
            columns.append(np.broadcast_to(values, (faces,)))
        table = np.empty((faces, 2))
        for f, (modulus, ratio, thickness) in enumerate(zip(*columns, strict=True)):
            try:
                table[f] = layer_of(float(modulus), float(ratio), float(thickness))
            except ValueError as error:
                raise InputDataError(f"layers: face {f}: {error}") from None
        return table


def layer_table(layers: FaceLayers | None, faces: int) -> NDArray[np.float64]:
    """The table that the core takes; empty for the law's own layer."""
    return NO_LAYERS if layers is None else layers.table(faces)
