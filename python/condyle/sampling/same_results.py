# SPDX-License-Identifier: Apache-2.0
"""Whether another process would compute the same bytes: versions, and the last digits of its arithmetic.

A dataset must not depend on who evaluated which chunk. Versions alone do not promise that: NumPy and the contact
kernels choose instructions by the processor, whose sums and sines agree to rounding only. So a process that is sent a
solver first proves on a few equilibria that it gets the sender's bits.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Mapping
from typing import Final

import numpy as np
import pyarrow as pa

import condyle
from condyle.errors import CondyleError
from condyle.sampling.equilibrium_protocol import CONVERGED, Prescribed, StaticEquilibriumSolver

_ARITHMETIC: Final = "arithmetic"
_SOLVER: Final = "solver"


def environment() -> dict[str, str]:
    """Versions, and a digest of NumPy's elementary functions, of this process."""
    return {
        "condyle": condyle.__version__,
        "python": f"{sys.version_info.major}.{sys.version_info.minor}",
        "numpy": np.__version__,
        "pyarrow": pa.__version__,
        _ARITHMETIC: _arithmetic(),
    }


def environment_of(solver: StaticEquilibriumSolver) -> dict[str, str]:
    """As :func:`environment`, and a digest of what ``solver`` answers here to a few equilibria."""
    return {**environment(), _SOLVER: _answers(solver)}


def check_environment(found: Mapping[str, str], wanted: Mapping[str, str], where: str) -> None:
    """Refuse a process that would not compute the same bytes.

    Args:
        found: Its environment.
        wanted: That of the process that samples.
        where: What it is called in messages.

    Raises:
        CondyleError: Names what differs, both values and what to do.
    """
    for name, value in wanted.items():
        if name not in found or found[name] == value:
            continue
        if name in (_ARITHMETIC, _SOLVER):
            what = {_ARITHMETIC: "NumPy", _SOLVER: "the contact model"}[name]
            raise CondyleError(
                f"{where}: {what} gives other last digits than where sampling was started, so samples would depend "
                "on who computed them; use processors of one kind (as a SLURM --constraint selects)"
            )
        raise CondyleError(
            f"{where}: {name} is {found[name]}, {value} where sampling was started; samples must not depend on who "
            f"computed them: install {name} {value} there"
        )


def _arithmetic() -> str:
    values = np.linspace(-3.1, 7.3, 1003)
    results = [np.sin(values), np.cos(values), np.exp(values), np.log1p(values**2)]
    results.append(np.sqrt(values**2 + 0.3))
    return _digest(results)


def _answers(solver: StaticEquilibriumSolver) -> str:
    """Of equilibria that most knees have: light to heavy, extended to flexed, tilted both ways."""
    force = np.array([45.0, 1450.0, 240.0])
    solved = solver(
        Prescribed(
            x=np.array([0.0, 0.001, -0.001]),
            Fy=force,
            z=np.array([0.0, 0.0003, -0.0004]),
            Mx=force * np.array([0.0, 0.003, -0.004]),
            theta_y=np.array([0.0, 0.01, -0.02]),
            theta_z=np.array([0.0, -0.3, -0.8]),
        )
    )
    converged = np.asarray(solved.status) == CONVERGED
    numbers = [np.asarray(solved.poses)[converged], np.asarray(solved.wrenches)[converged]]
    return _digest([*numbers, converged.astype(np.float64)])


def _digest(arrays: list[np.ndarray[tuple[int, ...], np.dtype[np.float64]]]) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:16]
