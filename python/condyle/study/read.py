# SPDX-License-Identifier: Apache-2.0
"""Reads and validates a study file."""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from condyle.errors import InputDataError
from condyle.study.body_sections import BodySection, TrialSection
from condyle.study.curve_sections import CURVE_SECTIONS
from condyle.study.law_sections import LAW_SECTIONS
from condyle.study.schema import Study

_PATHS = ("femur", "insert", "insert_medial", "insert_lateral")
_BODY_PATHS = ("model", "surfaces", "ik_model")
_TRIAL_PATHS = ("motion", "markers", "marker_weights", "external_loads", "paths")
_LAWS = ("law", "pressure_law")
#: Tables that may be missing, and a table of tables, which their annotations hide.
_TRIALS = "a table of trials"
_OPTIONAL: dict[str, Any] = {"body": BodySection, "trials": _TRIALS}
#: Keys whose tables are told apart by their ``kind``, and the sections there are.
_KINDS = {**dict.fromkeys(_LAWS, LAW_SECTIONS), "curves": CURVE_SECTIONS}


def read_study(file: Path | str) -> Study:
    """Reads a study from a TOML file; relative paths in it become relative to the file's folder.

    Raises:
        InputDataError: the file cannot be read, is not TOML, or says something it must not; the message names the file
            and, for each problem, the key, the value and the limit.
    """
    file = Path(file)
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputDataError(f"{file}: cannot be read: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputDataError(f"{file}: is not a TOML file: {error}") from None
    content.setdefault("name", file.stem)
    _resolve_paths(content, file.parent)
    try:
        return Study.model_validate(content)
    except ValidationError as error:
        raise InputDataError(
            f"{file}: " + "; ".join(_describe(e) for e in error.errors())
        ) from None


def _resolve_paths(content: dict[str, Any], folder: Path) -> None:
    _join(content.get("implant"), _PATHS, folder)
    _join(content.get("body"), _BODY_PATHS, folder)
    trials = content.get("trials")
    for trial in trials.values() if isinstance(trials, dict) else ():
        _join(trial, _TRIAL_PATHS, folder)
    contact = content.get("contact")
    for key in _LAWS:
        law = contact.get(key) if isinstance(contact, dict) else None
        if isinstance(law, dict) and isinstance(law.get("file"), str):
            law["file"] = str(folder / law["file"])
    sampling = content.get("sampling")
    if isinstance(sampling, dict) and isinstance(sampling.get("dataset"), str):
        sampling["dataset"] = str(folder / sampling["dataset"])
    curves = sampling.get("curves") if isinstance(sampling, dict) else None
    if isinstance(curves, dict) and isinstance(curves.get("files"), list):
        curves["files"] = [str(folder / f) if isinstance(f, str) else f for f in curves["files"]]
    activities = content.get("activities")
    if isinstance(activities, list):
        content["activities"] = [
            str(folder / a) if isinstance(a, str) and a.endswith(".csv") else a for a in activities
        ]


def _join(table: Any, keys: tuple[str, ...], folder: Path) -> None:
    if not isinstance(table, dict):
        return
    for key in keys:
        if isinstance(table.get(key), str):
            table[key] = str(folder / table[key])


def _describe(error: Any) -> str:
    kind, value = error["type"], error["input"]
    key = ".".join(str(part) for part in _written(error["loc"]))
    if kind == "extra_forbidden":
        return f"{key}: unknown key (value {value!r}); known: {', '.join(_known(error['loc']))}"
    if kind == "value_error":
        message = str(error["ctx"]["error"])
        return f"{key}: {message}" if key else message
    if kind == "missing":
        return f"{key}: is missing"
    if kind == "union_tag_not_found":
        return f"{key}.kind: is missing: must be one of {', '.join(_KINDS[error['loc'][-1]])}"
    if kind == "union_tag_invalid":
        known = ", ".join(_KINDS[error["loc"][-1]])
        return f"{key}.kind = {value['kind']!r}: must be one of {known}"
    return f"{key} = {value!r}: {error['msg'][0].lower()}{error['msg'][1:]}"


def _written(location: tuple[Any, ...]) -> list[Any]:
    """The keys as the file has them.

    Pydantic puts a table's kind into the path to its parameters, and ``[key]`` after a key that is wrong itself.
    """
    before = (None, *location)
    return [
        part
        for part, last in zip(location, before, strict=False)
        if last not in _KINDS and part != "[key]"
    ]


def _known(location: tuple[Any, ...]) -> list[str]:
    model: Any = Study
    kinds: dict[str, Any] = {}
    for part in location[:-1]:
        if model is _TRIALS:
            model = TrialSection
            continue
        field = getattr(model, "model_fields", {}).get(part)
        model = kinds.get(part) if field is None else _OPTIONAL.get(part, field.annotation)
        kinds = _KINDS.get(part, kinds)
    return sorted(getattr(model, "model_fields", {}))
