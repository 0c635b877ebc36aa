# SPDX-License-Identifier: Apache-2.0
"""Reads and validates a study file."""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from condyle.errors import InputDataError
from condyle.study.schema import Study

_PATHS = ("femur", "insert", "insert_medial", "insert_lateral")


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
    implant = content.get("implant")
    if isinstance(implant, dict):
        for key in _PATHS:
            if isinstance(implant.get(key), str):
                implant[key] = str(folder / implant[key])
    activities = content.get("activities")
    if isinstance(activities, list):
        content["activities"] = [
            str(folder / a) if isinstance(a, str) and a.endswith(".csv") else a for a in activities
        ]


def _describe(error: Any) -> str:
    key = ".".join(str(part) for part in error["loc"])
    if error["type"] == "extra_forbidden":
        return f"{key}: unknown key (value {error['input']!r}); known: {', '.join(_known(error['loc']))}"
    if error["type"] == "value_error":
        message = str(error["ctx"]["error"])
        return f"{key}: {message}" if key else message
    return f"{key} = {error['input']!r}: {error['msg'][0].lower()}{error['msg'][1:]}"


def _known(location: tuple[Any, ...]) -> list[str]:
    model: Any = Study
    for part in location[:-1]:
        field = getattr(model, "model_fields", {}).get(part)
        model = field.annotation if field is not None else None
    return sorted(getattr(model, "model_fields", {}))
