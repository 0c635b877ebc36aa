# SPDX-License-Identifier: Apache-2.0
"""Files of plain values and tensors, written whole or not at all, read without running code."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import torch

from condyle.errors import InputDataError
from condyle.whole_files import write_whole


def write_atomically(path: str | os.PathLike[str], values: dict[str, Any]) -> None:
    """Saves ``values`` with torch so that a kill leaves either the old file or the new one."""
    stream = io.BytesIO()
    torch.save(values, stream)
    write_whole(Path(path), stream.getvalue())


def read_torch_file(path: str | os.PathLike[str], expected_format: str) -> dict[str, Any]:
    """Plain values and tensors from a torch file; nothing in it is executed.

    Raises:
        InputDataError: Missing, damaged, or of another format; the file is named.
    """
    try:
        values = torch.load(path, map_location="cpu", weights_only=True)
    except FileNotFoundError as error:
        raise InputDataError(f"{path}: no such file") from error
    except Exception as error:  # torch raises many types for a damaged file
        raise InputDataError(
            f"{path}: not a readable torch file ({type(error).__name__})"
        ) from error
    found = values.get("format") if isinstance(values, dict) else None
    if found != expected_format:
        raise InputDataError(f"{path}: format is {found!r}; it must be {expected_format!r}")
    result: dict[str, Any] = values
    return result
