# SPDX-License-Identifier: Apache-2.0
"""Chunks on a Dask cluster: many cores of many machines, the same bytes.

    with cluster_executor("tcp://head:8786") as executor:
        sample(plan, curves, solver, directory, identity, executor=executor)

The dataset is written here, by one process; workers only compute. A worker that dies costs its unfinished chunks, which
others take over; workers may join at any time. Every worker proves that it computes this process's bytes before its
first chunk (:mod:`condyle.sampling.same_results`). Needs the extra ``cluster``.
"""

from __future__ import annotations

import pickle
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Final, Self, TypeVar

from condyle.errors import CondyleError, InputDataError
from condyle.sampling.executors import Pending
from condyle.sampling.same_results import check_environment, environment

T = TypeVar("T")

#: Times that a chunk whose evaluation raised is given to another worker.
RETRIES: Final = 3
#: Chunks in flight: at least so many, and so many a worker's thread.
_LEAST_IN_FLIGHT: Final = 64
_IN_FLIGHT_A_THREAD: Final = 3
#: Arguments of this size and more are sent to the cluster once, not with every chunk [bytes].
_SHARED_SIZE: Final = 16_384
#: Shared arguments that are held: solver and domain of this round, and of the one before.
_SHARED_HELD: Final = 4


class ClusterExecutor:
    """Runs functions on a Dask cluster, see the module docstring.

    Args:
        address: The scheduler's, such as ``tcp://head:8786``.
        timeout: To wait for the scheduler, and for its first worker [s].

    Raises:
        InputDataError: Dask is not installed, or no scheduler or no worker is there.
        CondyleError: A worker has no Condyle, or another version.
    """

    def __init__(self, address: str, *, timeout: float = 60.0) -> None:
        distributed = _distributed()
        self._address = address
        try:
            self._client = distributed.Client(address, timeout=timeout, set_as_default=False)
        except (OSError, ValueError) as error:  # a timeout is an OSError too
            raise InputDataError(
                f"no Dask scheduler answers at {address!r} ({_first_line(error)}); start one with `dask scheduler` "
                "and give the address that it prints"
            ) from error
        self._shared: deque[tuple[Any, Any]] = deque(maxlen=_SHARED_HELD)
        try:
            self._check_workers(timeout)
        except BaseException:
            self.close()
            raise

    @property
    def in_flight(self) -> int:
        """Chunks to hand over at a time, by the workers that are there now."""
        threads = sum(int(n) for n in self._client.nthreads().values())
        return max(_LEAST_IN_FLIGHT, _IN_FLIGHT_A_THREAD * threads)

    def submit(self, fn: Callable[..., T], /, *args: Any) -> Pending[T]:
        """Hands over ``fn(*args)``; large arguments that come again are sent once."""
        sent = [self._sent(argument) for argument in args]
        return _Result(self._client.submit(fn, *sent, pure=False, retries=RETRIES), self._address)

    def close(self) -> None:
        """Leaves the cluster; the cluster stays."""
        self._shared.clear()
        self._client.close()

    def __enter__(self) -> Self:
        """The executor itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leaves the cluster."""
        self.close()

    def _sent(self, argument: Any) -> Any:
        """The argument itself, or what stands for it on the cluster."""
        for known, future in self._shared:
            if known is argument:
                return future
        content = pickle.dumps(argument)
        if len(content) < _SHARED_SIZE:
            return argument
        # A task, not scattered data: the scheduler can make it again when its worker is gone.
        future = self._client.submit(pickle.loads, content, pure=False, retries=RETRIES)
        self._shared.append((argument, future))
        return future

    def _check_workers(self, timeout: float) -> None:
        """Those that are there; who joins later is checked before its first chunk."""
        try:
            self._client.wait_for_workers(1, timeout=timeout)
        except OSError as error:
            raise InputDataError(
                f"the Dask scheduler at {self._address} has no worker after {timeout:.0f} s; start one with "
                f"`dask worker {self._address}`"
            ) from error
        found = self._client.run(environment, on_error="return")
        for worker, answer in found.items():
            if isinstance(answer, ImportError):
                raise CondyleError(
                    f"worker {worker}: {answer}; install the same version of condyle there"
                ) from answer
            if isinstance(answer, dict):
                check_environment(answer, environment(), f"worker {worker}")


class _Result:
    """Work on the cluster."""

    def __init__(self, future: Any, address: str) -> None:
        self._future = future
        self._address = address

    def result(self) -> Any:
        try:
            return self._future.result()
        except Exception as error:
            explained = _explained(error, self._address)
            if explained is error:
                raise
            raise explained from error

    def done(self) -> bool:
        return bool(self._future.done())

    def cancel(self) -> object:
        return self._future.cancel()


@contextmanager
def cluster_executor(address: str | None) -> Iterator[ClusterExecutor | None]:
    """An executor on the cluster at ``address``, closed at the end; None for None.

    Raises:
        InputDataError: As :class:`ClusterExecutor`.
        CondyleError: As :class:`ClusterExecutor`.
    """
    if address is None:
        yield None
        return
    with ClusterExecutor(address) as executor:
        yield executor


def _distributed() -> Any:
    try:
        import distributed
    except ImportError as error:
        raise InputDataError(
            "sampling on a cluster needs Dask, which is not installed: pip install 'condyle[cluster]'"
        ) from error
    return distributed


def _explained(error: Exception, address: str) -> Exception:
    """What became of the cluster, in words of sampling; any other error is as it was."""
    from distributed import CancelledError, KilledWorker
    from distributed.comm import CommClosedError

    kept = "finished chunks are kept, run again to go on"
    if isinstance(error, KilledWorker):
        last = getattr(error.last_worker, "address", error.last_worker)
        return CondyleError(
            f"the cluster at {address}: {error.allowed_failures + 1} workers died over one chunk, the last at {last}; "
            "see its log: it may have been out of memory (take fewer workers a machine) or ended by the queue; "
            f"{kept}"
        )
    if isinstance(error, CancelledError | CommClosedError):
        return CondyleError(
            f"the cluster at {address} is lost ({_first_line(error)}): the scheduler is gone or cannot be reached; "
            f"{kept}"
        )
    if isinstance(error, ImportError):
        return CondyleError(
            f"a worker of the cluster at {address}: {error}; install the same version of condyle there; {kept}"
        )
    return error


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
