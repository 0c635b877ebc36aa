# SPDX-License-Identifier: Apache-2.0
"""The same file gives the same numbers in C++, in onnxruntime's Python and in onnx.reference."""

import json
from pathlib import Path

import numpy as np
import pytest

from condyle.surrogate import parity


@pytest.mark.parametrize("architecture", ["exported", "exported_potential"])
def test_runtimes_agree_on_an_exported_file(
    architecture: str, poses: np.ndarray, request: pytest.FixtureRequest
) -> None:
    full, _ = request.getfixturevalue(architecture)
    rows = parity.runtime_differences(full, poses)
    assert [(r["output"], r["runtime"]) for r in rows] == [
        (output, runtime)
        for runtime in ("condyle C++", "onnxruntime Python", "condyle fused")
        for output in ("wrench", "stiffness", "error", "trust")
    ]
    assert all(r["agrees"] for r in rows), rows
    assert all(r["poses"] == len(poses) for r in rows)


@pytest.mark.parametrize("architecture", ["exported", "exported_potential"])
def test_runtimes_agree_on_a_wrench_only_file(
    architecture: str, poses: np.ndarray, request: pytest.FixtureRequest
) -> None:
    _, wrench_only = request.getfixturevalue(architecture)
    rows = parity.runtime_differences(wrench_only, poses)
    assert [r["output"] for r in rows] == ["wrench"] * 3
    assert all(r["agrees"] for r in rows), rows


@pytest.mark.parametrize("fault", [3e-6, np.nan])
def test_a_difference_is_noticed(
    exported: tuple[Path, Path], poses: np.ndarray, fault: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    original = parity._core

    def faulty(path: Path, poses: np.ndarray, runtime: str) -> dict[str, np.ndarray]:
        values = {name: array.copy() for name, array in original(path, poses, runtime).items()}
        if runtime == "fused":
            # A moment: small beside the forces, large for a moment.
            values["wrench"][7, 1, 3] += fault
        return values

    monkeypatch.setattr(parity, "_core", faulty)
    rows = parity.runtime_differences(exported[0], poses)
    assert [r["agrees"] for r in rows] == [True] * 8 + [False] + [True] * 3
    json.dumps(rows, allow_nan=False)


def test_zero_everywhere_must_be_met_exactly() -> None:
    zero = np.zeros((4, 2, 6))
    assert parity._excess(zero, zero) == (0.0, 0.0)
    _, excess = parity._excess(zero + 1e-12, zero)
    assert excess is not None
    assert excess > 1
