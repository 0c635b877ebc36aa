# SPDX-License-Identifier: Apache-2.0
"""The one door to the package ``opensim``: loaded when it is needed, quiet, without a log file."""

from __future__ import annotations

import importlib
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from condyle.errors import InputDataError
from condyle.opensim.document import Document

INSTALL: Final = "pip install 'condyle[opensim]' (or: pip install 'opensim>=4.6,<4.7')"


@cache
def opensim_library() -> Any:
    """The package ``opensim``, its messages off: what it has to say arrives as exceptions.

    Raises:
        InputDataError: The package is not installed; names the command that installs it.
    """
    try:
        library = importlib.import_module("opensim")
    except ImportError as error:
        raise InputDataError(
            f"this needs the package opensim, which cannot be imported ({error}): {INSTALL}"
        ) from error
    library.Logger.setLevelString("Off")
    library.Logger.removeFileSink()
    return library


@dataclass
class OpenSimModel:
    """An OpenSim model that is loaded, and what its file holds besides.

    Attributes:
        file: Where it is from.
        model: ``opensim.Model``.
        state: ``SimTK::State`` of ``model.initSystem()``; unlocked coordinates may be set in it.
        document: The file's XML, with what the library cannot read.
    """

    file: Path
    model: Any
    state: Any
    document: Document


def load_model(file: Path) -> OpenSimModel:
    """Loads an .osim file of any version that the library upgrades.

    Components of classes that the library does not know are taken out before it sees the file:
    OpenSim 4.6 refuses a whole file for one of them.

    Raises:
        InputDataError: No such file, not an OpenSim model, or one that the library refuses.
    """
    library = opensim_library()
    document = Document.read(file)
    document.remove_unknown(
        lambda name: library.OpenSimObject.getDefaultInstanceOfType(name) is not None
    )
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "model.osim"
        document.write(copy)
        try:
            model = library.Model(str(copy))
            # Pictures of bones are no concern of a state.
            model.setUseVisualizer(False)
            _check_tree(file, model)
            state = model.initSystem()
        except RuntimeError as error:
            raise InputDataError(f"{file}: OpenSim refuses it: {_first_line(error)}") from error
    if model.getLengthUnits().getLabel() not in ("meters", "m"):
        units = model.getLengthUnits().getLabel()
        raise InputDataError(f"{file}: length_units is '{units}': must be meters")
    return OpenSimModel(file, model, state, document)


def _check_tree(file: Path, model: Any) -> None:
    """OpenSim would hang a body without a joint on ground by itself, and at times crashes at it."""
    hung = {joint.getChildFrame().findBaseFrame().getName() for joint in model.getJointSet()}
    if loose := [body.getName() for body in model.getBodySet() if body.getName() not in hung]:
        raise InputDataError(
            f"{file}: body {', '.join(loose)}: the child of no joint: must be of one "
            "(a FreeJoint to ground, if nothing holds it)"
        )


def _first_line(error: RuntimeError) -> str:
    text = str(error).split("': ", 1)[-1].split("\tThrown at")[0].split("(Required condition")[0]
    return " ".join(text.split())
