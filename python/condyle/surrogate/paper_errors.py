# SPDX-License-Identifier: Apache-2.0
"""Errors over held-out samples beside those that the paper printed for its surrogate (its Table 2).

The printed figures are of the paper's implant, contact law and samples: on any other they are a
yardstick, not a comparison of like with like.

Source: Marra et al. (2017), "Evaluation of a surrogate contact model in force-dependent kinematic
simulations of total knee replacement", J. Biomech. Eng. 139(8), doi:10.1115/1.4036605, Table 2.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.markdown import markdown_table, rounded

#: Domain and side: (RMSE, largest error) of Fx, Fy, Fz [N], Mx, My, Mz [Nm], as printed.
PAPER_ERRORS: Final[Mapping[tuple[str, str], tuple[tuple[float, float], ...]]] = {
    ("2", "medial"): ((3.8, 58), (18, 462), (3.2, 32), (0.44, 9.7), (0.09, 1.4), (0.21, 6.5)),
    ("2", "lateral"): ((12, 379), (69, 1863), (9.3, 315), (1.8, 50), (0.32, 11), (1.1, 41)),
    ("3", "medial"): ((3.9, 32), (20, 113), (6.8, 81), (0.46, 2.9), (0.14, 1.5), (0.21, 1.7)),
    ("3", "lateral"): ((5.2, 48), (29, 191), (8.0, 126), (0.71, 5.3), (0.19, 2.3), (0.40, 6.7)),
    ("4", "medial"): ((2.1, 23), (9.9, 108), (3.9, 41), (0.26, 2.3), (0.07, 0.58), (0.12, 2.3)),
    ("4", "lateral"): ((2.3, 14), (13, 77), (3.3, 49), (0.35, 2.3), (0.07, 0.51), (0.14, 1.1)),
    ("5", "medial"): ((0.13, 3.2), (1.0, 16), (0.44, 8.0), (0.03, 0.57), (0.01, 0.11), (0.01, 0.16)),
    ("5", "lateral"): (
        (0.15, 5.3), (1.4, 25), (0.20, 5.4), (0.04, 0.42), (0.00, 0.21), (0.01, 0.15),
    ),
    ("6", "medial"): ((8.4, 140), (17, 273), (3.2, 41), (0.72, 12), (0.13, 2.0), (0.02, 0.3)),
    ("6", "lateral"): ((44, 602), (76, 1192), (51, 727), (1.9, 28), (1.8, 21), (0.77, 11)),
}  # fmt: skip
#: What a printed 0.00 stands for: the value was below half of the last digit.
_PRINTED_ZERO: Final = 0.005
#: Figures above the paper's that are named one by one; of more, their being bold says enough.
_MOST_NAMED: Final = 12

Rows = Sequence[Mapping[str, Any]]


def paper_comparison(rows: Rows) -> list[dict[str, Any]]:
    """Each error that the paper printed too, beside it.

    Args:
        rows: Of :func:`condyle.evaluation.sample_error_table`, or of a model card.

    Returns:
        Rows with ``domain``, ``side``, ``load``, ``measure`` (rmse or max_error), ``value``,
        ``paper`` (as printed) and ``above``: above the printed figure, or not below 0.005 where
        0.00 was printed.
    """
    found = []
    for row in rows:
        printed = PAPER_ERRORS.get((row["domain"], row["side"]))
        if printed is None:
            continue
        pair = printed[LOAD_COLUMNS.index(row["load"])]
        for measure, paper in zip(("rmse", "max_error"), pair, strict=True):
            value = row[measure]
            above = value > paper if paper > 0 else value >= _PRINTED_ZERO
            cell = {key: row[key] for key in ("domain", "side", "load")}
            found.append(
                cell | {"measure": measure, "value": value, "paper": paper, "above": above}
            )
    return found


def errors_markdown(rows: Rows) -> str:
    """The errors as Markdown: RMSE (largest error) by domain and side beside the paper's; then R².

    Figures above the paper's are bold. R² is over loaded samples (the side carries Fy > 0).
    """
    comparison = paper_comparison(rows)
    above = {(c["domain"], c["side"], c["load"], c["measure"]) for c in comparison if c["above"]}
    by_key = {(r["domain"], r["side"], r["load"]): r for r in rows}
    body = []
    for domain, side in dict.fromkeys((r["domain"], r["side"]) for r in rows):
        cells = [by_key[domain, side, load] for load in LOAD_COLUMNS]
        body.append([domain, side, "here", *(_cell(c, above) for c in cells)])
        printed = PAPER_ERRORS.get((domain, side))
        if printed is not None:
            figures = [f"{rmse:g} ({largest:g})" for rmse, largest in printed]
            body.append(["", "", "paper", *figures])
    text = markdown_table(["domain", "side", "", *LOAD_COLUMNS], body)
    if comparison:
        count = above_the_paper(comparison, "domain", "side", "load")
        text += f"\n{count}. The paper's are of its own implant, contact law and samples (its Table 2).\n"
    return text + "\nR² over loaded samples (the side carries Fy > 0):\n\n" + _r2_table(by_key)


def _cell(row: Mapping[str, Any], above: Iterable[tuple[str, ...]]) -> str:
    key = (row["domain"], row["side"], row["load"])
    shown = [
        f"**{rounded(row[measure])}**" if (*key, measure) in above else rounded(row[measure])
        for measure in ("rmse", "max_error")
    ]
    return f"{shown[0]} ({shown[1]})"


def above_the_paper(comparison: Rows, *keys: str) -> str:
    """How many figures are above the paper's, and which if they are few; no full stop.

    Args:
        comparison: rows with ``above``, ``measure`` (rmse or max_error) and what names them.
        keys: what names them, in this order; ``domain`` stands before its number.
    """
    worse = [c for c in comparison if c["above"]]
    text = f"{len(worse)} of {len(comparison)} figures are above the paper's"
    if len(worse) > _MOST_NAMED:
        text += " (bold)"
    elif worse:
        names = {"rmse": "RMSE", "max_error": "maximum"}
        shown = [
            " ".join(
                [*(f"domain {c[k]}" if k == "domain" else c[k] for k in keys), names[c["measure"]]]
            )
            for c in worse
        ]
        text += " (bold): " + ", ".join(shown)
    return text


def _r2_table(by_key: Mapping[tuple[str, str, str], Mapping[str, Any]]) -> str:
    domains = dict.fromkeys(domain for domain, _, _ in by_key)
    body = []
    for domain in domains:
        for side in SIDES:
            values = [by_key[domain, side, load]["loaded_r2"] for load in LOAD_COLUMNS]
            if any(value is not None for value in values):
                shown = ["–" if value is None else f"{value:.5f}" for value in values]
                body.append([domain, side, *shown])
    return markdown_table(["domain", "side", *LOAD_COLUMNS], body)
