# SPDX-License-Identifier: Apache-2.0
"""A potential surrogate is elastic by construction, whatever evaluates its file."""

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from condyle.contact import Derivatives
from condyle.surrogate import load_surrogate


def _wrench_to_force(poses: np.ndarray) -> np.ndarray:
    """Gᵀ (n, 6, 6) of Q = Gᵀ·wrench."""
    (cx, cy), (sx, sy) = np.cos(poses[:, 3:5].T), np.sin(poses[:, 3:5].T)
    matrix = np.zeros((len(poses), 6, 6))
    matrix[:, [0, 1, 2], [0, 1, 2]] = 1.0
    matrix[:, 3, 3] = -1.0
    matrix[:, 4, 4], matrix[:, 4, 5] = -cx, sx
    matrix[:, 5, 3], matrix[:, 5, 4], matrix[:, 5, 5] = sy, -cy * sx, -cy * cx
    return matrix


def _generalised_stiffness(
    poses: np.ndarray, wrench: np.ndarray, stiffness: np.ndarray
) -> np.ndarray:
    """∂Q/∂pose (n, 6, 6) = Gᵀ·S + ∂(Gᵀ·w)/∂pose, of one side."""
    (cx, cy), (sx, sy) = np.cos(poses[:, 3:5].T), np.sin(poses[:, 3:5].T)
    mx, my, mz = wrench[:, 3:].T
    result = _wrench_to_force(poses) @ stiffness
    result[:, 4, 3] += sx * my + cx * mz
    result[:, 5, 3] += -cy * cx * my + cy * sx * mz
    result[:, 5, 4] += cy * mx + sy * sx * my + sy * cx * mz
    return result


@pytest.mark.parametrize("runtime", ["fused", "onnxruntime"])
def test_generalised_stiffness_is_symmetric(
    exported_potential: tuple[Path, Path], poses: np.ndarray, runtime: str
) -> None:
    loads = load_surrogate(exported_potential[0], runtime=runtime).evaluate(
        poses, Derivatives.stiffness, 1
    )
    for side in range(2):
        loaded = loads.wrench[:, side].any(axis=1)
        assert 30 < loaded.sum() < 280
        matrix = _generalised_stiffness(
            poses[loaded], loads.wrench[loaded, side], loads.stiffness[loaded, side]
        )
        skew = np.abs(matrix - matrix.transpose(0, 2, 1)).max(axis=(1, 2))
        assert (skew <= 1e-10 * np.abs(matrix).max(axis=(1, 2))).all()


@pytest.mark.parametrize("architecture", ["exported_potential", "exported"])
def test_a_closed_path_does_no_work_on_an_energy_and_some_on_networks_of_loads(
    architecture: str, tiny: ModuleType, request: pytest.FixtureRequest
) -> None:
    model = load_surrogate(request.getfixturevalue(architecture)[0])
    t = 2 * np.pi * np.arange(4000)[:, None] / 4000
    # A loop through all six coordinates. On a smooth one the trapezoid rule is exact; at lift-off
    # the second derivative has a kink (power 3) or a root (2.5): O(n^-2.5) at least.
    harmonic, phase = np.array([1, 2, 1, 2, 1, 2]), 0.7 * np.arange(6)
    reach = np.array([0.9, 0.9, 0.7, 0.6, 0.5, 0.4]) * tiny.HALF_WIDTH
    poses = tiny.CENTRE + reach * np.sin(harmonic * t + phase)
    velocity = reach * harmonic * np.cos(harmonic * t + phase)
    wrench = model.evaluate(poses, Derivatives.none, 1).wrench
    lifted = ~wrench.any(axis=2)
    assert lifted.any() and not lifted.all()
    force = np.einsum("nij,nsj->nsi", _wrench_to_force(poses), wrench)
    power = np.einsum("nsi,ni->ns", force, velocity)
    work = np.abs(power.mean(axis=0)) / np.abs(power).mean(axis=0)
    if architecture == "exported_potential":
        assert (work < 1e-6).all(), work
    else:
        assert (work > 1e-3).all(), work
