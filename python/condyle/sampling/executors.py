# SPDX-License-Identifier: Apache-2.0
"""What sampling asks of an executor: any of concurrent.futures has it, and a cluster's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Generic, Protocol, TypeVar

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)

#: Chunks in flight: enough to keep many workers busy, few enough to keep memory flat.
_IN_FLIGHT: Final = 64


class Pending(Protocol[T_co]):
    """Work that was handed over; a concurrent.futures.Future is one."""

    def result(self) -> T_co:
        """Waits, and gives what the work returned or raises what it raised."""
        ...

    def done(self) -> bool:
        """Whether ``result`` needs no waiting."""
        ...

    def cancel(self) -> object:
        """The result is not wanted any more."""
        ...


class ChunkExecutor(Protocol):
    """Runs functions elsewhere. One with an attribute ``in_flight`` says how many at a time are worth handing over."""

    def submit(self, fn: Callable[..., T], /, *args: Any) -> Pending[T]:
        """Hands over ``fn(*args)``."""
        ...


@dataclass(frozen=True)
class Done(Generic[T]):
    """Work that was done at once."""

    value: T

    def result(self) -> T:
        """The value."""
        return self.value

    def done(self) -> bool:
        """It is."""
        return True

    def cancel(self) -> object:
        """Too late."""
        return False


def in_flight(executor: ChunkExecutor) -> int:
    """Chunks that an executor is to hold at a time."""
    return int(getattr(executor, "in_flight", _IN_FLIGHT))
