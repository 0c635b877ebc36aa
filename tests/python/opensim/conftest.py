# SPDX-License-Identifier: Apache-2.0
import os
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def osim():
    """The package opensim, as Condyle loads it."""
    pytest.importorskip("opensim", reason="the package opensim is not installed")
    from condyle.opensim.library import opensim_library

    return opensim_library()


@pytest.fixture(scope="session")
def models(osim, tmp_path_factory):
    """Files of the models of osim_models, by name."""
    import osim_models

    folder = tmp_path_factory.mktemp("models")
    makers = (osim_models.chain_of_plain_joints, osim_models.leg, osim_models.oddities)
    return {make.__name__: make(osim, folder / f"{make.__name__}.osim") for make in makers}


@pytest.fixture(scope="session")
def dm():
    """Folder of the subject DM, in the shared data."""
    root = Path(os.environ.get("CONDYLE_DATA", Path(__file__).parents[4] / "shared" / "data"))
    folder = root / "subjects" / "dm"
    if not (folder / "model" / "DM.osim").is_file():
        pytest.skip(f"the subject DM is not at {folder} (set CONDYLE_DATA)")
    return folder


@pytest.fixture
def rng():
    return np.random.default_rng(20171)
