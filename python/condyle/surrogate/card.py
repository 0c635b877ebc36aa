# SPDX-License-Identifier: Apache-2.0
"""Model cards: what a surrogate file is of, how good it is, and what it must not be used for.

    >>> card = model_card("surrogate.onnx")
    >>> print(card_markdown(card))

Everything on a card is in the ONNX file itself, but for the wall times of its training: the same
training gives the same bytes, and a clock does not. They are in the card that was written beside
the file (``surrogate_card.json`` for ``surrogate.onnx``), which counts as long as it names the
file's SHA-256.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from condyle.surrogate.card_text import card_markdown
from condyle.surrogate.file import describe
from condyle.whole_files import content_hash, to_canonical_json, write_whole

__all__ = ["card_files", "card_markdown", "model_card", "pack_rows", "write_model_card"]

#: Key of the training record's errors over held-out samples.
HELD_OUT: Final = "held_out_errors"

LICENCE: Final = (
    "Condyle is under the Apache License 2.0 and claims no rights in surrogates trained with it. A surrogate "
    "is made of the implant's geometry: whoever has rights in the meshes named here decides about its use."
)
_LIMITS: Final = (
    "It stands for one contact: the implant, side of the body, contact law and its parameters named here. It "
    "is not of the same design in another size.",
    "Where `trust` is below 0.5 it must not be used; a hybrid contact model takes the reference there.",
    "Its bound on each load holds for 95 % of poses like the held-out samples, on average over them: "
    "not for every pose, and not where trust is low.",
    "Quasi-static and frictionless, with rigid bodies under the law's pressure: no wear, no viscosity, no lift-off "
    "dynamics.",
    "Its errors are against the reference contact, not against an experiment.",
    "For research and engineering. It is no medical device and not validated for decisions about a patient.",
)


def model_card(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The card of a surrogate file, as JSON data.

    Args:
        path: As for :func:`condyle.surrogate.load_surrogate`.

    Returns:
        ``file`` (its name), ``sha256``, ``outputs``, the metadata by key (see
        :func:`condyle.surrogate.describe`), ``held_out_errors`` (rows as of
        :func:`condyle.evaluation.sample_error_table`; None where the file does not know),
        ``wall_times_s`` by net (None where there is no card beside it), ``limits`` and
        ``licence``.

    Raises:
        InputDataError: The file is missing, damaged or breaks the contract.
    """
    path = Path(path)
    card = describe(path)
    del card["runtime"]  # of this machine, not of the file
    training = dict(card.get("training") or {})
    packed = training.pop(HELD_OUT, None)
    card |= {
        "file": path.name,
        "sha256": content_hash(path.read_bytes()),
        "training": training,
        HELD_OUT: None if packed is None else _unpacked(packed),
        "limits": list(_LIMITS),
        "licence": LICENCE,
    }
    return card | {"wall_times_s": _times_beside(path, card["sha256"])}


def card_files(path: str | os.PathLike[str]) -> tuple[Path, Path]:
    """Where the card of a surrogate file is written: (.md, .json)."""
    path = Path(path)
    return path.with_name(f"{path.stem}_card.md"), path.with_name(f"{path.stem}_card.json")


def write_model_card(
    path: str | os.PathLike[str], wall_times_s: Mapping[str, float] | None = None
) -> tuple[Path, Path]:
    """Writes the card of a surrogate file beside it, as Markdown and as JSON.

    Args:
        path: The surrogate.
        wall_times_s: Of its training by net, if known.

    Returns:
        The files, see :func:`card_files`.
    """
    card = model_card(path)
    if wall_times_s is not None:
        card["wall_times_s"] = {name: round(value, 1) for name, value in wall_times_s.items()}
    markdown, data = card_files(path)
    write_whole(markdown, card_markdown(card))
    write_whole(data, to_canonical_json(card) + "\n")
    return markdown, data


def pack_rows(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Rows with the same keys as columns and values: a third of the text, for a file's metadata."""
    columns = list(rows[0])
    return {"columns": columns, "rows": [[row[column] for column in columns] for row in rows]}


def _unpacked(packed: Mapping[str, Any]) -> list[dict[str, Any]]:
    return [dict(zip(packed["columns"], row, strict=True)) for row in packed["rows"]]


def _times_beside(path: Path, sha256: str) -> dict[str, float] | None:
    """The wall times of the card beside a file, if that is the file's own."""
    try:
        card = json.loads(card_files(path)[1].read_text(encoding="utf-8"))
        times: dict[str, float] | None = card["wall_times_s"] if card["sha256"] == sha256 else None
    except (OSError, ValueError, KeyError, TypeError):
        return None  # no card, or none of ours
    return times
