# SPDX-License-Identifier: Apache-2.0
"""A simulated trial in files: OpenSim's tables, a record of every time frame, one Parquet file, and a summary.

    coordinates.sto, generalised_forces.sto, …   one table each (docs/simulation.md)
    record.csv          what became of each time frame
    simulation.parquet  all of these and more as columns TABLE/COLUMN, with units and the summary in its metadata
    summary.json        last of all: where it comes from, how it went, and the SHA-256 of the files beside it

The same inputs give the same bytes: no clock, host or folder is in them.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from condyle._core import fdk as _fdk
from condyle._core.io import make_motion, write_motion
from condyle.errors import InputDataError
from condyle.fdk.contact_pressures import ContactPressures
from condyle.fdk.joint_contacts import JointContact
from condyle.fdk.simulation_summary import FORMAT, scaled_residuals, summarise_simulation
from condyle.fdk.simulation_tables import ResultTable, record_columns, simulation_tables
from condyle.fdk.trial_simulation import TrialSimulation
from condyle.model import MuscleSettings, MusculoskeletalModel, Trial
from condyle.whole_files import content_hash, to_canonical_json, write_whole

Array = NDArray[np.float64]
SUMMARY: Final = "summary.json"
RECORD: Final = "record.csv"
PARQUET: Final = "simulation.parquet"
#: Key of the summary in the Parquet file's metadata.
METADATA_KEY: Final = b"condyle"


def write_trial_simulation(
    folder: Path,
    model: MusculoskeletalModel,
    trial: Trial,
    simulation: TrialSimulation,
    contacts: Sequence[JointContact],
    muscles: MuscleSettings,
    settings: _fdk.TrialSimulationSettings,
    inputs: Mapping[str, Path | None],
    pressures: Mapping[str, ContactPressures] | None = None,
) -> list[Path]:
    """Writes everything; ``summary.json`` comes last and stands for the files that it names.

    Files that an earlier summary in the folder names, and this run does not write, are removed.

    Args:
        folder: made where needed.
        model: of the simulation.
        trial: likewise.
        simulation: its results; time frames that are not in equilibrium are written as they are.
        contacts: as they were made, in the simulation's order.
        muscles: how muscles shared load.
        settings: of the solver.
        inputs: Files that it came from, by what they are; None: not given.
        pressures: of the reference contact at the poses found, by contact.

    Returns:
        The files written.

    Raises:
        InputDataError: a file cannot be written, or read again for its hash.
    """
    folder.mkdir(parents=True, exist_ok=True)
    earlier = _earlier_files(folder)
    (folder / SUMMARY).unlink(missing_ok=True)
    tables = simulation_tables(model, simulation, pressures)
    record = record_columns(simulation, scaled_residuals(model, simulation, settings))
    summary = summarise_simulation(
        model, trial, simulation, contacts, muscles, settings, pressures or {}, inputs
    )
    written = [
        *_write_tables(folder, simulation.times, tables),
        _write_record(folder, simulation.times, record),
        _write_parquet(folder, simulation.times, tables, record, summary),
    ]
    for name in earlier - {file.name for file in written}:
        (folder / name).unlink(missing_ok=True)
    summary["files"] = {file.name: content_hash(file.read_bytes()) for file in written}
    write_whole(folder / SUMMARY, to_canonical_json(summary) + "\n")
    return [*written, folder / SUMMARY]


def _earlier_files(folder: Path) -> set[str]:
    """Names of the files of an earlier simulation here."""
    try:
        content = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            return set()
        return {name for name in content["files"] if Path(name).name == name}
    except (OSError, ValueError, KeyError, TypeError):
        return set()


def _write_tables(folder: Path, times: Array, tables: Mapping[str, ResultTable]) -> list[Path]:
    written = []
    for name, table in tables.items():
        if not table.own_file:
            continue
        file = folder / f"{name}.sto"
        values = np.ascontiguousarray(table.values, dtype=np.float64)
        try:
            write_motion(make_motion(name, list(table.columns), times, values, False), file)
        except RuntimeError as error:
            raise InputDataError(str(error)) from error
        written.append(file)
    return written


def _write_record(folder: Path, times: Array, record: Mapping[str, tuple[str, list[Any]]]) -> Path:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time", *record])
    columns = [[repr(time) for time in times.tolist()]]
    for _, values in record.values():
        columns.append([repr(v) if isinstance(v, float) else str(v) for v in values])
    writer.writerows(zip(*columns, strict=True))
    write_whole(folder / RECORD, text.getvalue())
    return folder / RECORD


def _write_parquet(
    folder: Path,
    times: Array,
    tables: Mapping[str, ResultTable],
    record: Mapping[str, tuple[str, list[Any]]],
    summary: Mapping[str, Any],
) -> Path:
    import pyarrow as pa  # here alone: simulations without files need not wait for it
    import pyarrow.parquet as pq

    def field(name: str, unit: str, kind: Any) -> Any:
        return pa.field(name, kind, nullable=False, metadata={"unit": unit} if unit else None)

    fields, arrays = [field("time", "s", pa.float64())], [pa.array(times)]
    for name, table in tables.items():
        for i, (column, unit) in enumerate(zip(table.columns, table.units, strict=True)):
            fields.append(field(f"{name}/{column}", unit, pa.float64()))
            arrays.append(pa.array(np.ascontiguousarray(table.values[:, i])))
    for column, (unit, values) in record.items():
        array = pa.array(values)
        fields.append(field(f"record/{column}", unit, array.type))
        arrays.append(array)
    metadata = {METADATA_KEY: to_canonical_json(dict(summary)).encode()}
    content = io.BytesIO()
    table = pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata))
    # Dictionaries and statistics of a thousand columns of a hundred rows are most of the file.
    pq.write_table(table, content, use_dictionary=False, write_statistics=False)
    write_whole(folder / PARQUET, content.getvalue())
    return folder / PARQUET
