# SPDX-License-Identifier: Apache-2.0
"""Networks as they were on the way of a training."""

import dataclasses
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from condyle.training import TrainingSettings, train_two_stage
from condyle.training.snapshots import SnapshotRecorder, read_snapshots, surrogate_over_time
from condyle.training.train_potential import train_potential

SETTINGS = TrainingSettings(hidden_layers=1, neurons=6, max_epochs=12, patience=0, seed=5)
TRAIN = {"two_stage": train_two_stage, "potential": train_potential}


@pytest.fixture(scope="module")
def samples(contact):
    poses = contact.sample(900, 41)
    return poses, contact.wrench(poses)


@pytest.mark.parametrize("architecture", ["two_stage", "potential"])
def test_the_last_is_the_finished_surrogate_and_errors_fall_towards_it(
    samples, tmp_path, architecture
):
    checkpoint = tmp_path / "checkpoint"
    recorder = SnapshotRecorder(tmp_path, checkpoint, every=2)
    finished, record = TRAIN[architecture](
        *samples, SETTINGS, progress=recorder, checkpoint=checkpoint
    )
    curve = list(surrogate_over_time(finished, read_snapshots(tmp_path)))
    assert len(curve) >= 4
    np.testing.assert_array_equal(
        curve[-1].surrogate.wrench(samples[0]), finished.wrench(samples[0])
    )
    # The step in which an optimiser finds that it has stopped may come after the last snapshot.
    assert 0.7 * sum(record.wall_times_s.values()) < curve[-1].seconds
    assert curve[-1].seconds <= sum(record.wall_times_s.values())
    done = {side: 0 for side in ("medial", "lateral")} if architecture == "potential" else {}
    for net in record.nets:
        part = net.name.split(" ")[0]
        done[part] = done.get(part, 0) + net.epochs
    assert curve[-1].epochs == tuple(done.values())
    assert all(
        len(one.losses) == len(one.epochs) == len(done) and all(np.isfinite(one.losses))
        for one in curve
    )
    errors = [np.abs(one.surrogate.wrench(samples[0]) - samples[1]).mean() for one in curve]
    assert errors[-1] < 0.5 * errors[0]
    assert all(a.seconds < b.seconds for a, b in pairwise(curve))


def test_a_snapshot_is_the_training_stopped_there(samples, tmp_path):
    """Net I after 6 epochs is what 6 epochs give; nets II and III learn from the finished net I."""
    checkpoint = tmp_path / "checkpoint"
    recorder = SnapshotRecorder(tmp_path, checkpoint, every=6)
    train_two_stage(*samples, SETTINGS, progress=recorder, checkpoint=checkpoint)
    short, _ = train_two_stage(*samples, dataclasses.replace(SETTINGS, max_epochs=6))
    (kept,) = (s for s in read_snapshots(tmp_path) if (s.net, s.epoch) == ("I", 6))
    np.testing.assert_array_equal(kept.parameters.numpy(), short.first.get_parameters().numpy())


def test_what_a_killed_training_kept_is_there_after_resuming(samples, tmp_path):
    class Killed(Exception):
        pass

    def kill(net, epoch, *_):
        if (net, epoch) == ("II", 5):
            raise Killed

    checkpoint = tmp_path / "checkpoint"
    with pytest.raises(Killed):
        train_two_stage(
            *samples,
            SETTINGS,
            progress=SnapshotRecorder(tmp_path, checkpoint, 2, kill),
            checkpoint=checkpoint,
        )
    before = _kept(tmp_path)
    assert before[-1] == ("II", 4)
    train_two_stage(
        *samples,
        SETTINGS,
        progress=SnapshotRecorder(tmp_path, checkpoint, 2),
        checkpoint=checkpoint,
    )
    after = _kept(tmp_path)
    assert after[: len(before)] == before
    expected = [(net, epoch) for net in ("I", "II", "III") for epoch in range(2, 13, 2)]
    assert after == expected


def test_without_snapshots_of_every_part_there_is_no_curve(samples):
    surrogate, _ = train_two_stage(*samples, dataclasses.replace(SETTINGS, max_epochs=1))
    assert list(surrogate_over_time(surrogate, [])) == []


def _kept(folder: Path) -> list[tuple[str, int]]:
    return [(snapshot.net, snapshot.epoch) for snapshot in read_snapshots(folder)]
