# SPDX-License-Identifier: Apache-2.0
"""Errors of simulated activities in the form of the paper's Tables 3 and 4, its printed figures beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, SIDES
from condyle.evaluation.paper_activities import (
    PAPER_KINEMATICS_COLUMNS,
    activity_comparison,
    paper_activity,
    printed_error,
)
from condyle.markdown import markdown_table, rounded
from condyle.surrogate.paper_errors import above_the_paper

Rows = Sequence[Mapping[str, Any]]
#: (activity, contact, quantity)
_Key = tuple[str, str, str]
_KINEMATICS_UNITS: Final = ("mm", "mm", "mm", "deg", "deg", "deg")
#: What the paper's text says of R².
_LOADS_R2: Final = "The paper's: above 0.99 on the medial side and above 0.98 on the lateral side."
_KINEMATICS_R2: Final = (
    "The paper's: above 0.96, but 0.93 of lateral tibial translation in normal gait."
)
_ILLEGIBLE: Final = (
    "The largest error of lateral My in the paper's normal gait is left out: the text at hand reads 80.0 Nm, "
    "where no moment is above 1.4 Nm."
)


@dataclass(frozen=True)
class _Line:
    """What one line of a table shows: the first cells, and the quantities of the others."""

    labels: tuple[str, ...]
    quantities: tuple[str, ...]


@dataclass(frozen=True)
class _Form:
    """A table's columns, and its lines for every activity."""

    number: int
    header: tuple[str, ...]
    columns: tuple[str, ...]
    lines: tuple[_Line, ...]
    r2: str

    @property
    def quantities(self) -> set[str]:
        return {quantity for line in self.lines for quantity in line.quantities}


_LOADS: Final = _Form(
    3,
    ("side",),
    tuple(f"{load} [{unit}]" for load, unit in zip(LOAD_COLUMNS, LOAD_UNITS, strict=True)),
    tuple(_Line((side,), tuple(f"{side}_{load}" for load in LOAD_COLUMNS)) for side in SIDES),
    _LOADS_R2,
)
_KINEMATICS: Final = _Form(
    4,
    (),
    tuple(
        f"{name.replace('_', ' ')} [{unit}]"
        for name, unit in zip(PAPER_KINEMATICS_COLUMNS, _KINEMATICS_UNITS, strict=True)
    ),
    (_Line((), PAPER_KINEMATICS_COLUMNS),),
    _KINEMATICS_R2,
)


def loads_markdown(rows: Rows) -> str:
    """Table 3: RMSE (largest error) of the loads by activity and side, the paper's below, then R².

    Figures above the paper's are bold. Quantities that are no load of a side follow in a table of their own.

    Args:
        rows: of :func:`condyle.evaluation.simulation_load_error_table`, with ``contact`` (``surrogate`` where missing)
            and ``excluded``, the number of time frames left out (0 where missing).
    """
    return _errors_markdown(rows, _LOADS)


def kinematics_markdown(rows: Rows) -> str:
    """Table 4: RMSE (largest error) of the clinical kinematics by activity, the paper's below, then R².

    Args:
        rows: of :func:`condyle.evaluation.kinematics_error_table`; else as :func:`loads_markdown`.
    """
    return _errors_markdown(rows, _KINEMATICS)


def _errors_markdown(rows: Rows, form: _Form) -> str:
    shaped = [row for row in rows if row["quantity"] in form.quantities]
    others = [row for row in rows if row["quantity"] not in form.quantities]
    parts = []
    if shaped:
        by_key = {(r["activity"], _contact(r), r["quantity"]): r for r in shaped}
        comparison = activity_comparison(shaped)
        parts.append("RMSE (maximum):\n\n" + _table(by_key, form, comparison))
        parts.append(_verdict(comparison, form))
        if any(_illegible(row) for row in shaped):
            parts.append(_ILLEGIBLE + "\n")
    parts += _excluded(rows)
    if shaped:
        parts.append("R²:\n\n" + _r2_table(by_key, form) + f"\n{form.r2}\n")
    if others:
        parts.append(_flat_table(others))
    return "\n".join(parts)


def _contact(row: Mapping[str, Any]) -> str:
    return str(row.get("contact", "surrogate"))


