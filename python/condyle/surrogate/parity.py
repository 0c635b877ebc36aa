# SPDX-License-Identifier: Apache-2.0
"""The same ONNX file in three runtimes: do they give the same numbers?

The C++ core (fused, where it knows the file's graph, and through onnxruntime), onnxruntime's Python
module and ``onnx.reference`` (plain NumPy, the standard's own) evaluate a file at the same poses.
For each output and each of its components (a load, a derivative of a load), with b the values of
``onnx.reference``:

    excess = max |a − b| / (1e-9·|b| + 1e-9·RMS(b over poses and sides));   at most 1 is agreement.
"""

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from condyle.contact import Derivatives
from condyle.surrogate.file import load_surrogate
from condyle.surrogate.library import Runtime

RELATIVE_LIMIT = 1e-9

Array = NDArray[np.float64]


def runtime_differences(path: str | os.PathLike[str], poses: Array) -> list[dict[str, Any]]:
    """Compares the runtimes at some poses.

    Args:
        path: Surrogate file, full or wrench-only.
        poses: (n, 6) [m, rad], n ≥ 1.

    Returns:
        A row for each output and runtime: ``output``, ``runtime``, ``poses``, ``max_difference``
        (in the output's units), ``excess`` as above (None where it is not finite) and ``agrees``.
    """
    poses = np.ascontiguousarray(poses, dtype=np.float64)
    expected = _onnx_reference(path, poses)
    rows = []
    results = {
        "condyle C++": _core(path, poses, "onnxruntime"),
        "onnxruntime Python": _onnxruntime(path, poses),
    }
    if load_surrogate(path).runtime == Runtime.fused:
        results["condyle fused"] = _core(path, poses, "fused")
    for runtime, values in results.items():
        for output, b in expected.items():
            difference, excess = _excess(values[output], b)
            rows.append(
                {
                    "output": output,
                    "runtime": runtime,
                    "poses": len(poses),
                    "max_difference": difference,
                    "excess": excess,
                    "agrees": excess is not None and excess <= 1.0,
                }
            )
    return rows


def _core(path: str | os.PathLike[str], poses: Array, runtime: str) -> dict[str, Array]:
    model = load_surrogate(path, runtime=runtime)
    derivatives = Derivatives.stiffness if model.has_stiffness else Derivatives.none
    loads = model.evaluate(poses, derivatives, 1)
    return {name: getattr(loads, name) for name in ("wrench", "stiffness", "error", "trust")}


def _onnxruntime(path: str | os.PathLike[str], poses: Array) -> dict[str, Array]:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    session = onnxruntime.InferenceSession(
        os.fspath(path), options, providers=["CPUExecutionProvider"]
    )
    names = [output.name for output in session.get_outputs()]
    return dict(zip(names, session.run(names, {"pose": poses}), strict=True))


def _onnx_reference(path: str | os.PathLike[str], poses: Array) -> dict[str, Array]:
    import onnx
    from onnx.reference import ReferenceEvaluator

    evaluator = ReferenceEvaluator(onnx.load(os.fspath(path)))
    names = list(evaluator.output_names)
    return dict(zip(names, evaluator.run(names, {"pose": poses}), strict=True))


def _excess(a: Array, b: Array) -> tuple[float | None, float | None]:
    """Largest |a − b|, and the largest in units of its limit; None where not finite (for JSON)."""
    # Over poses and sides, each component on its own: forces must not lend their scale to moments.
    over = (0, 1) if b.ndim > 1 else (0,)
    rms = np.sqrt(np.mean(b**2, axis=over, keepdims=True))
    limit = RELATIVE_LIMIT * (np.abs(b) + rms)
    difference = np.abs(a - b)
    # A component that is zero throughout has no scale: zero must be met exactly.
    ratio = np.where(
        difference == 0, 0.0, difference / np.where(limit > 0, limit, np.finfo(float).tiny)
    )
    largest, excess = float(difference.max()), float(ratio.max())
    return (largest, excess) if np.isfinite(excess) else (None, None)
