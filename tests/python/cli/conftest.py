# SPDX-License-Identifier: Apache-2.0
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from condyle import implants


@pytest.fixture(scope="session")
def implant(tmp_path_factory) -> Path:
    """A coarse parametric implant in files, metres."""
    import dataclasses

    folder = tmp_path_factory.mktemp("implant")
    parameters = dataclasses.replace(implants.preset("curved"), mesh_edge_length=2e-3)
    implants.write_implant(folder, implants.generate(parameters))
    return folder


@pytest.fixture
def poses(tmp_path) -> Path:
    """A loaded pose and one in the air."""
    file = tmp_path / "poses.csv"
    file.write_text("x,y,z,theta_x,theta_y,theta_z\n0.0068,0.0405,0,0,0,0\n0.0068,0.0505,0,0,0,0\n")
    return file


@pytest.fixture
def condyle():
    """Runs the command as a user would: another process; returns its result."""

    def run(*arguments: object, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "condyle.cli", *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=folder,
            env={**os.environ, "COLUMNS": "200"},
            timeout=300,
        )

    return run


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(19)
