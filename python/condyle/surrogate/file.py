# SPDX-License-Identifier: Apache-2.0
"""Surrogate files: reading them, and what they say of themselves."""

import json
import os
from pathlib import Path
from typing import Any

from condyle.errors import CondyleError, InputDataError
from condyle.surrogate.library import OnnxContactModel, runtime_from_name

_PREFIX = "condyle."


def load_surrogate(path: str | os.PathLike[str], *, runtime: str = "auto") -> OnnxContactModel:
    """Opens a surrogate file as a contact model.

    Its ``evaluate(poses, derivatives, threads)`` takes poses (n, 6) [m, rad] and gives ``wrench``
    (n, 2, 6), ``stiffness`` (n, 2, 6, 6) if asked for, ``error`` (n, 2, 6) and ``trust`` (n,). The
    result is the same bytes for any number of threads.

    Args:
        path: A file of contract version 1, full or wrench-only.
        runtime: ``fused``: the core's own kernels, refused where they do not know the file's graph;
            ``onnxruntime``; or ``auto``: the first of the two that can. ``model.runtime`` says
            which it is, ``model.fused_refusal`` why it is not the first.

    Raises:
        InputDataError: The file is missing, damaged or breaks the contract; the message names file
            and field.
        CondyleError: onnxruntime is needed and there is no usable library.
    """
    try:
        return OnnxContactModel(Path(path), runtime_from_name(runtime))
    except ValueError as error:
        raise InputDataError(str(error)) from error
    except RuntimeError as error:
        raise CondyleError(str(error)) from error


def describe(path: str | os.PathLike[str]) -> dict[str, Any]:
    """What a surrogate file says of itself.

    Args:
        path: As for :func:`load_surrogate`, which has to accept it.

    Returns:
        ``file`` and ``outputs``, then the metadata by key without its ``condyle.`` prefix, contract
        version first; JSON texts are parsed. ``runtime`` is what evaluates the file here, and why
        it is not the fused path, if it is not.

    Raises:
        InputDataError: As :func:`load_surrogate`.
        CondyleError: As :func:`load_surrogate`.
    """
    model = load_surrogate(path)
    outputs = ["wrench", "stiffness", "error", "trust"] if model.has_stiffness else ["wrench"]
    metadata = {key.removeprefix(_PREFIX): _parsed(text) for key, text in model.metadata.items()}
    first = {key: metadata.pop(key) for key in ("contract_version", "side_of_body", "architecture")}
    runtime = model.runtime.name
    if model.fused_refusal:
        runtime += f" (not fused: {model.fused_refusal})"
    return {
        "file": os.fspath(path),
        "outputs": outputs,
        **first,
        "runtime": runtime,
        **dict(sorted(metadata.items())),
    }


def _parsed(text: str) -> Any:
    """JSON objects and arrays as such; any other text, a number included, as it stands."""
    if not text.startswith(("{", "[")):
        return text
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text
