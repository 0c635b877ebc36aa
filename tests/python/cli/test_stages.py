# SPDX-License-Identifier: Apache-2.0
"""What the stage commands take and say."""

import io
import sys
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from condyle.cli import stages
from condyle.cli.app import app
from condyle.cli.console import progress_bar
from condyle.errors import InputDataError


def test_progress_off_a_terminal_is_a_line_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console(record=True, force_terminal=False, width=60, file=io.StringIO())
    clock = 100.0
    monkeypatch.setattr(stages, "console", console)
    monkeypatch.setattr(stages.time, "perf_counter", lambda: clock)
    with progress_bar() as progress:
        reporter = stages.ScreenReporter(progress)
        reporter.stage("sample", "300 samples in domains 2, 4")
        for step in range(100):
            clock += 0.5
            reporter.progress("domain 2", step / 100, "round 1, 80 candidates/s, 3 min left")
        reporter.finished("sample", "done")
    lines = console.export_text().splitlines()
    # 50 s: after 20 s and after 40 s.
    assert lines == [
        "sample     300 samples in domains 2, 4",
        "           domain 2: 39%, round 1, 80 candidates/s, 3 min left",
        "           domain 2: 79%, round 1, 80 candidates/s, 3 min left",
        "           done (50 s)",
    ]


@pytest.mark.parametrize("command", ["sample", "run"])
def test_a_scheduler_is_handed_to_the_sampling_stage(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, command: str
) -> None:
    """Up to the sampling stage with the smallest study, where the missing extra is named."""
    study = tmp_path / "study.toml"
    study.write_text(
        'name = "small"\nactivities = ["squat_like"]\n'
        '[implant]\npreset = "curved"\nmesh_edge_mm = 3.0\n[contact]\nevaluation = "exact"\n'
    )
    monkeypatch.setitem(sys.modules, "distributed", None)
    runs = str(tmp_path / "runs")
    arguments = [command, str(study), "--runs", runs, "--scheduler", "tcp://127.0.0.1:9"]
    result = CliRunner().invoke(app, arguments)
    assert isinstance(result.exception, InputDataError)
    assert "pip install 'condyle[cluster]'" in str(result.exception)
