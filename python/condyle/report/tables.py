# SPDX-License-Identifier: Apache-2.0
"""Result tables as Markdown; the same rows as tables.json."""

from collections.abc import Sequence
from typing import Any

from condyle.conventions import LOAD_COLUMNS, SIDES

Rows = list[dict[str, Any]]
_SPLITS = ("train", "test")


def _markdown(header: list[str], rows: list[list[str]]) -> str:
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def _number(value: float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def _fast_error(error: dict[str, Any]) -> str:
    title = "## Reference contact: `fast` against `exact`\n\n"
    if error["total"] is None:
        return title + f"Error {error['status']}.\n"
    text = (
        f"{error['poses']} plausible poses; field of {1e3 * error['spacing']:.2f} mm. Tolerance: 0.2 % + 0.5 N, "
        "0.2 % + 0.02 Nm; 99th percentiles, of both sides together:\n\n"
    )
    ranges = [
        (f"{r['from_force']:.0f}–{r['to_force']:.0f} N", r["total"]) for r in error["by_load"]
    ]
    body = [
        [
            name,
            str(e["count"]),
            f"{e['force_p99']:.2%}",
            f"{e['moment_p99']:.2%}",
            f"{e['force_of_tolerance_p99']:.2f}",
            f"{e['moment_of_tolerance_p99']:.2f}",
        ]
        for name, e in [*ranges, ("all", error["total"])]
    ]
    header = ["total force", "poses", "force", "moment", "force / tolerance", "moment / tolerance"]
    return title + text + _markdown(header, body)


def _samples(report: dict[str, Any]) -> str:
    header = [
        "domain",
        "train",
        "test",
        "paper's train",
        "paper's test",
        "candidates",
        "accepted",
        "rejected",
        "on both sides",
        "evaluations per accepted sample",
    ]
    rows = [
        [
            f"{row['domain']} {row['name']}",
            str(row["train"]),
            str(row["test"]),
            str(row["paper_train"]),
            str(row["paper_test"]),
            str(row["candidates"]),
            f"{row['accepted']} ({100.0 * row['acceptance']:.1f} %)",
            ", ".join(f"{n} {reason}" for reason, n in row["rejected"].items()) or "–",
            f"{100.0 * row['two_sided'] / row['accepted']:.1f} %",
            f"{row['evaluations_per_accepted']:.1f}",
        ]
        for row in report["domains"]
    ]
    paper = [str(sum(row[f"paper_{split}"] for row in report["domains"])) for split in _SPLITS]
    rows.append(["sum", str(report["train"]), str(report["test"]), *paper, *5 * [""]])
    text = (
        "\nThe paper's are those of its Table 1, summed here over the same domains. Over all six they are 154 310; the "
        "totals that it prints are 90 fewer.\n"
    )
    return "## Samples\n\n" + _markdown(header, rows) + text


def _sample_errors(rows: Rows) -> str:
    text = "## Held-out samples: RMSE (maximum error), N and Nm\n\n"
    domains = list(dict.fromkeys(row["domain"] for row in rows))
    by_key = {(r["domain"], r["side"], r["load"]): r for r in rows}
    body = []
    for domain in domains:
        for side in SIDES:
            cells = [by_key[domain, side, load] for load in LOAD_COLUMNS]
            body.append(
                [
                    domain,
                    side,
                    *(f"{_number(c['rmse'])} ({_number(c['max_error'])})" for c in cells),
                ]
            )
    text += _markdown(["domain", "side", *LOAD_COLUMNS], body)
    text += "\nR² over loaded samples (the side carries Fy > 0):\n\n"
    body = [
        [
            side,
            *(
                "–" if (r2 := by_key["all", side, load]["loaded_r2"]) is None else f"{r2:.5f}"
                for load in LOAD_COLUMNS
            ),
        ]
        for side in SIDES
    ]
    return text + _markdown(["side", *LOAD_COLUMNS], body)


def _activity_errors(title: str, rows: Rows) -> str:
    body = [
        [
            row["activity"],
            row["quantity"],
            row["unit"],
            _number(row["rmse"]),
            _number(row["max_error"]),
            "–" if row["r2"] is None else f"{row['r2']:.4f}",
        ]
        for row in rows
    ]
    header = ["activity", "quantity", "unit", "RMSE", "maximum", "R²"]
    return f"## {title}\n\n" + _markdown(header, body)


def _times(rows: Rows) -> str:
    body = [
        [
            row["what"],
            _number(row["reference_s"]),
            _number(row["surrogate_s"]),
            _number(row["reference_s"] / row["surrogate_s"]),
        ]
        for row in rows
    ]
    header = ["what", "reference [s]", "surrogate [s]", "ratio"]
    return "## Wall times, one thread, this machine\n\n" + _markdown(header, body)


def _external_samples(table: dict[str, Any]) -> str:
    text = "## Samples from elsewhere\n\n"
    provenance = table["provenance"]
    if provenance is not None:
        units = ", ".join(
            provenance["units"][kind] for kind in ("length", "angle", "force", "moment")
        )
        text += (
            f"{provenance['source']} ({provenance['file']}, in {units}, SHA-256 {provenance['sha256'][:12]}…; "
            f"split by {provenance['split']['by']}).\n\n"
        )
    body = [
        ["none" if row["domain"] == 0 else str(row["domain"]), str(row["train"]), str(row["test"])]
        for row in table["domains"]
    ]
    return text + _markdown(["domain", "train", "test"], body)


def _figures(figures: Sequence[str]) -> str:
    links = [f"![{file.split('/')[-1].removesuffix('.png')}]({file})" for file in figures]
    return "## Figures\n\n" + "\n\n".join(links) + "\n"


def render_tables(name: str, tables: dict[str, Any], figures: Sequence[str] = ()) -> str:
    """The whole tables.md of a run, from whichever tables its stages have written.

    Args:
        name: the study's.
        tables: by name.
        figures: shown at the end; paths from the file's folder.
    """
    parts = [f"# {name}\n"]
    if tables.get("fast_error"):
        parts.append(_fast_error(tables["fast_error"]))
    if tables.get("samples"):
        parts.append(_samples(tables["samples"]))
    if tables.get("external_samples"):
        parts.append(_external_samples(tables["external_samples"]))
    if tables.get("sample_errors"):
        parts.append(_sample_errors(tables["sample_errors"]))
    if tables.get("simulation_loads"):
        title = "Simulated activities, surrogate against reference: loads"
        parts.append(_activity_errors(title, tables["simulation_loads"]))
    if tables.get("simulation_kinematics"):
        title = "Simulated activities, surrogate against reference: kinematics"
        parts.append(_activity_errors(title, tables["simulation_kinematics"]))
    if tables.get("times"):
        parts.append(_times(tables["times"]))
    if figures:
        parts.append(_figures(figures))
    return "\n".join(parts)
