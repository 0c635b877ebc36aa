# SPDX-License-Identifier: Apache-2.0
"""Model cards of surrogate files."""

import json
from pathlib import Path

import numpy as np
import onnx
import pytest

from condyle.errors import InputDataError
from condyle.evaluation import sample_error_table
from condyle.surrogate import card_markdown, model_card, write_model_card
from condyle.surrogate.card import card_files, pack_rows
from condyle.whole_files import content_hash

RECORD = {
    "n_samples": 900,
    "n_loaded": [880, 760],
    "settings": {"seed": 3, "time_budget_s": None},
    "versions": {"torch": "2.0"},
    "nets": [
        {
            "name": "I", "widths": [6, 30, 4], "n_parameters": 334, "n_rows": 900, "epochs": 41,
            "stop_reason": "patience", "loss": 3.25e-5, "gamma": 301.4,
        }
    ],
}  # fmt: skip


@pytest.fixture
def errors() -> list[dict]:
    reference = np.random.default_rng(9).uniform(5.0, 800.0, (60, 2, 6))
    return sample_error_table(np.repeat([2, 4, 6], 20), reference, reference + 0.125)


@pytest.fixture
def file(exported: tuple[Path, Path], errors: list[dict], tmp_path: Path) -> Path:
    """The exported surrogate with the record of a training in its metadata."""
    model = onnx.load(exported[0])
    metadata = {p.key: p.value for p in model.metadata_props}
    metadata["condyle.training"] = json.dumps(RECORD | {"held_out_errors": pack_rows(errors)})
    onnx.helper.set_model_props(model, metadata)
    onnx.save(model, tmp_path / "knee.onnx")
    return tmp_path / "knee.onnx"


def test_a_card_is_made_of_the_file_alone(file: Path, errors: list[dict]) -> None:
    card = model_card(file)
    assert (card["file"], card["sha256"]) == ("knee.onnx", content_hash(file.read_bytes()))
    assert (card["architecture"], card["side_of_body"]) == ("two_stage", "right")
    assert card["held_out_errors"] == errors
    assert card["training"] == RECORD
    assert card["wall_times_s"] is None
    assert "runtime" not in card  # the machine's, not the file's
    json.dumps(card, allow_nan=False)


def test_the_text_tells_what_a_user_must_know(file: Path) -> None:
    text = card_markdown(model_card(file))
    headings = [line[3:] for line in text.splitlines() if line.startswith("## ")]
    assert headings == [
        "Implant and contact law",
        "Sampled domains and trust",
        "Errors over held-out samples: RMSE (maximum), N and Nm",
        "Bound on the error (output `error`), level 95%",
        "Training",
        "Limits of use",
        "Licence",
    ]
    assert "| name | none, random weights |" in text
    assert "| 4 | lateral | here | 0.125 (0.125) |" in text
    assert "|  |  | paper | 2.3 (14) |" in text
    assert "| I | 6-30-4 | 334 | 900 | 41 | patience | 3.25e-05 | 301 |" in text
    assert "20 in domain 2" in text and "60 in all" in text
    assert "no medical device" in text
    bounds = model_card(file)["domain_bounds"]
    assert f"{1e3 * bounds['pose_min']['x']:.2f}" in text
    assert "; ".join(bounds["cells"]) in text


def test_cards_are_written_beside_the_file_and_keep_its_times(file: Path) -> None:
    markdown, data = write_model_card(file, {"I": 61.03, "II": 29.0})
    assert (markdown, data) == card_files(file)
    assert markdown.name == "knee_card.md" and data.name == "knee_card.json"
    assert "Wall time: 1.5 min (I 61 s, II 29 s)." in markdown.read_text()
    card = model_card(file)
    assert card["wall_times_s"] == {"I": 61.0, "II": 29.0}
    assert json.loads(data.read_text()) == card


def test_the_times_of_another_file_are_not_taken(file: Path) -> None:
    write_model_card(file, {"I": 61.0})
    _, data = card_files(file)
    card = json.loads(data.read_text())
    data.write_text(json.dumps(card | {"sha256": "0" * 64}))
    assert model_card(file)["wall_times_s"] is None
    data.write_text("no JSON")
    assert model_card(file)["wall_times_s"] is None


def test_a_file_that_knows_little_has_a_card_too(tiny_file: Path) -> None:
    card = model_card(tiny_file)
    assert card["held_out_errors"] is None
    text = card_markdown(card)
    assert "two gated springs" in text
    assert "held-out" not in text.split("## Limits of use")[0]


def test_what_is_no_surrogate_has_none(tmp_path: Path) -> None:
    (tmp_path / "none.onnx").write_bytes(b"nothing")
    with pytest.raises(InputDataError, match=r"none\.onnx"):
        model_card(tmp_path / "none.onnx")
