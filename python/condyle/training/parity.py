# SPDX-License-Identifier: Apache-2.0
"""The same numbers everywhere: an exported ONNX file against the networks it came from.

The ONNX file is evaluated by onnxruntime and by ``onnx.reference`` (an independent implementation
in numpy). Difference and limit, for each output and each of its components (a load, or a derivative
of a load):

    |a − b| ≤ 1e-9·|b| + 1e-9·RMS(b over the poses and sides),   b from the networks in torch.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import onnx
import onnxruntime
import torch
from numpy.typing import ArrayLike, NDArray
from onnx.reference import ReferenceEvaluator

from condyle.training.input_data import as_poses
from condyle.training.potential import PotentialSurrogate
from condyle.training.trust import TrustModel
from condyle.training.two_stage import TwoStageSurrogate

TOLERANCE = 1e-9


@dataclass(frozen=True)
class ParityReport:
    """Largest difference of each output in units of its limit, per evaluator; 1 is the limit.

    Attributes:
        n_poses: Poses compared.
        n_on_gate: Poses left out because a predicted Fy is within rounding of the gate, where
            either side of it is right.
        excess: {"onnxruntime": {"wrench": 0.002, ...}, "onnx.reference": {...}}.
    """

    n_poses: int
    n_on_gate: int
    excess: dict[str, dict[str, float]]

    @property
    def agrees(self) -> bool:
        """Whether every difference is within its limit."""
        return all(value <= 1.0 for outputs in self.excess.values() for value in outputs.values())


def check_parity(
    onnx_path: str | os.PathLike[str],
    surrogate: TwoStageSurrogate | PotentialSurrogate,
    poses: ArrayLike,
    trust: TrustModel | None = None,
) -> ParityReport:
    """Compares a file with the surrogate it was exported from.

    Args:
        onnx_path: Full or wrench-only file.
        surrogate: The networks.
        poses: (n, 6) [m, rad].
        trust: Compares ``error`` and ``trust`` too, where the file has them.

    Raises:
        InputDataError: Poses unfit.
    """
    poses = as_poses(poses)
    wrench, stiffness = surrogate.wrench_and_stiffness(poses)
    expected: dict[str, NDArray[np.float64]] = {"wrench": wrench, "stiffness": stiffness}
    if trust is not None:
        expected |= {"error": trust.error(wrench), "trust": trust.trust(poses, wrench)}
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    session = onnxruntime.InferenceSession(
        os.fspath(onnx_path), options, providers=["CPUExecutionProvider"]
    )
    names = [output.name for output in session.get_outputs()]
    model = onnx.load(os.fspath(onnx_path))
    found = {
        "onnxruntime": dict(zip(names, session.run(names, {"pose": poses}), strict=True)),
        "onnx.reference": dict(
            zip(names, ReferenceEvaluator(model).run(names, {"pose": poses}), strict=True)
        ),
    }
    keep = ~_on_gate(surrogate, poses)
    excess = {
        evaluator: {
            name: _excess(np.asarray(outputs[name])[keep], expected[name][keep])
            for name in names
            if name in expected
        }
        for evaluator, outputs in found.items()
    }
    return ParityReport(int(keep.sum()), int((~keep).sum()), excess)


def _excess(values: NDArray[np.float64], expected: NDArray[np.float64]) -> float:
    """Largest |a − b| over its limit; infinite for another shape or type, or for NaN."""
    if values.shape != expected.shape or values.dtype != np.float64:
        return float("inf")
    if not len(values):
        return 0.0
    # Over poses and sides, per component: a load's own RMS, not that of forces and moments
    # together.
    over = (0, 1) if expected.ndim > 1 else (0,)
    rms = np.sqrt((expected**2).mean(axis=over, keepdims=True))
    limit = TOLERANCE * (np.abs(expected) + rms)
    ratio = np.abs(values - expected) / np.where(limit > 0, limit, np.finfo(float).tiny)
    largest = float(ratio.max())
    return largest if np.isfinite(largest) else float("inf")


def _on_gate(
    surrogate: TwoStageSurrogate | PotentialSurrogate, poses: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Poses (n,) where a side is so near its gate that rounding shows.

    Two-stage: some ungated |Fy| is below 1e-9 of its range. Potential: some |N| is below 1e-6 of
    its range; nothing jumps there, but the stiffness goes like N^(p−2), as steep as a root.
    """
    if isinstance(surrogate, PotentialSurrogate):
        with torch.no_grad():
            pose = torch.from_numpy(poses)
            gate = torch.stack([side.network.value(pose) for side in surrogate.sides], 1).numpy()
        nearness = 1e-6
    else:
        gate, nearness = surrogate.ungated_fy(poses), TOLERANCE
    near: NDArray[np.bool_] = (np.abs(gate) < nearness * np.abs(gate).max()).any(axis=1)
    return near
