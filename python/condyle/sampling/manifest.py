# SPDX-License-Identifier: Apache-2.0
"""manifest.json: what a dataset is, how it was made and what was rejected.

No clock, host, path or thread count is in it.

Its *design* (format, identity, plan, curves) decides the content; every part carries the design's
hash, so parts of different designs cannot be mixed. What a run found out (counts, parts) is added
as it ends.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa

import condyle
from condyle.errors import InputDataError
from condyle.sampling.part_files import SAMPLE_SCHEMA, UNITS
from condyle.sampling.plan import SamplingPlan
from condyle.sampling.reference_curves import ReferenceCurves
from condyle.whole_files import content_hash, to_canonical_json

FORMAT: Final = "condyle samples 2"
MANIFEST_NAME: Final = "manifest.json"
_DESIGN_KEYS: Final = ("format", "identity", "plan", "curves")
_FRAMES: Final = {
    "axes": "x anterior, y superior, z to the subject's right "
    "(medial in a left knee, lateral in a right one)",
    "pose": "x, y, z: the femoral origin Fo in the tibial frame T; "
    "theta_x, theta_y, theta_z: Tait-Bryan angles (intrinsic z-y-x) "
    "from the femoral to the tibial frame; flexion is about -theta_z",
    "wrench": "on the femur, at Fo, expressed in T; compression is Fy > 0",
}


def new_manifest(
    plan: SamplingPlan, curves: ReferenceCurves, identity: Mapping[str, Any]
) -> dict[str, Any]:
    """The manifest of a run that is about to start.

    Args:
        plan: The sampling plan.
        curves: The reference curves.
        identity: What was sampled: hashes of implant and contact law, side of body, solver, … (JSON
            values).

    Raises:
        InputDataError: The identity is not JSON.
    """
    design = {
        "format": FORMAT,
        "identity": dict(identity),
        "plan": plan.to_json(),
        "curves": {
            "hash": curves.content_hash(),
            "activities": [
                {"name": curve.name, "time_frames": len(curve.time)} for curve in curves.curves
            ],
        },
    }
    try:
        # Through text and back, so that it compares equal to what is read from a file (tuples are
        # lists there).
        design = json.loads(to_canonical_json(design))
    except (TypeError, ValueError) as error:
        raise InputDataError(f"sampling identity cannot be written as JSON: {error}") from error
    return {
        **design,
        "design_hash": content_hash(to_canonical_json(design).encode()),
        **_description(),
        "complete": False,
        "domains": [],
        "parts": [],
    }


def external_manifest(
    provenance: Mapping[str, Any], side_of_body: str, domains: list[dict[str, Any]]
) -> dict[str, Any]:
    """The manifest of samples that no plan of Condyle's made: no design, plan, curves, candidates.

    Args:
        provenance: Where they are from; JSON values.
        side_of_body: left or right.
        domains: Counts by domain.
    """
    return {
        "format": FORMAT,
        "identity": {
            "side_of_body": side_of_body,
            "implant": {},
            "contact_law": {"name": "external", "source": provenance["source"]},
        },
        "provenance": dict(provenance),
        **_description(),
        "complete": False,
        "domains": domains,
        "parts": [],
    }


def _description() -> dict[str, Any]:
    """What the columns mean, and who wrote them."""
    return {
        "units": {name: UNITS[name] for name in SAMPLE_SCHEMA.names if name in UNITS},
        "frames": _FRAMES,
        "versions": {
            "condyle": condyle.__version__,
            "numpy": np.__version__,
            "pyarrow": pa.__version__,
        },
    }


def read_manifest(directory: Path) -> dict[str, Any]:
    """The manifest of a dataset.

    Raises:
        InputDataError: There is none, or it is not one.
    """
    path = directory / MANIFEST_NAME
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputDataError(
            f"{directory} holds no {MANIFEST_NAME}: it is not a dataset of samples"
        ) from None
    except (OSError, ValueError) as error:
        raise InputDataError(f"{path} cannot be read: {error}") from error
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        found = manifest.get("format") if isinstance(manifest, dict) else type(manifest).__name__
        raise InputDataError(
            f"{path}: format is {found!r}; {FORMAT!r} is needed: sample again, into another directory"
        )
    return manifest


def check_same_design(path: Path, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse to mix two designs.

    Raises:
        InputDataError: Names the first field that differs, with both values.
    """
    for key in _DESIGN_KEYS:
        check_same(
            path,
            key,
            found.get(key),
            wanted.get(key),
            "sample into another directory or remove this one",
        )


def check_same(path: Path, field: str, found: Any, wanted: Any, advice: str) -> None:
    """Refuse two JSON values that differ; the message names the innermost differing field.

    Raises:
        InputDataError: See above.
    """
    if found == wanted:
        return
    if isinstance(found, dict) and isinstance(wanted, dict):
        for key in sorted({*found, *wanted}):
            check_same(path, f"{field}.{key}", found.get(key), wanted.get(key), advice)
    raise InputDataError(f"{path}: {field} is {found!r} there, {wanted!r} is asked for; {advice}")
