# SPDX-License-Identifier: Apache-2.0
"""The paper's architecture search: order of the trials, acceptance, time budget."""

import pytest

from condyle.errors import InputDataError
from condyle.training import ArchitectureSearchSettings, TrainingSettings, search_architecture
from condyle.training.architecture_search import candidate_architectures

SETTINGS = TrainingSettings(max_epochs=15, patience=0, seed=2)


def test_trials_come_in_the_papers_order_up_to_its_outcome():
    trials = list(candidate_architectures(ArchitectureSearchSettings()))
    assert trials[:7] == [(2, 10), (2, 20), (2, 30), (2, 40), (3, 10), (3, 20), (3, 30)]


def test_the_first_to_reach_the_performance_is_accepted(contact):
    poses = contact.sample(500, 61)
    search = ArchitectureSearchSettings(
        start_layers=1, start_neurons=1, neuron_step=5, max_neurons=11, performance=0.02
    )
    told = []
    accepted, trials = search_architecture(
        poses, contact.wrench(poses), SETTINGS, search, on_trial=told.append
    )
    assert tuple(told) == trials
    assert (trials[0].hidden_layers, trials[0].neurons) == (1, 1) and not trials[0].accepted
    assert [trial.accepted for trial in trials] == [False] * (len(trials) - 1) + [True]
    assert trials[-1].performance < 0.02 and trials[-1].stop_reason == "goal"
    assert (accepted.hidden_layers, accepted.neurons) == (
        trials[-1].hidden_layers,
        trials[-1].neurons,
    )
    assert accepted.max_epochs == SETTINGS.max_epochs


def test_out_of_time_everywhere_the_best_trial_is_taken(contact):
    poses = contact.sample(500, 62)
    search = ArchitectureSearchSettings(
        start_layers=1, max_layers=2, start_neurons=2, max_neurons=2, trial_time_s=1e-9
    )
    accepted, trials = search_architecture(poses, contact.wrench(poses), SETTINGS, search)
    assert [trial.stop_reason for trial in trials] == ["time", "time"]
    assert not any(trial.accepted for trial in trials)
    best = min(trials, key=lambda trial: trial.performance)
    assert accepted.hidden_layers == best.hidden_layers


def test_unfit_search_settings_are_refused():
    with pytest.raises(InputDataError, match="max_neurons is 5; it must be >= start_neurons = 10"):
        ArchitectureSearchSettings(max_neurons=5)
    with pytest.raises(InputDataError, match="trial_time_s is 0"):
        ArchitectureSearchSettings(trial_time_s=0)


def test_a_killed_search_goes_on_from_its_checkpoint(contact, tmp_path):
    class Killed(Exception):
        pass

    def kill(net, epoch, *_):
        if (net, epoch) == ("I 1x3", 4):
            raise Killed

    poses = contact.sample(500, 63)
    samples = poses, contact.wrench(poses)
    search = ArchitectureSearchSettings(
        start_layers=1,
        max_layers=1,
        start_neurons=1,
        neuron_step=2,
        max_neurons=5,
        performance=1e-9,
    )
    whole = search_architecture(*samples, SETTINGS, search)
    file = tmp_path / "search"
    with pytest.raises(Killed):
        search_architecture(*samples, SETTINGS, search, progress=kill, checkpoint=file)
    seen = []
    resumed = search_architecture(
        *samples, SETTINGS, search, progress=lambda *e: seen.append(e[:2]), checkpoint=file
    )
    assert seen[0] == ("I 1x3", 5)  # neither the finished trial nor the first epochs again
    assert resumed == whole
    with pytest.raises(InputDataError, match="checkpoint of another training: architecture_search"):
        search_architecture(
            *samples, SETTINGS, ArchitectureSearchSettings(performance=1e-8), checkpoint=file
        )
