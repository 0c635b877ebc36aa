# SPDX-License-Identifier: Apache-2.0
"""``condyle surrogate info`` and ``condyle surrogate learn``."""

import json
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parents[1] / "sampling"))

from external_knee import external_table

TINY = Path(__file__).parents[2] / "data" / "tiny_surrogate.onnx"


def test_info_prints_the_card_as_text_and_as_json(condyle):
    from condyle.surrogate import card_markdown, model_card

    text = condyle("surrogate", "info", TINY)
    assert (text.returncode, text.stderr) == (0, "")
    card = model_card(TINY)
    # Off a terminal the text is the Markdown, and what evaluates the file here.
    assert text.stdout.startswith(card_markdown(card))
    assert text.stdout.splitlines()[-1].startswith("Evaluated here by: onnxruntime (not fused")
    told = json.loads(condyle("surrogate", "info", TINY, "--json").stdout)
    assert told.pop("runtime").startswith("onnxruntime")
    assert told == card


def test_info_of_what_is_no_surrogate_is_a_line(condyle, tmp_path):
    (tmp_path / "none.onnx").write_bytes(b"nothing")
    refused = condyle("surrogate", "info", tmp_path / "none.onnx")
    assert refused.returncode == 2
    assert refused.stderr.startswith("condyle: ") and "none.onnx" in refused.stderr


def test_learn_writes_the_curves_and_does_nothing_twice(tmp_path):
    pytest.importorskip("torch")
    from condyle.cli.app import app
    from condyle.sampling import TableUnits, import_samples

    external_table(700, 47).to_csv(tmp_path / "knee.csv", index=False)
    units = TableUnits("mm", "deg", "N", "Nmm")
    import_samples(
        tmp_path / "knee.csv", tmp_path / "data", source="x", side_of_body="right", units=units
    )
    (tmp_path / "knee.toml").write_text(
        '[sampling]\ndataset = "data"\n[training]\nhidden_layers = 1\nneurons = 4\nmax_epochs = 6\nthreads = 1\n'
    )
    command = ["surrogate", "learn", str(tmp_path / "knee.toml"), "--runs", str(tmp_path / "runs")]
    command += ["--share", "0.5", "--share", "1", "--minutes", "1"]
    first = CliRunner().invoke(app, command)
    assert first.exit_code == 0, first.output
    text = (tmp_path / "runs/knee/learning_curves.md").read_text()
    assert first.output.endswith(text)
    assert "learn      298, 595 samples" in first.output
    again = CliRunner().invoke(app, command)
    assert "learn      unchanged" in again.output
    refused = CliRunner().invoke(app, [*command, "--share", "2"])
    assert refused.exit_code == 2
