# SPDX-License-Identifier: Apache-2.0
import os
import sys
from pathlib import Path

import pytest

# The tests' own module, also for the subprocess that gets killed (tests are imported by file).
sys.path.insert(0, str(Path(__file__).parent))

from spring_contact import spring_curves

from condyle.sampling import DomainTarget, ReferenceCurves, SamplingPlan


@pytest.fixture
def curves() -> ReferenceCurves:
    return spring_curves()


@pytest.fixture
def plan() -> SamplingPlan:
    """Small, but with several chunks a round."""
    return SamplingPlan(
        targets=(DomainTarget(2, 170, 30), DomainTarget(4, 85, 15)),
        seed=2017,
        pilot=48,
        chunk_rows=64,
    )


@pytest.fixture
def content():
    """All files of a dataset but run.log, by name."""

    def read(directory: Path) -> dict[str, bytes]:
        return {
            str(path.relative_to(directory)): path.read_bytes()
            for path in sorted(directory.rglob("*"))
            if path.is_file() and path.name != "run.log"
        }

    return read


@pytest.fixture
def test_environment() -> dict[str, str]:
    """For a subprocess that imports what this process does."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
