# SPDX-License-Identifier: Apache-2.0
"""What an import leaves out, grouped by why, so that nothing is dropped silently."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Findings:
    """Sentences "reason: names", one a reason, in the order in which reasons came up."""

    _names: dict[str, list[str]] = field(default_factory=dict)

    def add(self, reason: str, name: str) -> None:
        """Notes that ``name`` is left out, or changed, for ``reason``."""
        names = self._names.setdefault(reason, [])
        if name not in names:
            names.append(name)

    def sentences(self) -> list[str]:
        """One sentence a reason, with all its names."""
        return [f"{reason}: {', '.join(names)}" for reason, names in self._names.items()]
