# SPDX-License-Identifier: Apache-2.0
"""Learning curves as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.markdown import markdown_table, rounded

#: Loads that are shown; the JSON table has all six.
SHOWN: Final = ("Fy", "Mx")
_HEADER: Final = [
    f"{side} {load} [{LOAD_UNITS[LOAD_COLUMNS.index(load)]}]" for load in SHOWN for side in SIDES
]

Row = Mapping[str, Any]


def render_learning_curves(name: str, table: Row, figure: str | None = None) -> str:
    """The text of learning_curves.md.

    Args:
        name: the study's.
        table: ``architecture``, ``test_samples``, ``minutes`` and ``points``; a point has ``samples``, ``seconds``,
            ``epochs``, ``errors`` (rows of sample_error_table) and, the largest one, ``over_time``: ``seconds``,
            ``epochs``, ``losses`` and ``errors`` of its networks on their way.
        figure: path from the file's folder.
    """
    points: Sequence[Row] = table["points"]
    parts = [
        f"# {name}: learning curves\n",
        f"RMSE (maximum error) over the {table['test_samples']} held-out samples, all domains together; architecture "
        f"`{table['architecture']}`. All loads and domains: tables/learning_curves.json.\n",
        "## Against the number of samples\n",
        _against_samples(points),
    ]
    if points[-1]["over_time"]:
        parts += [
            f"## Against training time, {points[-1]['samples']} samples\n",
            _against_time(points[-1], table["minutes"]),
        ]
    if figure is not None:
        parts.append(f"![learning curves]({figure})\n")
    return "\n".join(parts)


def errors_over_all(rows: Iterable[Row]) -> dict[tuple[str, str], Row]:
    """The rows of all domains together by side and load."""
    return {(row["side"], row["load"]): row for row in rows if row["domain"] == "all"}


def _cells(rows: Iterable[Row]) -> list[str]:
    errors = errors_over_all(rows)
    chosen = [errors[side, load] for load in SHOWN for side in SIDES]
    return [f"{rounded(row['rmse'])} ({rounded(row['max_error'])})" for row in chosen]


def _against_samples(points: Sequence[Row]) -> str:
    body = [
        [str(point["samples"]), rounded(point["seconds"] / 60), *_cells(point["errors"])]
        for point in points
    ]
    return markdown_table(["samples", "training [min]", *_HEADER], body)


def _against_time(point: Row, minutes: Sequence[float]) -> str:
    """Errors at the times asked for, then at the end."""
    curve: Sequence[Row] = point["over_time"]
    body = []
    for limit in minutes:
        reached = [row for row in curve if row["seconds"] <= 60 * limit]
        if not reached:
            body.append([f"{limit:g}", "not yet a surrogate", *["–"] * (1 + len(_HEADER))])
        elif reached[-1] is not curve[-1]:
            body.append([f"{limit:g}", *_state(reached[-1])])
    body.append([f"{rounded(curve[-1]['seconds'] / 60)} (end)", *_state(curve[-1])])
    text = (
        "\nNetworks as they were on the way: each net (`potential`: each side) after the same time, so that "
        "a row is what a time budget of that length gives, or a little better.\n"
    )
    return markdown_table(["minutes", "epochs", "losses", *_HEADER], body) + text


def _state(row: Row) -> list[str]:
    epochs = ", ".join(map(str, row["epochs"]))
    return [epochs, ", ".join(f"{loss:.1e}" for loss in row["losses"]), *_cells(row["errors"])]
