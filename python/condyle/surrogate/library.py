# SPDX-License-Identifier: Apache-2.0
"""The C++ surrogate, told where the onnxruntime wheel keeps its shared library.

The wheel's Python module is never imported for this: finding it costs nothing, importing it some
100 ms.
"""

import importlib.util
import re
from pathlib import Path

from condyle._core.surrogate import (
    HybridContactModel,
    OnnxContactModel,
    Runtime,
    onnxruntime_library,
    onnxruntime_version,
    runtime_from_name,
    set_library_path,
)

__all__ = [
    "HybridContactModel",
    "OnnxContactModel",
    "Runtime",
    "onnxruntime_library",
    "onnxruntime_version",
    "runtime_from_name",
    "wheel_library",
]


def wheel_library() -> Path | None:
    """The shared library inside the ``onnxruntime`` wheel, or None where there is none."""
    spec = importlib.util.find_spec("onnxruntime")
    if spec is None or spec.origin is None:
        return None
    files = (Path(spec.origin).parent / "capi").glob("libonnxruntime.so.*")
    return max(files, key=_version, default=None)


def _version(file: Path) -> list[int]:
    """Numbers of a version, so that 1.31 is above 1.9."""
    return [int(number) for number in re.findall(r"\d+", file.name)]


if (_found := wheel_library()) is not None:
    set_library_path(_found)
