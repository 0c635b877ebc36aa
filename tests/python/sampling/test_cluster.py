# SPDX-License-Identifier: Apache-2.0
"""Sampling on a Dask cluster of two local worker processes."""

import logging
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from rocking_knee import SIX_DOMAINS, rocking_contact, rocking_curves

from condyle.errors import CondyleError, InputDataError
from condyle.sampling import SamplingProgress, cluster, sample
from condyle.sampling.cluster import ClusterExecutor, cluster_executor
from condyle.sampling.evaluate import equilibrium_solver

# What Dask and its event loop warn of while processes die is theirs.
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def local_cluster() -> Iterator[object]:
    distributed = pytest.importorskip(
        "distributed", reason="Dask is not installed (extra 'cluster')"
    )
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address="127.0.0.1:0",
        host="127.0.0.1",
        silence_logs=logging.CRITICAL,
    ) as running:
        yield running


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def import_something_missing() -> None:
    raise ModuleNotFoundError("No module named 'condyle'", name="condyle")


def test_a_worker_killed_half_way_changes_no_byte(local_cluster, tmp_path: Path, content) -> None:
    solver = equilibrium_solver(rocking_contact(), max_depth=SIX_DOMAINS.max_depth, threads=1)
    chunks = 0

    def count(_: SamplingProgress) -> None:
        nonlocal chunks
        chunks += 1

    sample(SIX_DOMAINS, rocking_curves(), solver, tmp_path / "here", {}, count)
    half, done = chunks // 2, 0
    with cluster_executor(local_cluster.scheduler_address) as executor:
        victim, other = executor._client.run(os.getpid).values()

        def kill_half_way(_: SamplingProgress) -> None:
            nonlocal done
            done += 1
            if done == half:
                os.kill(victim, signal.SIGKILL)

        sample(
            SIX_DOMAINS,
            rocking_curves(),
            solver,
            tmp_path / "cluster",
            {},
            kill_half_way,
            executor=executor,
        )
        assert victim not in executor._client.run(os.getpid).values()
        assert other in executor._client.run(os.getpid).values()
    assert half > 10
    assert done == chunks
    assert content(tmp_path / "cluster") == content(tmp_path / "here")


def test_arguments_that_come_again_are_sent_once(local_cluster) -> None:
    large, small = b"x" * 100_000, b"y"
    with ClusterExecutor(local_cluster.scheduler_address) as executor:
        assert executor._sent(small) is small
        first = executor._sent(large)
        assert first is executor._sent(large) is not large
        assert [executor.submit(len, large).result() for _ in range(3)] == [100_000] * 3
        assert executor.in_flight >= 64


def test_a_mistake_in_a_worker_arrives_as_it_is(local_cluster, monkeypatch) -> None:
    monkeypatch.setattr(cluster, "RETRIES", 0)
    with (
        ClusterExecutor(local_cluster.scheduler_address) as executor,
        pytest.raises(ValueError, match="invalid literal for int"),
    ):
        executor.submit(int, "seven").result()


def test_a_chunk_that_kills_every_worker_ends_with_advice(local_cluster) -> None:
    import cloudpickle

    this = sys.modules[__name__]
    cloudpickle.register_pickle_by_value(this)  # workers cannot import a test
    local_cluster.scheduler.allowed_failures = 0
    try:
        with (
            ClusterExecutor(local_cluster.scheduler_address) as executor,
            pytest.raises(
                CondyleError,
                match=r"1 workers died over one chunk, the last at tcp://.*finished chunks are kept",
            ),
        ):
            executor.submit(die).result()
    finally:
        local_cluster.scheduler.allowed_failures = 3
        cloudpickle.unregister_pickle_by_value(this)


def test_a_worker_without_condyle_is_named(local_cluster, monkeypatch) -> None:
    import cloudpickle

    this = sys.modules[__name__]
    cloudpickle.register_pickle_by_value(this)
    monkeypatch.setattr(cluster, "environment", import_something_missing)
    try:
        with pytest.raises(
            CondyleError,
            match=r"worker tcp://.*No module named 'condyle'; install the same version",
        ):
            ClusterExecutor(local_cluster.scheduler_address)
    finally:
        cloudpickle.unregister_pickle_by_value(this)


def test_no_scheduler_is_told_with_its_address() -> None:
    pytest.importorskip("distributed", reason="Dask is not installed (extra 'cluster')")
    with pytest.raises(
        InputDataError, match=r"no Dask scheduler answers at 'tcp://127\.0\.0\.1:9'"
    ):
        ClusterExecutor("tcp://127.0.0.1:9", timeout=0.5)
    with pytest.raises(InputDataError, match="no Dask scheduler answers at 'nonsense://x'"):
        ClusterExecutor("nonsense://x", timeout=0.5)


def test_without_dask_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputDataError, match=r"not installed: pip install 'condyle\[cluster\]'"):
        ClusterExecutor("tcp://127.0.0.1:9")


def test_no_address_is_no_executor() -> None:
    with cluster_executor(None) as executor:
        assert executor is None
