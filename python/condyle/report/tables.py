# SPDX-License-Identifier: Apache-2.0
"""Result tables as Markdown; the same rows as tables.json."""

from collections.abc import Sequence
from typing import Any

from condyle.markdown import markdown_table
from condyle.report.activity_errors import kinematics_markdown, loads_markdown
from condyle.report.activity_times import phases_markdown, times_markdown
from condyle.report.equilibrium_failures import failures_markdown
from condyle.surrogate.paper_errors import errors_markdown

Rows = list[dict[str, Any]]
_SPLITS = ("train", "test")


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
    return title + text + markdown_table(header, body)


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
    return "## Samples\n\n" + markdown_table(header, rows) + text


def _sample_errors(rows: Rows) -> str:
    return "## Held-out samples: RMSE (maximum error), N and Nm\n\n" + errors_markdown(rows)


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
    return text + markdown_table(["domain", "train", "test"], body)


def _activities(tables: dict[str, Any]) -> list[str]:
    """What is known of the simulated activities; first of all what is not in equilibrium."""
    parts = []
    if tables.get("unconverged"):
        parts.append(failures_markdown(tables["unconverged"]))
    title = "## Simulated activities, against the reference contact"
    if tables.get("simulation_loads"):
        text = loads_markdown(tables["simulation_loads"])
        parts.append(f"{title}: loads, as in the paper's Table 3\n\n{text}")
    if tables.get("simulation_kinematics"):
        text = kinematics_markdown(tables["simulation_kinematics"])
        parts.append(f"{title}: kinematics, as in the paper's Table 4\n\n{text}")
    if tables.get("times"):
        title = "## Wall times, one thread, this machine"
        if any(row.get("activity") is not None for row in tables["times"]):
            title += ", as in the paper's Table 5"
        parts.append(f"{title}\n\n{times_markdown(tables['times'])}")
        phases = phases_markdown(tables["times"])
        if phases:
            parts.append(f"## Wall times by phase\n\n{phases}")
    return parts


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
    parts += _activities(tables)
    if figures:
        parts.append(_figures(figures))
    return "\n".join(parts)
