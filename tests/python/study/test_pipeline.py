# SPDX-License-Identifier: Apache-2.0
"""The whole path on a small study: stages run, are skipped when current, and run again when their inputs change."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from stage_log import StageLog

from condyle.errors import CondyleError
from condyle.study import Study, StudyRun

pytest.importorskip("torch")

#: Coarse and short: the path is what is tested here, not the surrogate's accuracy.
SMALL = {
    "name": "small",
    "activities": ["iso_like_gait", "squat_like"],
    "implant": {"preset": "curved", "side_of_body": "left", "mesh_edge_mm": 2.5},
    "contact": {"evaluation": "exact"},
    "sampling": {
        "seed": 5,
        "targets": {
            "2": {"train": 400, "test": 150},
            "3": {"train": 0},
            "4": {"train": 150, "test": 60},
            "5": {"train": 120, "test": 40},
            "6": {"train": 0},
        },
    },
    "training": {"neurons": 6, "hidden_layers": 2, "max_epochs": 8, "threads": 1},
}


def run(runs: Path, until: str = "evaluate", **changes: object) -> tuple[StageLog, Path]:
    log = StageLog()
    study = Study.model_validate(SMALL | changes)
    StudyRun(study, runs, threads=2, reporter=log).run(until)
    return log, runs / study.name


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    log, _ = run(folder)
    assert log.ran == ["implant", "reference", "sample", "train", "evaluate"]
    return folder


def test_the_run_directory_holds_what_was_promised(runs):
    root = runs / "small"
    for name in (
        "implant/femur.stl",
        "simulations/iso_like_gait_reference.csv",
        "samples/manifest.json",
        "surrogate.onnx",
        "surrogate_wrench.onnx",
        "surrogate_float32.onnx",
        "training/record.json",
        "surrogate_card.md",
        "surrogate_card.json",
        "tables/sample_errors.json",
    ):
        assert (root / name).stat().st_size > 0, name
    assert not list(root.rglob("*.tmp"))


def test_the_samples_say_what_they_were_drawn_around(runs):
    from condyle.sampling import read_table

    root = runs / "small"
    curves = read_table(root / "tables" / "reference_curves.csv")
    assert curves.names == tuple(SMALL["activities"])
    manifest = json.loads((root / "samples" / "manifest.json").read_text())
    assert manifest["curves"]["hash"] == curves.content_hash()
    assert manifest["plan"]["sensitive_directions"] == ["y", "theta_x"]
    table = json.loads((root / "tables" / "samples.json").read_text())["sensitive_directions"]
    assert table["stiffness"]["y"]["unit"] == "N/mm"


def test_the_surrogate_says_whose_it_is(runs):
    from condyle.surrogate import describe

    description = json.dumps(describe(runs / "small" / "surrogate.onnx"))
    assert '"left"' in description
    assert "femur.stl" in description
    assert "9300000000.0" in description


def test_runtimes_agree(runs):
    parity = json.loads((runs / "small" / "tables" / "parity.json").read_text())
    assert {row["runtime"] for row in parity} == {
        "condyle C++",
        "condyle fused",
        "onnxruntime Python",
    }
    assert {row["output"] for row in parity} == {"wrench", "stiffness", "error", "trust"}
    assert all(row["agrees"] for row in parity), parity


def test_a_second_run_does_nothing(runs):
    log, _ = run(runs)
    assert log.ran == []
    assert log.unchanged == ["implant", "reference", "sample", "train", "evaluate"]


def test_only_what_depends_on_a_change_runs_again(runs):
    log, _ = run(runs, training=SMALL["training"] | {"max_epochs": 9})
    assert log.unchanged == ["implant", "reference", "sample"]
    assert log.ran == ["train", "evaluate"]


def test_the_card_has_the_errors_that_the_evaluation_found(runs):
    from condyle.surrogate import model_card

    card = model_card(runs / "small" / "surrogate.onnx")
    assert card == json.loads((runs / "small" / "surrogate_card.json").read_text())
    assert set(card["wall_times_s"]) == {"medial", "lateral"}
    found = json.loads((runs / "small" / "tables" / "sample_errors.json").read_text())
    for told, row in zip(card["held_out_errors"], found, strict=True):
        assert (told["domain"], told["load"]) == (row["domain"], row["load"])
        # The networks in torch and the file in the C++ runtime agree to rounding.
        assert told["rmse"] == pytest.approx(row["rmse"], rel=1e-6, abs=1e-9)


def copied(runs: Path, folder: Path) -> Path:
    """A copy of the run, to change."""
    shutil.copytree(runs / "small", folder / "small")
    return folder


def test_the_potential_goes_the_same_way(runs, tmp_path):
    training = {"power": 2.4, "hidden_layers": 1, "neurons": 6}
    log, root = run(copied(runs, tmp_path), training=training | {"max_epochs": 6, "threads": 1})
    assert log.ran == ["train", "evaluate"]
    card = json.loads((root / "surrogate_card.json").read_text())
    assert card["architecture"] == "potential"
    assert card["training"]["settings"]["power"] == 2.4
    assert not list((root / "training").glob("*.pt"))
    parity = json.loads((root / "tables" / "parity.json").read_text())
    assert all(row["agrees"] for row in parity), parity


def test_a_search_chooses_layers_and_neurons(runs, tmp_path):
    # A first trial of 2 x 10 falls below 0.5 at once.
    training = {
        "architecture": "two_stage",
        "search": {"performance": 0.5, "trial_time_s": 60},
        "max_epochs": 4,
        "threads": 1,
    }
    _, root = run(copied(runs, tmp_path), until="train", training=training)
    record = json.loads((root / "training" / "record.json").read_text())
    (trial,) = record["architecture_search"]["trials"]
    assert (trial["hidden_layers"], trial["neurons"], trial["accepted"]) == (2, 10, True)
    assert record["nets"][0]["widths"] == [6, 10, 10, 4]
    assert "architecture search: performance 0.5" in (root / "surrogate_card.md").read_text()
    assert not list((root / "training").glob("*.pt"))


def without_trust(file: Path) -> None:
    """Makes a surrogate file say that it is to be trusted nowhere."""
    import onnx

    model = onnx.load(file)
    for node in model.graph.node:
        for i, name in enumerate(node.output):
            if name == "trust":
                node.output[i] = "trust_before"
    zero = onnx.numpy_helper.from_array(np.array(0.0), "no_trust")
    model.graph.initializer.append(zero)
    model.graph.node.append(onnx.helper.make_node("Mul", ["trust_before", "no_trust"], ["trust"]))
    onnx.save(model, file)


def test_a_hybrid_whose_surrogate_is_nowhere_trusted_is_the_reference(runs, tmp_path):
    from condyle.study.simulation_files import read_simulation
    from condyle.study.stages import simulate

    root = copied(runs, tmp_path) / "small"
    without_trust(root / "surrogate.onnx")
    study = Study.model_validate(SMALL | {"simulate": {"contact": ["hybrid"]}})
    log = StageLog()
    assert simulate.run(StudyRun(study, tmp_path, threads=1, reporter=log).context)
    times = json.loads((root / "tables" / "times.json").read_text())
    assert [row["contact"] for row in times] == ["hybrid", "hybrid"]
    for row, name in zip(times, SMALL["activities"], strict=True):
        assert row["reference_evaluations"] == row["evaluations"] > 100
        known, found = (
            read_simulation(root / "simulations" / f"{name}_{which}.csv")
            for which in ("reference", "hybrid")
        )
        np.testing.assert_array_equal(found["poses"], known["poses"])
        np.testing.assert_array_equal(found["wrenches"], known["wrenches"])
        calls = np.loadtxt(
            root / "simulations" / f"{name}_hybrid_calls.csv", delimiter=",", skiprows=1
        )
        # The log keeps the first thousand.
        assert calls.shape == (min(row["evaluations"], 1000), 7)
        assert (calls[:, 6] == 0.0).all()


def test_samples_of_another_design_are_not_overwritten(runs):
    manifest = runs / "small" / "samples" / "manifest.json"
    before = manifest.read_bytes()
    with pytest.raises(CondyleError, match=r"manifest\.json.*seed"):
        run(runs, sampling=SMALL["sampling"] | {"seed": 6})
    assert manifest.read_bytes() == before


def test_no_such_stage(tmp_path):
    with pytest.raises(ValueError, match="stage 'trian': must be one of implant, body, reference"):
        run(tmp_path, until="trian")
