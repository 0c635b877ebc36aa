# SPDX-License-Identifier: Apache-2.0
import sys
from pathlib import Path

# The tests' own module (tests are imported by file).
sys.path.insert(0, str(Path(__file__).parent))
