# SPDX-License-Identifier: Apache-2.0
"""Files that are there whole or not at all, and the text and hashes that go into them.

A file is written beside its place under a temporary name, flushed to the disk and renamed: whoever
is killed, or runs out of disk, leaves either the old state or the new one.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from pathlib import Path
from typing import Any, Final

from condyle.errors import InputDataError

_TEMPORARY_SUFFIX: Final = ".tmp"


def write_whole(path: Path, content: bytes | str) -> None:
    """Put ``content`` at ``path``, text as UTF-8, making its folder where needed.

    Raises:
        InputDataError: The disk is full, the folder cannot be written, …; names the file and the
            reason. Nothing that was there is lost.
    """
    temporary = path.with_name(path.name + _TEMPORARY_SUFFIX)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with open(temporary, "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise InputDataError(
            f"{path} cannot be written: {error.strerror or error}; "
            "finished files are kept, run again to go on"
        ) from error


def remove_leftovers(directory: Path) -> None:
    """Remove what a killed process left under temporary names, anywhere below ``directory``."""
    for leftover in sorted(directory.rglob("*" + _TEMPORARY_SUFFIX)):
        leftover.unlink(missing_ok=True)


def to_canonical_json(value: Any) -> str:
    """One text for one value: sorted keys, shortest exact numbers, no NaN."""
    return json.dumps(value, sort_keys=True, ensure_ascii=False, allow_nan=False, indent=1)


def content_hash(content: bytes) -> str:
    """SHA-256, hexadecimal."""
    return hashlib.sha256(content).hexdigest()
