# SPDX-License-Identifier: Apache-2.0
"""The patellar ligament as one linear spring, in a model file's own terms.

Strands between patella and tibia give their place to one line from the mean of their ends on the patella to that on the
tibia. They stay in the model without stiffness, so that results have the same columns and path snapshots still fit. One
strand alone becomes that line itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from condyle._core.model import Kinematics
from condyle.errors import InputDataError
from condyle.model.musculoskeletal_model import MusculoskeletalModel

Content = dict[str, Any]

LINE: Final = "patellar_ligament"


@dataclass(frozen=True)
class PatellarLine:
    """The ligament, and what it stands for.

    Attributes:
        name: of the ligament in the model.
        strands: names of those whose place it takes; of itself, where it was the only one.
    """

    name: str
    strands: tuple[str, ...]


def patellar_strands(content: Content, patella: str, tibia: str) -> list[Content]:
    """Ligaments that run from one body to the other, and touch no third.

    Args:
        content: of a model file.
        patella: body.
        tibia: body.

    Raises:
        InputDataError: there is none, or an end of one is not fixed to its body.
    """
    found = []
    for ligament in content.get("ligaments", []):
        points = ligament["path"]["points"]
        bodies = [point["body"] for point in points]
        if {bodies[0], bodies[-1]} != {patella, tibia} or set(bodies) != {patella, tibia}:
            continue
        if any(
            key in point for point in (points[0], points[-1]) for key in ("moving", "condition")
        ):
            raise InputDataError(
                f"model {content['name']!r}, ligament {ligament['name']!r}: its ends must be fixed to {patella!r} and "
                f"{tibia!r}"
            )
        found.append(ligament)
    if not found:
        raise InputDataError(
            f"model {content['name']!r}: no ligament runs from {patella!r} to {tibia!r}: there is no patellar ligament"
        )
    return found


def put_line(
    content: Content, strands: list[Content], patella: str, tibia: str, stiffness: float
) -> PatellarLine:
    """F = k (L − L₀) in the place of strands; L₀ is left to :func:`make_taut`.

    Args:
        content: is changed.
        strands: of :func:`patellar_strands`.
        patella: body.
        tibia: body.
        stiffness: k [N/m].

    Raises:
        InputDataError: something else has the line's name.
    """
    names = tuple(strand["name"] for strand in strands)
    linear = {"law": "linear", "stiffness": stiffness, "damping": 0.0}
    if len(strands) == 1:
        strands[0].pop("transition_strain", None)
        strands[0] |= linear
        return PatellarLine(names[0], names)
    if any(
        item["name"] == LINE for key in ("ligaments", "muscles") for item in content.get(key, [])
    ):
        raise InputDataError(f"model {content['name']!r} has a {LINE!r} already: rename it")
    ends: dict[str, list[list[float]]] = {patella: [], tibia: []}
    for strand in strands:
        for point in (strand["path"]["points"][0], strand["path"]["points"][-1]):
            ends[point["body"]].append(point["location"])
        strand["stiffness"] = 0.0
    points = [
        {"body": body, "location": np.mean(locations, axis=0).tolist()}
        for body, locations in ends.items()
    ]
    content["ligaments"].append(
        {"name": LINE, **linear, "slack_length": 1.0, "path": {"points": points}}
    )
    return PatellarLine(LINE, names)


def make_taut(content: Content, model: MusculoskeletalModel, line: PatellarLine) -> float:
    """Gives the line its length at the model's default posture as slack length, which is returned [m].

    Args:
        content: is changed.
        model: as compiled from it.
        line: of :func:`put_line`.
    """
    kinematics = Kinematics(model.core, model.default_q())
    points = kinematics.ligament_line(model.ligament_names.index(line.name), None, 0)
    length = float(np.linalg.norm(np.diff(np.asarray(points), axis=0), axis=1).sum())
    (ligament,) = (item for item in content["ligaments"] if item["name"] == line.name)
    ligament["slack_length"] = length
    return length
