# SPDX-License-Identifier: Apache-2.0
"""Learning curves of a study, and that what is finished is kept."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")
sys.path.insert(0, str(Path(__file__).parents[1] / "sampling"))

from external_knee import external_table

from condyle.errors import CondyleError, InputDataError
from condyle.sampling import TableUnits, import_samples
from condyle.study import Study, StudyRun
from condyle.study.context import StudyContext
from condyle.study.external_samples import adopt_samples
from condyle.study.learning_curves import LearningPlan, learning_curves, nested_order

TRAINING = {
    "architecture": "two_stage",
    "neurons": 8,
    "hidden_layers": 1,
    "max_epochs": 30,
    "patience": 0,
    "threads": 1,
}
PLAN = LearningPlan(shares=(0.25, 1.0), minutes=(1e-4, 60.0), every=5)


class Log:
    """Remembers which trainings told of epochs."""

    def __init__(self) -> None:
        self.trained: list[str] = []

    def stage(self, name: str, text: str) -> None:
        """Ignored."""

    def skipped(self, name: str) -> None:
        """Ignored."""

    def progress(self, task: str, fraction: float, note: str) -> None:
        assert 0.0 <= fraction <= 1.0
        if "net" in task:
            assert "left" in note
            self.trained.append(task)

    def finished(self, name: str, text: str) -> None:
        """Ignored."""


def prepare(folder: Path, log: Log, **training: object) -> StudyContext:
    """A study of 1 000 samples from elsewhere, up to its samples."""
    if not (folder / "samples").exists():
        external_table(1000, 43).to_csv(folder / "knee.csv", index=False)
        units = TableUnits("mm", "deg", "N", "Nmm")
        import_samples(
            folder / "knee.csv",
            folder / "samples",
            source="rollers",
            side_of_body="right",
            units=units,
        )
    study = Study.model_validate(
        {
            "name": "knee",
            "sampling": {"dataset": folder / "samples"},
            "training": TRAINING | training,
        }
    )
    context = StudyRun(study, folder / "runs", threads=1, reporter=log).context
    adopt_samples(context)  # the stage itself would draw figures too
    return context


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A run with its learning curves."""
    folder = tmp_path_factory.mktemp("learning")
    assert learning_curves(prepare(folder, Log()), PLAN)
    return folder


def test_beginnings_of_the_order_hold_every_domain_in_proportion():
    domain = np.random.default_rng(3).choice([2, 4, 5], 800, p=[0.7, 0.2, 0.1])
    order = nested_order(domain, seed=4)
    assert sorted(order) == list(range(800))
    for length in (50, 199, 400):
        for number in (2, 4, 5):
            # A domain's k-th row stands at k/m of the whole: off by one row at the most.
            expected = length * (domain == number).mean()
            assert abs((domain[order[:length]] == number).sum() - expected) <= 1
    assert not np.array_equal(order, nested_order(domain, seed=5))


def test_more_samples_give_smaller_errors(folder):
    table = json.loads((folder / "runs/knee/tables/learning_curves.json").read_text())
    few, all_of_them = table["points"]
    assert few["samples"] == round(0.25 * all_of_them["samples"])
    assert few["over_time"] == [] and len(all_of_them["over_time"]) > 3
    fy = [
        sum(r["rmse"] for r in p["errors"] if (r["domain"], r["load"]) == ("all", "Fy"))
        for p in (few, all_of_them)
    ]
    assert fy[1] < fy[0]
    # The end of the curve over time is the surrogate itself.
    last = all_of_them["over_time"][-1]["errors"]
    assert last == [r for r in all_of_them["errors"] if r["domain"] == "all"]


def test_text_and_figure_are_in_the_run(folder):
    text = (folder / "runs/knee/learning_curves.md").read_text()
    assert "| samples | training [min] | medial Fy [N] | lateral Fy [N] | medial Mx [Nm] |" in text
    assert "| 0.0001 | not yet a surrogate | – |" in text
    assert "(end) | 30, 30, 30 |" in text
    assert "![learning curves](figures/learning_curves.png)" in text
    assert (folder / "runs/knee/figures/learning_curves.png").stat().st_size > 5000
    left = [f.name for f in (folder / "runs/knee/learning").rglob("*") if f.is_file()]
    assert left == ["point.json", "point.json"]


def test_finished_points_are_kept(folder):
    log = Log()
    context = prepare(folder, log)
    assert not learning_curves(context, PLAN)  # unchanged
    more = LearningPlan(shares=(0.25, 0.5, 1.0), minutes=(1.0,), every=5)
    assert learning_curves(context, more)
    assert {task.split(" ")[0] for task in log.trained} == {"425"}
    table = json.loads((folder / "runs/knee/tables/learning_curves.json").read_text())
    assert [point["samples"] for point in table["points"]] == [212, 425, 850]


def test_a_killed_point_goes_on(folder, tmp_path):
    class Killed(Exception):
        pass

    class Killer(Log):
        def progress(self, task: str, fraction: float, note: str) -> None:
            super().progress(task, fraction, note)
            if task == "850 samples, net II" and "epoch 9," in note:
                raise Killed

    (tmp_path / "samples").symlink_to(folder / "samples")
    plan = LearningPlan(shares=(1.0,), minutes=(60.0,), every=3)
    with pytest.raises(Killed):
        learning_curves(prepare(tmp_path, Killer()), plan)
    log = Log()
    assert learning_curves(prepare(tmp_path, log), plan)
    assert log.trained[0] == "850 samples, net II"  # net I is not trained again
    table = json.loads((tmp_path / "runs/knee/tables/learning_curves.json").read_text())
    whole = json.loads((folder / "runs/knee/tables/learning_curves.json").read_text())
    assert table["points"][-1]["errors"] == whole["points"][-1]["errors"]
    assert table["points"][-1]["over_time"][-1]["epochs"] == [30, 30, 30]


def test_a_search_is_refused(folder):
    study_training = {"architecture": "two_stage", "search": True, "threads": 1}
    study = Study.model_validate(
        {"name": "knee", "sampling": {"dataset": folder / "samples"}, "training": study_training}
    )
    run = StudyRun(study, folder / "runs", threads=1)
    with pytest.raises(CondyleError, match="learning curves need one architecture for all points"):
        learning_curves(run.context, PLAN)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"shares": (0.0, 0.5)}, r"shares are \(0.0, 0.5\); each must be above 0, at most 1"),
        ({"minutes": (0.0,)}, r"minutes are \(0.0,\); each must be above 0"),
        ({"every": 0}, "every is 0; it must be at least 1"),
    ],
)
def test_unfit_plans_are_refused(options, message):
    with pytest.raises(InputDataError, match=message):
        LearningPlan(**options)


def test_a_plan_is_put_in_order():
    plan = LearningPlan.of([1.0, 0.25, 0.25], None)
    assert plan.shares == (0.25, 1.0)
    assert plan.minutes == (5.0, 15.0, 30.0, 60.0)
