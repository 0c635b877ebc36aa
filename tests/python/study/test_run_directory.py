# SPDX-License-Identifier: Apache-2.0
import pytest

from condyle.study.run_directory import RunDirectory, digest_of_data, write_whole


@pytest.fixture
def run(tmp_path):
    return RunDirectory(tmp_path / "runs" / "knee")


def worker(run, log, text="made"):
    def work():
        log.append(text)
        file = run.root / "result.txt"
        write_whole(file, text)
        return [file]

    return work


def test_a_stage_runs_once_for_the_same_inputs(run):
    log: list[str] = []
    assert run.run_stage("make", {"a": 1, "b": [2, 3]}, worker(run, log))
    assert not run.run_stage("make", {"b": [2, 3], "a": 1}, worker(run, log))
    assert log == ["made"]


def test_a_stage_runs_again_when_inputs_change_or_outputs_are_damaged(run):
    log: list[str] = []
    run.run_stage("make", {"a": 1}, worker(run, log))
    assert run.run_stage("make", {"a": 2}, worker(run, log))
    (run.root / "result.txt").write_text("edited by hand")
    assert run.run_stage("make", {"a": 2}, worker(run, log))
    (run.root / "result.txt").unlink()
    assert run.run_stage("make", {"a": 2}, worker(run, log))
    run.stage_record("make").write_text("{ truncated")
    assert run.run_stage("make", {"a": 2}, worker(run, log))
    assert len(log) == 5


def test_a_stage_that_fails_does_not_look_finished(run):
    log: list[str] = []
    run.run_stage("make", {"a": 1}, worker(run, log))

    def fail():
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        run.run_stage("make", {"a": 2}, fail)
    assert run.stage_outputs("make") is None
    assert (run.root / "result.txt").exists()
    assert run.run_stage("make", {"a": 1}, worker(run, log))


def test_digests_do_not_depend_on_the_order_of_keys():
    assert digest_of_data({"a": 1, "b": 2.5}) == digest_of_data({"b": 2.5, "a": 1})
    assert digest_of_data({"a": 1}) != digest_of_data({"a": 2})
