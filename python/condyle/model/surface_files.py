# SPDX-License-Identifier: Apache-2.0
"""Which mesh files a model's contact surfaces are, where they are not the ones beside the model's file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from condyle._core.io import read_surface_file
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel, index_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SurfaceFile:
    """The mesh of a contact surface.

    Attributes:
        file: STL, OBJ, PLY or OFF, in m; None: only where it would be is known (a surrogate needs no more).
        body: that the mesh's coordinates are fixed to by ``placement``; None: as the model places the surface.
        placement: (4, 4) the mesh's coordinates in the body's.
    """

    file: Path | None
    body: str | None = None
    placement: Array = field(default_factory=lambda: np.eye(4))


def surface_files(
    model: MusculoskeletalModel, sources: Sequence[str | Path] = ()
) -> dict[str, SurfaceFile]:
    """Mesh files by surface; surfaces whose file is not there are left out.

    Args:
        model: with contact surfaces.
        sources: Where to look, later ones first: a folder that holds the files that the model names; NAME=FILE
            for one surface, at the model's own placement; a JSON file with ``contact_surfaces`` as in a model
            file, for meshes that are made about other axes than the model's; there ``mesh`` may be left out. Last
            of all the model's own folder.

    Raises:
        InputDataError: a source that is none of these, a surface or body that the model lacks, by name.
    """
    names = list(model.core.contact_surface_names)
    found: dict[str, SurfaceFile] = {}
    for source in [model.folder, *sources]:
        path = Path(source)
        name, equals, file = str(source).partition("=")
        if path.is_dir():
            for surface, own in zip(names, model.core.contact_surface_files, strict=True):
                if (path / own).is_file():
                    found[surface] = SurfaceFile(path / own)
        elif path.suffix == ".json" and path.is_file():
            found |= _read_mapping(model, path)
        elif equals:
            index_of(name, names, "contact surface", model.name)
            if not Path(file).is_file():
                raise InputDataError(f"{name}={file}: there is no such file")
            found[name] = SurfaceFile(Path(file))
        else:
            raise InputDataError(
                f"meshes {source}: must be a folder, NAME=FILE or a JSON file with contact_surfaces"
            )
    return {name: found[name] for name in names if name in found}


def _read_mapping(model: MusculoskeletalModel, path: Path) -> dict[str, SurfaceFile]:
    found = {}
    for surface in read_surface_file(path, model.core):
        file = None if surface.mesh == Path() else Path(surface.mesh)
        found[surface.name] = SurfaceFile(file, surface.body, surface.X_BS)
    return found
