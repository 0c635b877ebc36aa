# SPDX-License-Identifier: Apache-2.0
"""What README shows, works."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from condyle.study import read_study

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_python_example_runs(tmp_path):
    example = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)[0]
    result = subprocess.run(
        [sys.executable, "-c", example], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.splitlines()[0] == "(1, 2, 6) (1, 2, 6, 6)"
    assert "101 of 101 time frames converged" in result.stdout


@pytest.mark.parametrize(
    "command", sorted(set(re.findall(r"condyle ((?:contact|implant|surrogate) \w+)", TEXT)))
)
def test_the_commands_named_exist(command):
    result = subprocess.run(
        [sys.executable, "-m", "condyle.cli", *command.split(), "--help"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert result.returncode == 0, result.stderr


def test_the_links_lead_somewhere():
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", TEXT):
        assert (ROOT / target).exists(), target


def test_the_example_study_is_valid():
    assert read_study(ROOT / "docs" / "examples" / "dm.toml").implant.side_of_body == "right"
