# SPDX-License-Identifier: Apache-2.0
"""A right and a left knee of the parametric implant, meshed coarsely: the solver is under test, not the contact."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from condyle.contact import MeshContact
from condyle.conventions import SideOfBody
from condyle.implants import generate, preset, write_implant

sys.path.insert(0, str(Path(__file__).parent))


def knee(folder: Path, side_of_body: SideOfBody) -> MeshContact:
    parameters = replace(preset("curved", side_of_body=side_of_body), mesh_edge_length=1.1e-3)
    write_implant(folder, generate(parameters))
    return MeshContact.from_files(
        femur=folder / "femur.stl",
        insert_medial=folder / "insert_medial.stl",
        insert_lateral=folder / "insert_lateral.stl",
        units="m",
        side_of_body=side_of_body,
    )


@pytest.fixture(scope="session")
def right_knee(tmp_path_factory: pytest.TempPathFactory) -> MeshContact:
    return knee(tmp_path_factory.mktemp("right"), "right")


@pytest.fixture(scope="session")
def left_knee(tmp_path_factory: pytest.TempPathFactory) -> MeshContact:
    return knee(tmp_path_factory.mktemp("left"), "left")
