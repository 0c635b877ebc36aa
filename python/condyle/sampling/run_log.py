# SPDX-License-Identifier: Apache-2.0
"""run.log: the one file of a dataset with a clock in it, and the lock on its directory."""

from __future__ import annotations

import contextlib
import fcntl
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Self

from condyle.errors import InputDataError


class RunLog:
    """An append-only log that one process at a time can hold; its end, however, releases it.

    Args:
        directory: The dataset's; made where needed.

    Raises:
        InputDataError: The directory cannot be written, or another process is sampling into it.
    """

    def __init__(self, directory: Path) -> None:
        try:
            directory.mkdir(parents=True, exist_ok=True)
            # Unbuffered: nothing is left to be written when it closes, which a full disk would refuse.
            self._file = open(directory / "run.log", "ab", buffering=0)  # noqa: SIM115
        except OSError as error:
            raise InputDataError(
                f"{directory} cannot be written: {error.strerror or error}"
            ) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._file.close()
            raise InputDataError(
                f"{directory}: another process is sampling into it; wait for it to end"
            ) from error

    def write(self, message: str) -> None:
        """One line, with the time; what the disk does not take is lost, for no sample depends on it."""
        line = f"{datetime.now(UTC).isoformat(timespec='milliseconds')} {message}\n"
        with contextlib.suppress(OSError):
            self._file.write(line.encode())

    def __enter__(self) -> Self:
        """The log itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Log how the run ended, and release the directory."""
        if error is not None:
            self.write(f"stopped by {type(error).__name__}: {error}")
        self._file.close()