def _contacts(by_key: Mapping[_Key, Mapping[str, Any]]) -> dict[str, list[str]]:
    """The contact models of every activity, both in their order of appearance."""
    found: dict[str, list[str]] = {}
    for activity, contact, _ in by_key:
        known = found.setdefault(activity, [])
        if contact not in known:
            known.append(contact)
    return found


def _table(by_key: Mapping[_Key, Mapping[str, Any]], form: _Form, comparison: Rows) -> str:
    above = {_place(c) for c in comparison if c["above"]}
    body = []
    for activity, contacts in _contacts(by_key).items():
        kind = paper_activity(activity)
        for line in form.lines:
            for contact in contacts:
                cells = [
                    _cell((activity, contact, quantity), by_key, above)
                    for quantity in line.quantities
                ]
                body.append([activity, *line.labels, contact, *cells])
            printed = [_printed(kind, quantity) for quantity in line.quantities]
            if kind is not None:
                blanks = [""] * (1 + len(line.labels))
                body.append([*blanks, f"paper, {kind}", *printed])
    return markdown_table(["activity", *form.header, "contact", *form.columns], body)


def _place(figure: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(figure[key] for key in ("activity", "contact", "quantity", "measure"))


def _cell(key: _Key, by_key: Mapping[_Key, Mapping[str, Any]], above: set[tuple[str, ...]]) -> str:
    row = by_key.get(key)
    # Without a time frame there is no error, whatever its statistics say.
    if row is None or row["count"] == 0:
        return "–"
    rmse, largest = (
        f"**{rounded(row[measure])}**" if (*key, measure) in above else rounded(row[measure])
        for measure in ("rmse", "max_error")
    )
    return f"{rmse} ({largest})"


def _printed(kind: str | None, quantity: str) -> str:
    printed = printed_error(kind, quantity)
    if printed is None:
        return "–"
    # A printed 0.00 is no plain 0: the value was below half of the last digit.
    rmse, largest = ("–" if v is None else f"{v:g}" if v > 0 else "0.00" for v in printed)
    return f"{rmse} ({largest})"


def _illegible(row: Mapping[str, Any]) -> bool:
    printed = printed_error(paper_activity(row["activity"]), row["quantity"])
    return printed is not None and printed[1] is None


def _verdict(comparison: Rows, form: _Form) -> str:
    if not comparison:
        return f"No activity here is of a kind that the paper's Table {form.number} has.\n"
    text = above_the_paper(comparison, "activity", "contact", "quantity")
    return (
        f"{text}. The paper's (its Table {form.number}) are of another implant, subject and activity: an activity here "
        "stands beside one of the paper's of the same kind, by its name. A printed 0.00 is below 0.005.\n"
    )


def _excluded(rows: Rows) -> list[str]:
    """A sentence on the time frames left out, or nothing."""
    left_out: dict[tuple[str, str], tuple[int, int]] = {}
    for row in rows:
        if row.get("excluded"):
            left_out[row["activity"], _contact(row)] = row["excluded"], row["count"]
    if not left_out:
        return []
    shown = [
        f"{excluded} of {excluded + count} in {activity} ({contact})"
        for (activity, contact), (excluded, count) in left_out.items()
    ]
    return [f"**Time frames left out of these errors**: {', '.join(shown)}.\n"]


def _r2_table(by_key: Mapping[_Key, Mapping[str, Any]], form: _Form) -> str:
    body = []
    for activity, contacts in _contacts(by_key).items():
        for line in form.lines:
            for contact in contacts:
                rows = [by_key.get((activity, contact, q), {}) for q in line.quantities]
                shown = [_r2(row.get("r2"), 5) for row in rows]
                body.append([activity, *line.labels, contact, *shown])
    columns = [column.split(" [")[0] for column in form.columns]
    return markdown_table(["activity", *form.header, "contact", *columns], body)


def _r2(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


def _flat_table(rows: Rows) -> str:
    """A line for every quantity."""
    body = []
    for row in rows:
        errors = [rounded(row[m]) if row["count"] else "–" for m in ("rmse", "max_error")]
        what = [row["activity"], _contact(row), row["quantity"], row["unit"]]
        body.append([*what, *errors, _r2(row["r2"], 4)])
    header = ["activity", "contact", "quantity", "unit", "RMSE", "maximum", "R²"]
    return markdown_table(header, body)
