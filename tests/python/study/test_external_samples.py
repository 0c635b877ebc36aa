# SPDX-License-Identifier: Apache-2.0
"""A study that trains on samples which another program made."""

import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")
sys.path.insert(0, str(Path(__file__).parents[1] / "sampling"))

from external_knee import external_table

from condyle.errors import CondyleError, InputDataError
from condyle.sampling import Dataset, TableUnits, import_samples
from condyle.study import StudyRun, read_study

STUDY = """
[sampling]
dataset = "samples"
[training]
architecture = "two_stage"
neurons = 10
hidden_layers = 2
max_epochs = 30
threads = 1
"""


def import_into(directory: Path, rows: int, seed: int = 41) -> None:
    file = directory.parent / "knee.csv"
    external_table(rows, seed).to_csv(file, index=False)
    units = TableUnits("mm", "deg", "N", "Nmm")
    import_samples(file, directory, source="rollers", side_of_body="right", units=units)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A study, run to its end."""
    folder = tmp_path_factory.mktemp("external")
    import_into(folder / "samples", 1500)
    (folder / "knee.toml").write_text(STUDY)
    StudyRun(read_study(folder / "knee.toml"), folder / "runs", threads=1).run()
    return folder


def test_the_surrogate_has_learned_the_other_model(folder):
    from condyle.contact import Derivatives
    from condyle.surrogate import load_surrogate

    test = Dataset.read(folder / "samples").select(split="test")
    model = load_surrogate(folder / "runs/knee/surrogate.onnx")
    found = model.evaluate(test.poses, Derivatives.none, 1).wrench
    for side in range(2):
        Fy = test.wrenches[:, side, 1]
        loaded = Fy > 0
        left = np.square(found[loaded, side, 1] - Fy[loaded]).sum()
        # Two short layers and 30 epochs explain most of the variance, not all of it.
        assert 1 - left / np.square(Fy[loaded] - Fy[loaded].mean()).sum() > 0.98


def test_the_surrogate_says_whose_samples_it_learned_from(folder):
    from condyle.surrogate import describe

    told = describe(folder / "runs/knee/surrogate.onnx")
    provenance = Dataset.read(folder / "samples").manifest["provenance"]
    assert told["side_of_body"] == "right"
    assert told["implant"] == {}
    assert told["contact_law"] == {"name": "external", "source": "rollers"}
    assert told["training"]["provenance"] == provenance


def test_results_and_figures_are_there(folder):
    root = folder / "runs/knee"
    tables = json.loads((root / "tables.json").read_text())
    assert tables["samples"] is None
    assert tables["external_samples"]["train"] + tables["external_samples"]["test"] == 1500
    text = (root / "tables.md").read_text()
    assert "rollers (knee.csv, in mm, deg, N, Nmm" in text
    for figure in ("samples_loaded", "samples_coverage", "parity"):
        assert f"figures/{figure}.png" in text
        assert (root / f"figures/{figure}.png").exists()
    page = (root / "report.html").read_text()
    assert page.count('src="data:image/png;base64,') == text.count("![") > 0
    assert str(folder) not in page
    assert not (root / "implant").exists()
    assert not (root / "simulations").exists()


@pytest.mark.parametrize("stage", ["implant", "reference", "simulate"])
def test_what_needs_a_reference_contact_says_so(folder, stage):
    run = StudyRun(read_study(folder / "knee.toml"), folder / "runs", threads=1)
    with pytest.raises(CondyleError, match=f"stage '{stage}' needs a reference contact"):
        run.run(stage)


def test_nothing_is_done_twice_and_other_samples_are_noticed(folder, tmp_path):
    told = []

    class Log:
        def stage(self, name, text):
            told.append(name)

        def skipped(self, name):
            told.append(f"{name} unchanged")

        def progress(self, task, fraction, note):
            pass

        def finished(self, name, text):
            pass

    study = read_study(folder / "knee.toml")
    StudyRun(study, folder / "runs", threads=1, reporter=Log()).run("evaluate")
    assert told == ["sample unchanged", "train unchanged", "evaluate unchanged"]
    told.clear()
    import_into(tmp_path / "samples", 300, seed=7)
    sampling = study.sampling.model_copy(update={"dataset": tmp_path / "samples"})
    other = study.model_copy(update={"sampling": sampling})
    shutil.copytree(folder / "runs", tmp_path / "runs")
    StudyRun(other, tmp_path / "runs", threads=1, reporter=Log()).run("sample")
    assert told == ["sample"]


def test_a_dataset_that_is_none_is_refused(tmp_path):
    (tmp_path / "knee.toml").write_text(STUDY)
    run = StudyRun(read_study(tmp_path / "knee.toml"), tmp_path / "runs", threads=1)
    with pytest.raises(CondyleError, match=r"sampling\.dataset = .*holds no manifest\.json"):
        run.run("train")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[sampling]\ndataset = "s"\nseed = 3\n', "seed does not go with dataset"),
        (
            '[sampling]\ndataset = "s"\n[contact]\nevaluation = "exact"\n',
            "contact does not go with",
        ),
        ('[sampling]\ndataset = "s"\n[implant]\npreset = "flat"\n', "implant does not go with"),
    ],
)
def test_settings_that_would_be_ignored_are_refused(tmp_path, text, said):
    (tmp_path / "knee.toml").write_text(text)
    with pytest.raises(InputDataError, match=said):
        read_study(tmp_path / "knee.toml")
