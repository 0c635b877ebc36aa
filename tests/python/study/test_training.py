# SPDX-License-Identifier: Apache-2.0
"""From [training] to settings, and what is told of a training."""

import math

import pytest

pytest.importorskip("torch")

from condyle.study.training import TrainingProgress, duration, trainer, training_settings
from condyle.study.training_section import TrainingSection
from condyle.training.settings import TrainingSettings
from condyle.training.train import train_two_stage
from condyle.training.train_potential import train_potential


class Log:
    """Remembers progress."""

    def __init__(self) -> None:
        self.told: list[tuple[str, float, str]] = []

    def stage(self, name: str, text: str) -> None:
        """Ignored."""

    def skipped(self, name: str) -> None:
        """Ignored."""

    def progress(self, task: str, fraction: float, note: str) -> None:
        self.told.append((task, fraction, note))

    def finished(self, name: str, text: str) -> None:
        """Ignored."""


def test_every_setting_reaches_the_training():
    values = {
        "architecture": "potential", "hidden_layers": 2, "neurons": 17, "max_epochs": 33, "time_budget_s": 71.5,
        "patience": 4, "power": 2.75, "seed": 9, "threads": 3,
    }  # fmt: skip
    settings = training_settings(TrainingSection.model_validate(values))
    del values["architecture"]
    assert {name: getattr(settings, name) for name in values} == values
    assert (
        training_settings(TrainingSection(architecture="two_stage", precision="mixed")).precision
        == "mixed"
    )
    assert training_settings(TrainingSection()).time_budget_s == math.inf


def test_the_study_defaults_to_what_the_library_does_but_for_speed():
    section, settings = TrainingSection(), TrainingSettings()
    for name in ("hidden_layers", "neurons", "patience", "precision", "power", "seed"):
        assert getattr(section, name) == getattr(settings, name), name


def test_the_architecture_decides_what_trains():
    assert trainer(TrainingSection()) is train_potential
    assert trainer(TrainingSection(architecture="two_stage")) is train_two_stage


def test_of_three_like_nets_the_whole_is_told_from_the_first():
    log = Log()
    progress = TrainingProgress(log, "two_stage")
    progress("I", 5, 3.25e-4, 181.4, 100.0, 300.0)
    progress("III", 80, 1e-5, 200.0, 400.0, 0.0)
    (task, fraction, note), (_, last, end) = log.told
    assert task == "net I"
    assert fraction == pytest.approx(0.25 / 3)
    # 300 s of net I, and twice 400 s.
    assert note == "epoch 5, mse 3.25e-04, γ 181, at most 5 min left, 18 min for all nets"
    assert last == 1.0
    assert end.endswith("at most 0 s left, 0 s for all nets")


def test_of_unlike_stages_only_the_one_is_told():
    log = Log()
    TrainingProgress(log, "potential", "900 samples, ")("medial level", 1, 1.0, 3.0, 10.0, 30.0)
    assert log.told == [
        ("900 samples, net medial level", 0.25, "epoch 1, mse 1.00e+00, γ 3, at most 30 s left")
    ]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.4, "0 s"), (119.0, "119 s"), (121.0, "2 min"), (7100.0, "118 min"), (9000.0, "2.5 h")],
)
def test_durations_are_for_people(seconds, text):
    assert duration(seconds) == text
