# SPDX-License-Identifier: Apache-2.0
"""Time frames that are not in equilibrium, said aloud."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

#: Told one by one; of more, how many.
_MOST_TOLD: Final = 10


def failures_markdown(rows: Sequence[Mapping[str, Any]]) -> str:
    """How many time frames of what are not in equilibrium, and the first ten with their coordinate and message.

    Args:
        rows: One a time frame: ``activity``, ``contact``, ``time_s``, ``status``, ``worst_coordinate``, ``message``.
            Empty text for none.
    """
    if not rows:
        return ""
    count = len(rows)
    by_run = Counter((row["activity"], row["contact"]) for row in rows)
    runs = ", ".join(f"{n} of {activity} ({contact})" for (activity, contact), n in by_run.items())
    subject = "1 time frame is" if count == 1 else f"{count} time frames are"
    lines = [
        f"## NOT in equilibrium: {count} time frame{'' if count == 1 else 's'}\n",
        f"**{subject} not in equilibrium: {runs}. What is reported of such a time frame is no solution.**\n",
        *(_told(row) for row in rows[:_MOST_TOLD]),
    ]
    if count > _MOST_TOLD:
        lines.append(f"\nThese are the first {_MOST_TOLD} of {count}; tables.json has all.")
    return "\n".join(lines) + "\n"


def _told(row: Mapping[str, Any]) -> str:
    # A message of several lines would end the list.
    message = " ".join(str(row["message"]).split())
    worst = f", worst in {row['worst_coordinate']}" if row["worst_coordinate"] else ""
    return f"- {row['activity']} ({row['contact']}), {row['time_s']:.4g} s: {row['status']}{worst}: {message}"
