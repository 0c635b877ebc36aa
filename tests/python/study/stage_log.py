# SPDX-License-Identifier: Apache-2.0
"""A reporter that remembers."""


class StageLog:
    """Which stages ran, and which were skipped since they were current."""

    def __init__(self) -> None:
        self.ran: list[str] = []
        self.unchanged: list[str] = []

    def stage(self, name: str, text: str) -> None:
        self.ran.append(name)

    def skipped(self, name: str) -> None:
        self.unchanged.append(name)

    def progress(self, task: str, fraction: float, note: str) -> None:
        assert 0.0 <= fraction <= 1.0

    def finished(self, name: str, text: str) -> None:
        assert self.ran[-1] == name
