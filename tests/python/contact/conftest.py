# SPDX-License-Identifier: Apache-2.0
import os
import sys
from pathlib import Path

import pytest

# The tests' own module (tests are imported by file).
sys.path.insert(0, str(Path(__file__).parent))

from small_implant import femur, inserts

from condyle.contact import MeshContact


@pytest.fixture(scope="session")
def contact() -> MeshContact:
    return MeshContact(femur(), *inserts(), "right")


@pytest.fixture(scope="session")
def data() -> Path:
    named = os.environ.get("CONDYLE_DATA")
    folder = Path(named) if named else Path(__file__).parents[3].parent / "shared" / "data"
    if not (folder / "implants").is_dir():
        pytest.skip("no implants: set CONDYLE_DATA, or put shared/data beside the project")
    return folder
