# SPDX-License-Identifier: Apache-2.0
"""Lets the tests import what is beside them, and the small leg and OpenSim models of other tests."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
for folder in (HERE, HERE.parent / "fdk", HERE.parent / "opensim"):
    sys.path.insert(0, str(folder))
