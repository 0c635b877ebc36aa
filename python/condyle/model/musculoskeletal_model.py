# SPDX-License-Identifier: Apache-2.0
"""A musculoskeletal model out of its file, with its names."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from condyle._core.fdk import balanced_coordinates
from condyle._core.io import ModelDescription, read_model_file
from condyle._core.model import Model
from condyle.errors import InputDataError

Array = NDArray[np.float64]


class MusculoskeletalModel:
    """Bodies, joints, muscles and ligaments, checked and compiled.

    Args:
        description: as read from a file.
        folder: that the mesh files it names are relative to.

    Raises:
        ValueError: the model does not hang together; the message names the item, the field and the value.
    """

    def __init__(self, description: ModelDescription, folder: Path | None = None) -> None:
        self.core = Model(description)
        self.folder = folder or Path()
        self.coordinate_names: tuple[str, ...] = tuple(self.core.coordinate_names)
        self.body_names: tuple[str, ...] = tuple(self.core.body_names)
        self.muscle_names: tuple[str, ...] = tuple(self.core.muscle_names)
        self.ligament_names: tuple[str, ...] = tuple(self.core.ligament_names)
        self.not_supported: tuple[str, ...] = tuple(description.not_supported)

    @classmethod
    def read(cls, file: Path | str) -> Self:
        """Reads a model file (docs/model_files.md).

        Raises:
            ValueError: the file cannot be read as a model; the message names the file, the item and the key.
        """
        return cls(read_model_file(Path(file)), Path(file).parent)

    @property
    def name(self) -> str:
        """Of the model."""
        return self.core.name

    @property
    def force_dependent(self) -> tuple[str, ...]:
        """Coordinates whose motion is solved for."""
        roles = zip(self.coordinate_names, self.core.coordinate_roles, strict=True)
        return tuple(name for name, role in roles if role == "force_dependent")

    @property
    def balanced_by_muscles(self) -> tuple[str, ...]:
        """Coordinates whose load muscles share."""
        return tuple(self.coordinate_names[c] for c in balanced_coordinates(self.core))

    def coordinate(self, name: str) -> int:
        """Index of a coordinate.

        Raises:
            InputDataError: there is none of that name; the message says what it may have meant.
        """
        return index_of(name, self.coordinate_names, "coordinate", self.name)

    def body(self, name: str) -> int:
        """Index of a body.

        Raises:
            InputDataError: as :meth:`coordinate`.
        """
        return index_of(name, self.body_names, "body", self.name)

    def default_q(self, values: Mapping[str, float] | None = None) -> Array:
        """(coordinates,) default values [rad, m], some of them replaced.

        Args:
            values: by coordinate.
        """
        q = np.array(self.core.coordinate_defaults)
        for name, value in (values or {}).items():
            q[self.coordinate(name)] = value
        return q


def index_of(name: str, names: Sequence[str], what: str, owner: str) -> int:
    """Index of a name among names.

    Raises:
        InputDataError: it is not there; the message says what it may have meant.
    """
    try:
        return names.index(name)
    except ValueError:
        near = difflib.get_close_matches(name, names, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else f"; it has {len(names)} of them"
        raise InputDataError(f"model {owner!r} has no {what} {name!r}{hint}") from None
