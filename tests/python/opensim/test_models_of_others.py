# SPDX-License-Identifier: Apache-2.0
"""Models that other packages ship, where one is installed or a folder of .osim files is named."""

import importlib.util
import os
from pathlib import Path

import numpy as np
import pytest
from forward_kinematics import placements
from test_model_import import SAME, placement_of, random_postures

from condyle.opensim import import_model
from condyle.opensim.library import load_model

#: Packages of the registry whose wheels hold .osim files.
PACKAGES = ("Pose2Sim", "bioscout", "opensim_model_creator", "osim")


def models_of_others():
    """Folders named by CONDYLE_OSIM_MODELS, and those of installed packages (which are not imported)."""
    folders = (
        [Path(os.environ["CONDYLE_OSIM_MODELS"])] if "CONDYLE_OSIM_MODELS" in os.environ else []
    )
    for name in PACKAGES:
        spec = importlib.util.find_spec(name)
        folders += [Path(p) for p in (spec.submodule_search_locations or [])] if spec else []
    return sorted(file for folder in folders for file in folder.rglob("*.osim"))


def test_models_of_other_packages_stand_as_opensim_puts_them(osim, rng):
    files = models_of_others()
    if not files:
        pytest.skip(
            "no package with .osim files is installed; CONDYLE_OSIM_MODELS may name a folder"
        )
    for file in files:
        model, loaded = import_model(file), load_model(file)
        for q in random_postures(loaded, model, rng, 2):
            placed = placements(model, q)
            for body in loaded.model.getBodySet():
                expected = placement_of(body, loaded.state)
                found = placed[body.getName()]
                np.testing.assert_allclose(found, expected, rtol=0, atol=SAME, err_msg=str(file))
