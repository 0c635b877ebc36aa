# SPDX-License-Identifier: Apache-2.0
"""What a simulation came from, how it went, and what went wrong: plain values for a summary."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

import condyle
from condyle._core import fdk as _fdk
from condyle._core.contact import PairContactModel
from condyle.conventions import SIDES
from condyle.fdk.contact_pressures import ContactPressures
from condyle.fdk.joint_contacts import JointContact
from condyle.fdk.trial_simulation import TrialSimulation
from condyle.model import MuscleSettings, MusculoskeletalModel, Trial, wraps_passed_by
from condyle.surrogate import HybridContactModel
from condyle.whole_files import content_hash

Array = NDArray[np.float64]
FORMAT: Final = "condyle-trial-simulation"


def summarise_simulation(
    model: MusculoskeletalModel,
    trial: Trial,
    simulation: TrialSimulation,
    contacts: Sequence[JointContact],
    muscles: MuscleSettings,
    settings: _fdk.TrialSimulationSettings,
    pressures: Mapping[str, ContactPressures],
    inputs: Mapping[str, Path | None],
) -> dict[str, Any]:
    """Content of ``summary.json`` but for its list of files; no clock, host or folder is in it.

    Args:
        model: of the simulation.
        trial: likewise.
        simulation: its results.
        contacts: as they were made.
        muscles: how muscles shared load.
        settings: of the solver.
        pressures: by contact.
        inputs: Files that it came from, by what they are; None: not given.
    """
    scaled = scaled_residuals(model, simulation, settings)
    status = [record.status for record in simulation.records]
    return {
        "format": FORMAT,
        "version": 1,
        "condyle": condyle.__version__,
        "model": model.name,
        "inputs": {
            what: {"name": file.name, "sha256": content_hash(file.read_bytes())}
            for what, file in inputs.items()
            if file is not None
        },
        "settings": {"muscles": asdict(muscles), **settings_record(settings)},
        "contacts": [_contact(contact) for contact in contacts],
        "force_dependent": list(simulation.force_dependent),
        "balanced_by_muscles": list(simulation.balanced),
        "at_default": list(trial.at_default),
        "time_frames": len(simulation.times),
        "first_time": float(simulation.times[0]),
        "last_time": float(simulation.times[-1]),
        "status": dict(Counter(status)),
        "summary": simulation.summary,
        "not_in_equilibrium": [
            _trouble(model, simulation, i, scaled)
            for i, record in enumerate(simulation.records)
            if not record.converged
        ],
        "implausible_depth_at": _times(simulation, [s == "implausible_depth" for s in status]),
        "untrusted_at": _times(
            simulation, [r.least_trust < settings.least_trust for r in simulation.records]
        ),
        "sharing_not_settled_at": _times(
            simulation, [not record.sharing_settled for record in simulation.records]
        ),
        "least_trust": min(record.least_trust for record in simulation.records),
        "iterations": sum(record.iterations for record in simulation.records),
        "evaluations": sum(record.evaluations for record in simulation.records),
        "largest_scaled_residual": _number(scaled.max()),
        "largest_activity": _named_peak(simulation, simulation.activities, model.muscle_names),
        "largest_reserve": _named_peak(simulation, simulation.reserves, simulation.balanced),
        "peak_forces": {
            contact.contact.name: contact_peaks(simulation, contact.contact.name)
            for contact in contacts
        },
        "pressures": {name: _pressures(simulation, found) for name, found in pressures.items()},
        "wraps_passed_by": list(wraps_passed_by(model, trial)),
        "not_supported": list(model.not_supported),
    }


def scaled_residuals(
    model: MusculoskeletalModel,
    simulation: TrialSimulation,
    settings: _fdk.TrialSimulationSettings,
) -> Array:
    """(T,) largest net generalised force on a force-dependent coordinate in units of its tolerance."""
    newton = settings.solver.newton
    rotational = dict(zip(model.coordinate_names, model.core.coordinate_is_rotational, strict=True))
    tolerances = np.array(
        [
            newton.moment_tolerance if rotational[name] else newton.force_tolerance
            for name in simulation.force_dependent
        ]
    )
    residuals = np.array([record.residual for record in simulation.records])
    return np.asarray(np.abs(residuals / tolerances).max(axis=1))


def contact_peaks(simulation: TrialSimulation, contact: str) -> dict[str, Any]:
    """Peak forces of a contact over the time frames in equilibrium, with their times.

    Returns:
        ``load`` (``Fy``, compression; of a pair of bodies ``|F|``) and, by ``total``, ``medial`` and ``lateral``,
        ``value_N`` and ``time``; only ``load`` where no time frame is in equilibrium.
    """
    index = simulation.contact(contact)
    pair = isinstance(simulation.contacts[index].model, PairContactModel)
    wrenches = simulation.wrenches[:, index]
    total = wrenches.sum(axis=1)
    curves = {"total": np.linalg.norm(total[:, :3], axis=1) if pair else total[:, 1]}
    if not pair:
        curves |= {side: wrenches[:, i, 1] for i, side in enumerate(SIDES)}
    frames = _in_equilibrium(simulation)
    peaks: dict[str, Any] = {"load": "|F|" if pair else "Fy"}
    for name, curve in curves.items():
        if len(frames) > 0:
            frame = frames[int(curve[frames].argmax())]
            peaks[name] = {
                "value_N": float(curve[frame]),
                "time": float(simulation.times[frame]),
            }
    return peaks


def settings_record(settings: _fdk.TrialSimulationSettings) -> dict[str, Any]:
    """The settings that results depend on: all but the number of threads."""
    solver, newton = settings.solver, settings.solver.newton
    return {
        "newton": {
            "force_tolerance_N": newton.force_tolerance,
            "moment_tolerance_Nm": newton.moment_tolerance,
            "max_iterations": newton.max_iterations,
            "max_newton_step_m": newton.max_newton_step_m,
            "max_newton_step_rad": newton.max_newton_step_rad,
            "max_line_search": newton.max_line_search,
            "jacobian": newton.jacobian.name,
            "perturbation": newton.perturbation,
        },
        "solver": {
            "max_sharing_updates": solver.max_sharing_updates,
            "sharing_tolerance": solver.sharing_tolerance,
            "max_substeps": solver.max_substeps,
            "softer_contact": list(solver.softer_contact),
            "uncoupled": solver.uncoupled,
        },
        "keep_rates": settings.keep_rates,
        "extrapolation": settings.extrapolation,
        "chunk": settings.chunk,
        "least_trust": settings.least_trust,
    }


def _contact(contact: JointContact) -> dict[str, Any]:
    found = dict(contact.identity)
    if isinstance(contact.contact.model, HybridContactModel):
        found["reference_calls"] = contact.contact.model.reference_calls
    return found


def _in_equilibrium(simulation: TrialSimulation) -> NDArray[np.intp]:
    return np.flatnonzero([record.converged for record in simulation.records])


def _times(simulation: TrialSimulation, chosen: Sequence[bool]) -> list[float]:
    return [float(t) for t, one in zip(simulation.times, chosen, strict=True) if one]


def _number(value: float) -> float | None:
    """JSON has no NaN."""
    return float(value) if math.isfinite(value) else None


def _trouble(
    model: MusculoskeletalModel, simulation: TrialSimulation, frame: int, scaled: Array
) -> dict[str, Any]:
    record = simulation.records[frame]
    index = simulation.force_dependent.index(record.worst_coordinate)
    turns = model.core.coordinate_is_rotational[model.coordinate(record.worst_coordinate)]
    return {
        "time": float(simulation.times[frame]),
        "status": record.status,
        "worst_coordinate": record.worst_coordinate,
        f"residual_{'Nm' if turns else 'N'}": _number(record.residual[index]),
        "scaled_residual": _number(scaled[frame]),
        "message": record.message,
    }


def _named_peak(
    simulation: TrialSimulation, table: Array, names: Sequence[str]
) -> dict[str, Any] | None:
    """The largest of a table over the time frames in equilibrium."""
    frames = _in_equilibrium(simulation)
    if table.size == 0 or len(frames) == 0:
        return None
    known = np.abs(table[frames])
    frame, column = np.unravel_index(int(known.argmax()), known.shape)
    return {
        "name": names[int(column)],
        "value": float(table[frames[frame], column]),
        "time": float(simulation.times[frames[frame]]),
    }


def _pressures(simulation: TrialSimulation, found: ContactPressures) -> dict[str, Any]:
    """Peaks by side, and overlap that did not count."""
    frames = _in_equilibrium(simulation)
    if len(frames) == 0:
        return {}
    return {
        part: {
            "peak_pressure_Pa": float(found.peak_pressure[frames, i].max()),
            "time": float(simulation.times[frames[int(found.peak_pressure[frames, i].argmax())]]),
            "max_depth_m": float(found.max_depth[frames, i].max()),
            "border_area_m2": float(found.border_area[frames, i].max()),
        }
        for i, part in enumerate(found.parts)
    }
