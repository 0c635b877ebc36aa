# SPDX-License-Identifier: Apache-2.0
"""Simulation times of activities in the form of the paper's Table 5, and where the time went."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from condyle.evaluation.paper_activities import PAPER_TIMES, PaperTimes, paper_activity
from condyle.markdown import markdown_table, rounded

Rows = Sequence[Mapping[str, Any]]


def times_markdown(rows: Rows) -> str:
    """Table 5: time frames, duration, simulation times, speed improvement, times faster than real time.

    The two last are bold where they are below the paper's.

    Args:
        rows: With ``reference_s`` and ``surrogate_s`` [s] and, where known, ``activity`` (its name), ``contact``
            (``surrogate`` where missing), ``time_frames``, ``duration_s`` (of the activity), ``evaluations``,
            ``reference_evaluations``, ``untrusted_time_frames``. Rows without ``activity`` show their ``what`` in a
            table of wall times alone.
    """
    named = [row for row in rows if row.get("activity") is not None]
    others = [row for row in rows if row.get("activity") is None]
    parts = []
    if named:
        parts.append(_activities(named))
    if others:
        parts.append(_wall_times(others))
    return "\n".join(parts)


def phases_markdown(rows: Rows) -> str:
    """Time by phase: µs a time frame, and the share of all phases; the reference once an activity, then each contact.

    Args:
        rows: As :func:`times_markdown`; those with ``phases_s`` or ``reference_phases_s``, phase to seconds. Empty text
            if no row has any.
    """
    records = list(_phase_records(rows))
    phases = list(dict.fromkeys(phase for _, _, _, seconds in records for phase in seconds))
    if not phases:
        return ""
    body = []
    for activity, contact, time_frames, seconds in records:
        total = sum(seconds.values())
        cells = [_phase(seconds.get(phase), total, time_frames) for phase in phases]
        body.append([activity, contact, *cells, _microseconds(total, time_frames)])
    header = ["activity", "contact", *(phase.replace("_", " ") for phase in phases), "all"]
    return "µs a time frame (share):\n\n" + markdown_table(header, body)


def _activities(rows: Rows) -> str:
    body = []
    below = compared = 0
    for activity in dict.fromkeys(row["activity"] for row in rows):
        kind = paper_activity(activity)
        paper = None if kind is None else PAPER_TIMES[kind]
        for row in (row for row in rows if row["activity"] == activity):
            shown = []
            for value, printed in zip(_ratios(row), _paper_ratios(paper), strict=True):
                known = value is not None and printed is not None
                worse = value is not None and printed is not None and value < printed
                compared, below = compared + known, below + worse
                shown.append(f"**{rounded(value)}**" if worse else rounded(value))
            body.append(_activity_line(row, shown))
        if paper is not None:
            body.append(_paper_line(f"paper, {kind}", paper))
    header = ["activity", "contact", "time frames", "duration [s]", "reference [s]", "with it [s]"]
    header += ["speed improvement", "times faster than real time: reference", "with it"]
    header += ["contact evaluations (by the reference)", "untrusted time frames"]
    text = markdown_table(header, body)
    if compared:
        text += (
            f"\n{below} of {compared} ratios are below the paper's{' (bold)' if below else ''}. The paper's times (its "
            "Table 5) are of another implant, subject, activity and machine; how many times faster than real time they "
            "are is computed here from what it printed.\n"
        )
    return text


def _ratios(row: Mapping[str, Any]) -> tuple[float | None, ...]:
    """Speed improvement, and times faster than real time: with the reference, with the contact model."""
    reference, seconds, duration = row["reference_s"], row["surrogate_s"], row.get("duration_s")
    if duration is None:
        return reference / seconds, None, None
    return reference / seconds, duration / reference, duration / seconds


def _paper_ratios(paper: PaperTimes | None) -> tuple[float | None, ...]:
    """The same of the paper."""
    if paper is None:
        return None, None, None
    return paper.speed_improvement, paper.reference_real_time, paper.surrogate_real_time


def _activity_line(row: Mapping[str, Any], ratios: list[str]) -> list[str]:
    calls = str(row.get("evaluations", "–"))
    if row.get("reference_evaluations"):
        calls += f" ({row['reference_evaluations']})"
    return [
        row["activity"],
        row.get("contact", "surrogate"),
        str(row.get("time_frames", "–")),
        rounded(row.get("duration_s")),
        rounded(row["reference_s"]),
        rounded(row["surrogate_s"]),
        *ratios,
        calls,
        str(row.get("untrusted_time_frames", "–")),
    ]


def _paper_line(label: str, paper: PaperTimes) -> list[str]:
    minutes = (_minutes(paper.reference_min), _minutes(paper.surrogate_min))
    ratios = (rounded(value) for value in _paper_ratios(paper))
    return [
        "",
        label,
        str(paper.time_frames),
        rounded(paper.duration_s),
        *minutes,
        *ratios,
        "–",
        "–",
    ]


def _minutes(minutes: float) -> str:
    return f"{rounded(60.0 * minutes)} ({minutes:g} min)"


def _wall_times(rows: Rows) -> str:
    body = [
        [
            row["what"],
            row.get("contact", "surrogate"),
            rounded(row["reference_s"]),
            rounded(row["surrogate_s"]),
            rounded(row["reference_s"] / row["surrogate_s"]),
            str(row.get("evaluations", "–")),
            str(row.get("reference_evaluations", "–")),
        ]
        for row in rows
    ]
    header = ["what", "contact", "reference [s]", "with it [s]", "ratio"]
    header += ["contact evaluations", "of them by the reference"]
    return markdown_table(header, body)


def _phase_records(rows: Rows) -> Iterator[tuple[str, str, int | None, Mapping[str, float]]]:
    """(activity, contact, time frames, seconds by phase); the reference ahead of an activity's others, once."""
    known: set[str] = set()
    for row in rows:
        activity = row.get("activity") or row["what"]
        frames = row.get("time_frames")
        if row.get("reference_phases_s") and activity not in known:
            known.add(activity)
            yield activity, "reference", frames, row["reference_phases_s"]
        if row.get("phases_s"):
            yield activity, row.get("contact", "surrogate"), frames, row["phases_s"]


def _phase(seconds: float | None, total: float, time_frames: int | None) -> str:
    if seconds is None:
        return "–"
    share = f"{seconds / total:.0%}" if total > 0.0 else "–"
    return f"{_microseconds(seconds, time_frames)} ({share})"


def _microseconds(seconds: float, time_frames: int | None) -> str:
    return rounded(1e6 * seconds / time_frames if time_frames else None)
