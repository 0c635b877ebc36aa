# SPDX-License-Identifier: Apache-2.0
"""How stages tell what they are doing, without knowing a screen."""

from typing import Protocol


class Reporter(Protocol):
    """Told of stages and of progress within them."""

    def stage(self, name: str, text: str) -> None:
        """A stage begins."""
        ...

    def skipped(self, name: str) -> None:
        """A stage is current and was skipped."""
        ...

    def progress(self, task: str, fraction: float, note: str) -> None:
        """A task within the stage has come to ``fraction`` (0 to 1) of its way."""
        ...

    def finished(self, name: str, text: str) -> None:
        """A stage has ended, with its result in a sentence."""
        ...


class SilentReporter:
    """Says nothing."""

    def stage(self, name: str, text: str) -> None:
        """Ignored."""

    def skipped(self, name: str) -> None:
        """Ignored."""

    def progress(self, task: str, fraction: float, note: str) -> None:
        """Ignored."""

    def finished(self, name: str, text: str) -> None:
        """Ignored."""
