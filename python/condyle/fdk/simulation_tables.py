# SPDX-License-Identifier: Apache-2.0
"""A simulated trial as named columns with units: what its files hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle._core.contact import PairContactModel
from condyle.contact.mesh_contact import MeshContact
from condyle.conventions import (
    KINEMATICS_COLUMNS,
    LOAD_COLUMNS,
    LOAD_UNITS,
    POSE_COLUMNS,
    SIDES,
)
from condyle.fdk.contact_pressures import ContactPressures
from condyle.fdk.trial_simulation import TrialSimulation
from condyle.model import MusculoskeletalModel
from condyle.model.analysis_files import generalised_force_columns

Array = NDArray[np.float64]
_POSE_UNITS: Final = ("m",) * 3 + ("rad",) * 3


@dataclass(frozen=True)
class ResultTable:
    """Columns over the time frames.

    Attributes:
        columns: their names.
        units: of each; empty: none.
        values: (T, columns).
        own_file: written as an STO file of its own, too.
    """

    columns: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    own_file: bool = True


def simulation_tables(
    model: MusculoskeletalModel,
    simulation: TrialSimulation,
    pressures: Mapping[str, ContactPressures] | None = None,
) -> dict[str, ResultTable]:
    """Every result but the record, by the name of its file.

    Args:
        model: of the simulation.
        simulation: its results.
        pressures: of the reference contact at the poses found, by contact.
    """
    tables = _body_tables(model, simulation)
    for index, contact in enumerate(simulation.contacts):
        one_sided = isinstance(contact.model, PairContactModel)
        tables[f"{contact.name}_contact"] = _contact_table(simulation, index, one_sided)
        if not one_sided:
            tables[f"{contact.name}_kinematics"] = ResultTable(
                KINEMATICS_COLUMNS,
                ("rad",) * 3 + ("m",) * 3,
                simulation.kinematics(contact.name),
            )
        if pressures is not None and contact.name in pressures:
            tables[f"{contact.name}_pressures"] = _pressure_table(pressures[contact.name])
            if not isinstance(contact.model, (MeshContact, PairContactModel)):
                tables[f"{contact.name}_reference"] = _wrench_table(
                    pressures[contact.name].parts, pressures[contact.name].wrench
                )
    return tables


def record_columns(simulation: TrialSimulation, scaled: Array) -> dict[str, tuple[str, list[Any]]]:
    """What became of each time frame: unit and values by column.

    Args:
        simulation: its results.
        scaled: (T,) largest residual in units of its tolerance.
    """
    records = simulation.records
    worst = [
        float(record.residual[simulation.force_dependent.index(record.worst_coordinate)])
        for record in records
    ]
    return {
        "status": ("", [record.status for record in records]),
        "approach": ("", [record.approach for record in records]),
        "iterations": ("", [record.iterations for record in records]),
        "evaluations": ("", [record.evaluations for record in records]),
        "substeps": ("", [record.substeps for record in records]),
        "worst_coordinate": ("", [record.worst_coordinate for record in records]),
        "worst_residual": ("N or Nm", worst),
        "scaled_residual": ("", scaled.tolist()),
        "remaining_m": ("m", [record.remaining[0] for record in records]),
        "remaining_rad": ("rad", [record.remaining[1] for record in records]),
        "attainable_N": ("N", [record.attainable[0] for record in records]),
        "attainable_Nm": ("Nm", [record.attainable[1] for record in records]),
        "sharing_settled": ("", [record.sharing_settled for record in records]),
        "trust": ("", [record.least_trust for record in records]),
        "message": ("", [record.message for record in records]),
    }


def _body_tables(
    model: MusculoskeletalModel, simulation: TrialSimulation
) -> dict[str, ResultTable]:
    forces = generalised_force_columns(model)
    turning = model.core.coordinate_is_rotational
    of_force = ["Nm" if rotational else "N" for rotational in turning]
    ends = dict(zip(model.coordinate_names, zip(forces, of_force, strict=True), strict=True))
    balanced = [ends[name] for name in simulation.balanced]
    muscles, ligaments = model.muscle_names, model.ligament_names
    made = [
        ("coordinates", model.coordinate_names, ["rad" if r else "m" for r in turning],
         simulation.q, True),
        ("generalised_forces", forces, of_force, simulation.generalised_forces, True),
        ("residuals", forces, of_force, simulation.residuals, True),
        ("contact_loads", forces, of_force, simulation.contact_loads, False),
        ("ligament_loads", forces, of_force, simulation.ligament_loads, False),
        ("spring_loads", forces, of_force, simulation.spring_loads, False),
        ("muscle_forces", muscles, "N", simulation.muscle_forces, True),
        ("activities", muscles, "", simulation.activities, True),
        ("muscle_lengths", muscles, "m", simulation.muscle_lengths, False),
        ("muscle_strengths", muscles, "N", simulation.muscle_strengths, False),
        ("passive_forces", muscles, "N", simulation.passive_forces, False),
        ("reserves", [name for name, _ in balanced], [unit for _, unit in balanced],
         simulation.reserves, True),
        ("ligament_forces", ligaments, "N", simulation.ligament_forces, True),
        ("ligament_strains", ligaments, "", simulation.ligament_strains, True),
        ("ligament_lengths", ligaments, "m", simulation.ligament_lengths, False),
    ]  # fmt: skip
    tables = {}
    for name, columns, units, values, own_file in made:
        if len(columns) == 0 or (name == "reserves" and not np.any(values)):
            continue
        each = [units] * len(columns) if isinstance(units, str) else units
        tables[name] = ResultTable(tuple(columns), tuple(each), np.asarray(values), own_file)
    return tables


def _contact_table(simulation: TrialSimulation, index: int, one_sided: bool) -> ResultTable:
    """Pose, wrenches, error bounds and trust; of a pair, which has one side and no errors, the total."""
    wrenches = simulation.wrenches[:, index]
    total = wrenches.sum(axis=1, keepdims=True)
    parts: Sequence[str] = ("total",)
    if not one_sided:
        parts, total = (*SIDES, "total"), np.concatenate([wrenches, total], axis=1)
    loads = _wrench_table(parts, total)
    columns, units = [*POSE_COLUMNS, *loads.columns], [*_POSE_UNITS, *loads.units]
    values = [simulation.poses[:, index], loads.values]
    if not one_sided:
        bounds = _wrench_table([f"{side}_error" for side in SIDES], simulation.errors[:, index])
        columns, units = [*columns, *bounds.columns], [*units, *bounds.units]
        values.append(bounds.values)
    values.append(simulation.trust[:, index : index + 1])
    return ResultTable((*columns, "trust"), (*units, ""), np.concatenate(values, axis=1))


def _wrench_table(parts: Sequence[str], wrenches: Array) -> ResultTable:
    """Of wrenches (T, parts, 6)."""
    return ResultTable(
        tuple(f"{part}_{load}" for part in parts for load in LOAD_COLUMNS),
        LOAD_UNITS * len(parts),
        wrenches.reshape(len(wrenches), -1),
    )


def _pressure_table(pressures: ContactPressures) -> ResultTable:
    columns: list[str] = []
    units: list[str] = []
    values: list[Array] = []
    for i, part in enumerate(pressures.parts):
        found: list[tuple[str, str, Array | None]] = [
            *(
                (f"cop_{axis}", "m", pressures.centre_of_pressure[:, i, k])
                for k, axis in enumerate("xyz")
            ),
            ("peak_pressure", "Pa", pressures.peak_pressure[:, i]),
            (
                "mean_pressure",
                "Pa",
                None if pressures.mean_pressure is None else pressures.mean_pressure[:, i],
            ),
            ("area", "m2", pressures.area[:, i]),
            ("max_depth", "m", pressures.max_depth[:, i]),
            ("border_area", "m2", pressures.border_area[:, i]),
        ]
        for name, unit, column in found:
            if column is not None:
                columns.append(f"{part}_{name}")
                units.append(unit)
                values.append(column)
    return ResultTable(tuple(columns), tuple(units), np.stack(values, axis=1))
