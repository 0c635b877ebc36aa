# SPDX-License-Identifier: Apache-2.0
"""The state of an unfinished training, in one file that a kill cannot damage."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from condyle.errors import InputDataError
from condyle.training.levenberg_marquardt import LevenbergMarquardtState
from condyle.training.torch_file import read_torch_file, write_atomically

_FORMAT = "condyle training checkpoint, version 2"


class Checkpoint:
    """States of the optimisers so far, by name; without a path it remembers nothing.

    Args:
        path: The file; read if it exists.
        key: What identifies the training; JSON-able.

    Raises:
        InputDataError: The file is of another training, or not a checkpoint.
    """

    def __init__(self, path: Path | None, key: dict[str, Any]) -> None:
        self._path, self._key = path, key
        self._states: dict[str, dict[str, Any]] = {}
        if path is not None and path.exists():
            values = read_torch_file(path, _FORMAT)
            for name, value in key.items():
                if values["key"].get(name) != value:
                    raise InputDataError(
                        f"{path}: checkpoint of another training: {name} is "
                        f"{values['key'].get(name)!r}, here {value!r}; delete it to start anew"
                    )
            self._states = values["states"]

    def state(self, name: str) -> LevenbergMarquardtState | None:
        """The state to resume from, if there is one."""
        values = self._states.get(name)
        return None if values is None else LevenbergMarquardtState.from_dict(values)

    def update(self, name: str, state: LevenbergMarquardtState) -> None:
        """Writes the file anew with this state in it, whole or not at all."""
        if self._path is not None:
            self._states[name] = state.to_dict()
            values = {"format": _FORMAT, "key": self._key, "states": self._states}
            write_atomically(self._path, values)
