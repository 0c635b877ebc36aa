# SPDX-License-Identifier: Apache-2.0
"""A model card as Markdown, readable as it stands."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from condyle.conventions import LOAD_COLUMNS, LOAD_UNITS, POSE_COLUMNS, SIDES
from condyle.markdown import markdown_table, rounded
from condyle.surrogate.paper_errors import errors_markdown

Card = Mapping[str, Any]


def card_markdown(card: Card) -> str:
    """The text of a card made by :func:`condyle.surrogate.card.model_card`."""
    parts = [
        _head(card),
        _implant(card),
        _domains(card),
        _held_out(card),
        _bounds(card),
        _training(card),
        "## Limits of use\n\n" + "".join(f"- {limit}\n" for limit in card["limits"]),
        f"## Licence\n\n{card['licence']}\n",
    ]
    return "\n".join(part for part in parts if part)


def _head(card: Card) -> str:
    lines = [
        ("file", card["file"]),
        ("SHA-256", card["sha256"]),
        ("contract", f"version {card['contract_version']}; outputs {', '.join(card['outputs'])}"),
        ("architecture", card["architecture"]),
        ("side of the body", card["side_of_body"]),
        ("units", str(card.get("units", ""))),
    ]
    text = f"# Surrogate contact model `{card['file']}`\n\n"
    text += markdown_table(["", ""], [[name, value] for name, value in lines])
    frames = card.get("frames")
    if isinstance(frames, Mapping):
        text += "\n" + "".join(f"- {name}: {said}\n" for name, said in frames.items())
    return text


def _implant(card: Card) -> str:
    text = "## Implant and contact law\n\n"
    rows = [[name, _inline(value)] for name, value in (card.get("implant") or {}).items()]
    text += markdown_table(["implant", "SHA-256 or description"], rows)
    rows = [[name, _inline(value)] for name, value in (card.get("contact_law") or {}).items()]
    return text + "\n" + markdown_table(["contact law", ""], rows)


def _domains(card: Card) -> str:
    bounds = card.get("domain_bounds") or {}
    text = "## Sampled domains and trust\n\n"
    low, high = bounds.get("pose_min"), bounds.get("pose_max")
    if low and high:
        rows = []
        for name in POSE_COLUMNS:
            factor, unit = (math.degrees(1.0), "°") if name.startswith("theta") else (1e3, "mm")
            rows.append([f"{name} [{unit}]", *(f"{factor * v[name]:.2f}" for v in (low, high))])
        text += markdown_table(["training poses", "least", "greatest"], rows)
    if loads := bounds.get("max_Fy"):
        shown = ", ".join(f"{side} {loads[side]:.0f} N" for side in SIDES)
        text += f"\nLargest Fy among them: {shown}.\n"
    if cells := bounds.get("cells"):
        text += (
            f"\nTrust: {len(cells)} cells ({'; '.join(cells)}). A pose is trusted (≥ 0.5) up to {bounds['edge']:.3g} "
            f"times the size of the nearest cell; trust falls from 1 to 0 within ±{bounds['ramp']:.3g} of that.\n"
        )
    if sampling := bounds.get("sampling"):
        text += f"\nSampling: {_inline(sampling)}\n"
    return text


def _held_out(card: Card) -> str:
    rows = card["held_out_errors"]
    if not rows:
        return ""
    counts = {row["domain"]: row["count"] for row in rows}
    shown = ", ".join(
        f"{count} {'in all' if domain == 'all' else f'in domain {domain}'}"
        for domain, count in counts.items()
    )
    title = "## Errors over held-out samples: RMSE (maximum), N and Nm\n\n"
    return title + errors_markdown(rows) + f"\nSamples: {shown}.\n"


def _bounds(card: Card) -> str:
    table = card.get("error_table") or {}
    if not all(side in table for side in SIDES):
        return ""
    body = []
    for side in SIDES:
        for load, unit in zip(LOAD_COLUMNS, LOAD_UNITS, strict=True):
            entry = table[side]["loads"][load]
            bound = f"{rounded(entry['offset'])} {unit}"
            if entry["slope_per_N"]:
                bound += f" + {entry['slope_per_N']:.2g} {unit}/N · Fy"
            body.append([side, load, bound, f"{entry['coverage']:.1%}"])
    title = f"## Bound on the error (output `error`), level {table.get('level', 0.95):.0%}\n\n"
    header = ["side", "load", "bound", "held-out loaded samples within"]
    return title + markdown_table(header, body)


def _training(card: Card) -> str:
    record = card["training"]
    text = "## Training\n\n"
    if record.get("n_samples"):
        loaded = " and ".join(
            f"{count} with the {side} side loaded"
            for side, count in zip(SIDES, record.get("n_loaded", ()), strict=False)
        )
        text += f"{record['n_samples']} samples, {loaded}.\n\n"
    if nets := record.get("nets"):
        times = card.get("wall_times_s")
        text += markdown_table(
            ["net", "layers", "parameters", "samples", "epochs", "stop", "loss", "γ"],
            [
                [
                    net["name"],
                    "-".join(map(str, net["widths"])),
                    str(net["n_parameters"]),
                    str(net["n_rows"]),
                    str(net["epochs"]),
                    net["stop_reason"],
                    f"{net['loss']:.2e}",
                    f"{net['gamma']:.0f}" if net["gamma"] else "–",
                ]
                for net in nets
            ],
        )
        if times:
            shown = ", ".join(f"{name} {seconds:.0f} s" for name, seconds in times.items())
            text += f"\nWall time: {sum(times.values()) / 60:.1f} min ({shown}).\n"
    known = ("settings", "versions", "architecture_search", "samples", "provenance", "data_hash")
    for key in known:
        if key in record:
            text += f"\n{key.replace('_', ' ')}: {_inline(record[key])}\n"
    return text


def _inline(value: Any) -> str:
    """Data in one line: `a 1, b 2`."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_inline(v)}" for name, v in value.items())
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_inline(v) for v in value) + "]"
    return value if isinstance(value, str) else json.dumps(value)
