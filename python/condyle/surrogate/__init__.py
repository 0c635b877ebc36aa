# SPDX-License-Identifier: Apache-2.0
"""Surrogates: contact models that are neural networks in ONNX files.

Use a surrogate where many evaluations are needed (simulations, alignment studies) within the poses
it was trained for, and look at ``trust`` and ``error`` of its loads; use
:class:`condyle.contact.MeshContact` where it is not to be trusted. A file of contract version 1
takes SI in and gives SI out, and any ONNX runtime can evaluate it; this package evaluates it in the
C++ core, through the shared library of the ``onnxruntime`` wheel (or the one named by the
environment variable ``CONDYLE_ONNXRUNTIME``). torch is not needed.
"""

from condyle.surrogate.file import describe, load_surrogate
from condyle.surrogate.library import (
    OnnxContactModel,
    onnxruntime_library,
    onnxruntime_version,
)

__all__ = [
    "OnnxContactModel",
    "describe",
    "load_surrogate",
    "onnxruntime_library",
    "onnxruntime_version",
]
