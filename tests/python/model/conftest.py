# SPDX-License-Identifier: Apache-2.0
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

# What is beside these tests, and the small leg of others.
for folder in (Path(__file__).parent, Path(__file__).parent.parent / "fdk"):
    sys.path.insert(0, str(folder))


@dataclass(frozen=True)
class Oracle:
    """A folder of tables that OpenSim 4.6 wrote, one row a time frame, 8 digits."""

    folder: Path

    def columns(self, name):
        with (self.folder / f"{name}.csv").open() as file:
            return file.readline().strip().split(",")

    def table(self, name, columns):
        head = self.columns(name)
        index = [head.index(column) for column in columns]
        return np.loadtxt(
            self.folder / f"{name}.csv", delimiter=",", skiprows=1, usecols=index, ndmin=2
        )


@pytest.fixture(scope="session")
def osim():
    """The package opensim, as Condyle loads it."""
    pytest.importorskip("opensim", reason="the package opensim is not installed")
    from condyle.opensim.library import opensim_library

    return opensim_library()


@pytest.fixture(scope="session")
def dm_folder():
    """Folder of the subject DM, in the shared data."""
    root = Path(os.environ.get("CONDYLE_DATA", Path(__file__).parents[4] / "shared" / "data"))
    folder = root / "subjects" / "dm"
    if not (folder / "model" / "DM_stripped.osim").is_file():
        pytest.skip(f"the subject DM is not at {folder} (set CONDYLE_DATA)")
    return folder


@pytest.fixture(scope="session")
def dm(osim, dm_folder, tmp_path_factory):
    """The model DM, imported, as read from the file that the import wrote."""
    from condyle.model import MusculoskeletalModel
    from condyle.opensim import import_model, write_model

    file = tmp_path_factory.mktemp("dm") / "dm.json"
    write_model(file, import_model(dm_folder / "model" / "DM.osim"))
    return MusculoskeletalModel.read(file)


@pytest.fixture(scope="session")
def oracles(dm_folder):
    """By trial."""
    return {
        name: Oracle(dm_folder / "oracles" / name)
        for name in ("DM_ngait_og1", "DM_crouch_tm1", "random_poses")
    }
