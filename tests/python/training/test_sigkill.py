# SPDX-License-Identifier: Apache-2.0
"""A training that SIGKILL ends at any moment goes on to the identical bytes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("kill_and_resume.py")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork and SIGKILL")
@pytest.mark.parametrize("architecture", ["two_stage", "potential"])
def test_killed_trainings_go_on_to_identical_bytes(architecture: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, SCRIPT, architecture, tmp_path],
        capture_output=True,
        text=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    # Where the machine was slow only while the uninterrupted training ran, a later kill may come
    # too late; the first cannot.
    assert told["killed"] >= 1 and told["unfinished"] >= 1 and told["checkpoint"]
    assert told["same"] == {"wrench": True, "record": True}
    assert [name for name in told["files"] if name.endswith(".tmp")] == []
