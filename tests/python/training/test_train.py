# SPDX-License-Identifier: Apache-2.0
"""Training as a whole: accuracy, reproducibility, resuming, and samples that are refused."""

import dataclasses
import json
from itertools import pairwise

import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.training import TrainingSettings, train_two_stage

QUICK = TrainingSettings(hidden_layers=1, neurons=5, max_epochs=6, patience=0, seed=5)


@pytest.fixture(scope="module")
def few(contact):
    poses = contact.sample(500, 31)
    return poses, contact.wrench(poses)


def _r_squared(predicted, truth):
    return 1 - ((predicted - truth) ** 2).sum(axis=0) / ((truth - truth.mean(axis=0)) ** 2).sum(
        axis=0
    )


def test_held_out_loads_are_predicted(trained):
    predicted = trained.surrogate.wrench(trained.test.poses)
    for side in range(2):
        truth = trained.test.wrenches[:, side]
        loaded = truth[:, 1] > 0
        r_squared = _r_squared(predicted[loaded, side], truth[loaded])
        # The paper's line is 0.99 medial and 0.96 lateral; this contact, half of whose samples are
        # within 0.5 mm of lift-off, is held to it with networks of a fifth of the paper's size.
        assert (r_squared > (0.99, 0.96)[side]).all(), r_squared


def test_record_tells_what_happened(trained):
    record = trained.record
    assert [net.name for net in record.nets] == ["I", "II", "III"]
    assert [net.widths for net in record.nets] == [(6, 14, 14, 4), (8, 14, 14, 4), (8, 14, 14, 4)]
    assert record.n_loaded == tuple((trained.train.wrenches[:, :, 1] > 0).sum(axis=0))
    for net in record.nets:
        assert net.epochs == 70 and net.stop_reason == "epochs" and "all epochs" in net.advice
        assert net.loss == net.history["loss"][-1] < 0.05 * net.history["loss"][0]
        assert all(0 < gamma <= net.n_parameters for gamma in net.history["gamma"])
    values = json.loads(json.dumps(record.to_dict()))
    assert values["settings"]["seed"] == 3 and values["settings"]["threads"] == 1
    assert "wall_times_s" not in values
    assert "history" not in record.to_dict(history=False)["nets"][0]


def test_the_same_seed_gives_the_same_networks_and_record(few):
    one, first_record = train_two_stage(*few, QUICK)
    two, second_record = train_two_stage(*few, QUICK)
    assert first_record.to_dict() == second_record.to_dict()
    np.testing.assert_array_equal(one.wrench(few[0]), two.wrench(few[0]))
    other, _ = train_two_stage(*few, dataclasses.replace(QUICK, seed=6))
    assert not np.array_equal(one.wrench(few[0]), other.wrench(few[0]))


@pytest.mark.parametrize(("net", "epoch"), [("I", 3), ("II", 6), ("III", 1)])
def test_a_training_killed_and_resumed_gives_the_identical_result(few, tmp_path, net, epoch):
    class Killed(Exception):
        pass

    def kill(name, done, loss, gamma, seconds, time_left):
        if (name, done) == (net, epoch):
            raise Killed

    whole, whole_record = train_two_stage(*few, QUICK)
    checkpoint = tmp_path / "training.checkpoint"
    with pytest.raises(Killed):
        train_two_stage(*few, QUICK, progress=kill, checkpoint=checkpoint)
    seen = []
    resumed, record = train_two_stage(
        *few, QUICK, progress=lambda *event: seen.append(event[:2]), checkpoint=checkpoint
    )
    assert seen[0] in ((net, epoch + 1), (net, epoch))
    assert record.to_dict() == whole_record.to_dict()
    np.testing.assert_array_equal(resumed.wrench(few[0]), whole.wrench(few[0]))
    assert [path.name for path in tmp_path.iterdir()] == ["training.checkpoint"]


def test_a_checkpoint_of_another_training_is_refused(few, tmp_path):
    checkpoint = tmp_path / "training.checkpoint"
    train_two_stage(*few, QUICK, checkpoint=checkpoint)
    with pytest.raises(InputDataError, match=r"training\.checkpoint: .* seed is 5, here 6"):
        train_two_stage(*few, dataclasses.replace(QUICK, seed=6), checkpoint=checkpoint)
    poses, wrenches = few
    with pytest.raises(InputDataError, match="data_hash is"):
        train_two_stage(poses, wrenches * 1.01, QUICK, checkpoint=checkpoint)


def test_progress_is_told_of_every_epoch(few):
    events = []
    train_two_stage(*few, QUICK, progress=lambda *event: events.append(event))
    assert {event[0] for event in events} == {"I", "II", "III"}
    first = [event for event in events if event[0] == "I"]
    assert [event[1] for event in first] == [1, 2, 3, 4, 5, 6, 6]
    assert first[-1][2] < first[0][2]
    assert first[-1][5] == 0 < first[0][5]
    assert all(before[4] <= after[4] for before, after in pairwise(first))


def _with(array, index, value):
    changed = array.copy()
    changed[index] = value
    return changed


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p, w: (_with(p, (7, 4), np.nan), w), "poses row 7 column theta_y is nan"),
        (lambda p, w: (p, _with(w, (3, 1, 5), np.inf)), "wrenches row 3 lateral Mz is inf"),
        (lambda p, w: (p[:, :5], w), r"poses has shape \(500, 5\)"),
        (lambda p, w: (p, w[:-1]), r"wrenches has shape \(499, 2, 6\); it must be \(500, 2, 6\)"),
        (lambda p, w: (_with(p, 9, p[2]), w), "poses rows 2 and 9 are the same pose"),
        (
            lambda p, w: (p, _with(w, (slice(None), 1), 0.0)),
            "the lateral side is loaded in 0 of 500",
        ),
        (lambda p, w: ([["a"] * 6], w), "poses is not an array of numbers"),
    ],
)
def test_unfit_samples_are_refused(few, change, message):
    with pytest.raises(InputDataError, match=message):
        train_two_stage(*change(*few), QUICK)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"neurons": 0}, "neurons is 0; it must be an integer >= 1"),
        ({"threads": 1.5}, "threads is 1.5; it must be an integer"),
        ({"time_budget_s": 0.0}, "time_budget_s is 0.0; it must be > 0"),
        ({"precision": "half"}, "precision is 'half'; it must be one of float64, mixed"),
        ({"patience": -1}, "patience is -1"),
        ({"seed": -1}, "seed is -1"),
    ],
)
def test_unfit_settings_are_refused(options, message):
    with pytest.raises(InputDataError, match=message):
        TrainingSettings(**options)


@pytest.mark.parametrize(
    "options", [{"lift_off": "zero"}, {"second_stage_inputs": "true"}, {"precision": "mixed"}]
)
def test_the_alternatives_train_too(few, options):
    surrogate, record = train_two_stage(*few, dataclasses.replace(QUICK, **options))
    assert np.isfinite(surrogate.wrench(few[0])).all()
    assert all(net.history["loss"][-1] < net.history["loss"][0] for net in record.nets)
