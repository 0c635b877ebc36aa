# SPDX-License-Identifier: Apache-2.0
"""A solver in another process: what is sent there, and how it becomes a solver once.

What travels is bytes (meshes, law, settings). A process makes a solver of them when it is first asked for an
equilibrium, and keeps it for all chunks: a distance field and a map of first touches are as dear as many samples.
"""

from __future__ import annotations

import os
import pickle
import socket
import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from condyle.errors import InputDataError
from condyle.sampling.equilibrium_protocol import Prescribed, Solved
from condyle.sampling.same_results import check_environment, environment, environment_of
from condyle.whole_files import content_hash

if TYPE_CHECKING:
    from condyle.sampling.evaluate import ContactSolver

#: Solvers that a process keeps, newest last: two runs may share a cluster.
_KEPT: Final = 2
_lock = threading.Lock()
_made: OrderedDict[str, ContactSolver] = OrderedDict()


@dataclass(frozen=True)
class SentSolver:
    """A :class:`~condyle.sampling.evaluate.ContactSolver` on its way, or arrived.

    It solves on one thread a call: the other cores of a machine have chunks of their own.

    Attributes:
        content: The pickled arguments of the solver.
        environment: Of the process that sent it.
    """

    content: bytes = field(repr=False)
    environment: Mapping[str, str]

    def __call__(self, prescribed: Prescribed) -> Solved:
        """Solves here.

        Raises:
            CondyleError: This process would not compute the sender's bytes.
        """
        return self._solver()(prescribed)

    def _solver(self) -> ContactSolver:
        key = content_hash(self.content)
        with _lock:
            if key not in _made:
                _made[key] = self._make()
                while len(_made) > _KEPT:
                    _made.popitem(last=False)
            return _made[key]

    def _make(self) -> ContactSolver:
        where = f"worker process {os.getpid()} on {socket.gethostname()}"
        check_environment(environment(), self.environment, where)
        from condyle.sampling.evaluate import ContactSolver

        model, settings = pickle.loads(self.content)
        solver = ContactSolver(model, settings=settings_from(settings), threads=1)
        check_environment(environment_of(solver), self.environment, where)
        return solver


def packed(model: object, settings: object) -> bytes:
    """The bytes of a solver's arguments.

    Raises:
        InputDataError: The contact model cannot be sent to another process.
    """
    try:
        return pickle.dumps((model, values_of(settings)))
    except (TypeError, pickle.PicklingError, AttributeError) as error:
        raise InputDataError(
            f"the contact model {type(model).__name__} cannot be sent to another process ({error}); "
            "sample with threads instead"
        ) from error


def values_of(settings: Any) -> dict[str, Any] | None:
    """The values of core settings, nested ones as dicts, by name; None of none."""
    if settings is None:
        return None
    values = {}
    for name in dir(settings):
        if not name.startswith("_"):
            value = getattr(settings, name)
            values[name] = value if isinstance(value, int | float) else values_of(value)
    return values


def settings_from(values: Mapping[str, Any] | None) -> Any:
    """The settings of a static equilibrium solver from :func:`values_of`."""
    from condyle.fdk import StaticEquilibriumSettings

    if values is None:
        return None
    settings = StaticEquilibriumSettings()
    _fill(settings, values)
    return settings


def _fill(settings: Any, values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        if isinstance(value, Mapping):
            _fill(getattr(settings, name), value)
        else:
            setattr(settings, name, value)
