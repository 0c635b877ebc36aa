# SPDX-License-Identifier: Apache-2.0
"""Surrogates: contact models that are neural networks in ONNX files.

Use a surrogate where many evaluations are needed (simulations, alignment studies) within the poses
it was trained for, and look at ``trust`` and ``error`` of its loads; use
:class:`condyle.contact.MeshContact` where it is not to be trusted. A file of contract version 1
takes SI in and gives SI out, and any ONNX runtime can evaluate it. This package evaluates it in the
C++ core: by kernels of its own where they know the file's graph (runtime ``fused``), else through
the shared library of the ``onnxruntime`` wheel (or the one named by the environment variable
``CONDYLE_ONNXRUNTIME``). torch is not needed. :class:`HybridContactModel` takes the reference where
the surrogate says that it is not to be trusted, blends the two where it is nearly so, and counts how
often. :func:`model_card` says what a file is of and how good it is.
"""

from condyle.surrogate.card import card_markdown, model_card, write_model_card
from condyle.surrogate.file import describe, load_surrogate
from condyle.surrogate.library import (
    HybridContactModel,
    OnnxContactModel,
    Runtime,
    onnxruntime_library,
    onnxruntime_version,
)

__all__ = [
    "HybridContactModel",
    "OnnxContactModel",
    "Runtime",
    "card_markdown",
    "describe",
    "load_surrogate",
    "model_card",
    "onnxruntime_library",
    "onnxruntime_version",
    "write_model_card",
]
