# SPDX-License-Identifier: Apache-2.0
"""From the options of ``condyle simulate`` on a trial to its files and what is said of it."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from condyle.cli import simulation_words, trial_maps, trial_options
from condyle.cli.model_words import tell_passed_by
from condyle.errors import InputDataError

if TYPE_CHECKING:
    from condyle.contact import ContactLaw
    from condyle.conventions import SideOfBody
    from condyle.fdk import ContactPressures, JointContact, TrialSimulationSettings
    from condyle.model import (
        JointSurfaces,
        MuscleSettings,
        MusculoskeletalModel,
        SurfaceFile,
        Trial,
    )
    from condyle.surrogate import OnnxContactModel

#: How a side is written at the end of a body's name.
_SIDES = {"_r": "right", "_l": "left", "_right": "right", "_left": "left"}


@dataclass(frozen=True, kw_only=True)
class TrialFiles:
    """What the user named."""

    model: Path
    motion: Path
    loads: Path | None
    paths: Path | None
    meshes: tuple[str, ...]
    surrogate: Path | None
    law_table: Path | None


@dataclass(frozen=True)
class TrialWindow:
    """Which part of the motion, and what of it is let pass."""

    start: float | None
    end: float | None
    negligible_force: float
    any_range: bool


@dataclass(frozen=True, kw_only=True)
class WantedContacts:
    """The contacts as the user asked for them; None: the default."""

    femur: str | None
    insert: str | None
    patella: str | None
    kind: Literal["exact", "fast", "surrogate", "hybrid"] | None
    side_of_body: SideOfBody | None
    law: ContactLaw
    plausible_depth: float
    cache: Path | None
    pressures: bool | None
    map_at: tuple[float, ...] = ()
    map_vtp: bool = False


def run_trial(
    files: TrialFiles,
    window: TrialWindow,
    wanted: WantedContacts,
    muscles: MuscleSettings,
    settings: TrialSimulationSettings,
    output: Path,
) -> bool:
    """Simulates, writes and tells; whether every time frame is in equilibrium."""
    from condyle.fdk import contact_pressures, simulate_trial, write_trial_simulation
    from condyle.fdk.simulation_summary import scaled_residuals
    from condyle.model import joint_surfaces, surface_files, wraps_passed_by

    model, trial = _read(files, window)
    surfaces = surface_files(model, files.meshes)
    joint = joint_surfaces(model, femur=wanted.femur, insert=wanted.insert, patella=wanted.patella)
    began = time.perf_counter()
    contacts = _contacts(files, wanted, surfaces, joint)
    mapped = trial_maps.frames_of(trial, wanted.map_at, contacts[0])
    prepared = time.perf_counter()
    simulation_words.tell_start(trial, len(model.force_dependent), contacts)
    simulation = simulate_trial(
        model, trial, [contact.contact for contact in contacts], muscles, settings
    )
    solved = time.perf_counter()
    pressures: dict[str, ContactPressures] = {}
    for c, contact in enumerate(contacts):
        if contact.reference is not None:
            pressures[contact.contact.name] = contact_pressures(
                contact.reference, simulation.poses[:, c], threads=settings.threads
            )
    evaluated = time.perf_counter()
    inputs = _inputs(files, surfaces, joint)
    written = write_trial_simulation(
        output, model, trial, simulation, contacts, muscles, settings, inputs, pressures
    )
    if mapped:
        written += trial_maps.draw_maps(output, simulation, contacts[0], mapped, vtp=wanted.map_vtp)
    scaled = scaled_residuals(model, simulation, settings)
    simulation_words.tell_result(output, written, simulation)
    simulation_words.tell_peaks(simulation, contacts, pressures)
    simulation_words.tell_quality(simulation, settings, muscles, scaled, contacts)
    spent = simulation_words.tell_time(
        simulation, solved - prepared, prepared - began, evaluated - solved
    )
    _log(output, spent)
    tell_passed_by(wraps_passed_by(model, trial), given=files.paths is not None)
    simulation_words.tell_trouble(simulation, settings, pressures)
    return simulation.converged


def _read(files: TrialFiles, window: TrialWindow) -> tuple[MusculoskeletalModel, Trial]:
    from condyle.model import MusculoskeletalModel

    model = MusculoskeletalModel.read(files.model)
    if not model.force_dependent:
        raise InputDataError(
            f"{files.model}: model {model.name!r} has no force-dependent coordinate: nothing to solve for; give the "
            "knee's secondary coordinates the role force_dependent (condyle opensim import --force-dependent)"
        )
    trial = trial_options.trial_of(
        model,
        files.motion,
        files.loads,
        files.paths,
        window.start,
        window.end,
        window.negligible_force,
        window.any_range,
    )
    return model, trial


def _contacts(
    files: TrialFiles,
    wanted: WantedContacts,
    surfaces: dict[str, SurfaceFile],
    joint: JointSurfaces,
) -> list[JointContact]:
    """The knee's contact, and the patella's where there is one."""
    from condyle.fdk import ReferenceSettings, patellofemoral_contact, tibiofemoral_contact
    from condyle.surrogate import load_surrogate

    surrogate = None if files.surrogate is None else load_surrogate(files.surrogate)
    kind = wanted.kind or ("fast" if surrogate is None else "surrogate")
    side = wanted.side_of_body or _side_of(surrogate, surfaces, joint)
    # Two contacts share the femur's field: kept for as long as that takes, where nobody said how long.
    with tempfile.TemporaryDirectory() as for_now:
        settings = ReferenceSettings(
            law=wanted.law,
            plausible_depth=wanted.plausible_depth,
            cache_directory=wanted.cache or for_now,
        )
        knee = tibiofemoral_contact(
            surfaces,
            joint,
            side,
            kind,
            settings=settings,
            surrogate=surrogate,
            pressures=wanted.pressures,
        )
        contacts = [knee]
        if joint.patella is not None:
            contacts.append(
                patellofemoral_contact(
                    surfaces,
                    joint,
                    side,
                    "exact" if kind == "exact" else "fast",
                    settings=settings,
                    pressures=wanted.pressures is not False,
                )
            )
    return contacts


def _side_of(
    surrogate: OnnxContactModel | None, surfaces: dict[str, SurfaceFile], joint: JointSurfaces
) -> SideOfBody:
    """The surrogate's, unless the bodies' names say the other."""
    if surrogate is None:
        raise InputDataError("--side-of-body left or right is needed: no surrogate says which")
    side: SideOfBody = "left" if surrogate.side_of_body.name == "left" else "right"
    for name in (joint.femur, joint.insert):
        body = surfaces[name].body if name in surfaces else None
        for end, other in _SIDES.items():
            if body is not None and body.lower().endswith(end) and other != side:
                raise InputDataError(
                    f"{surrogate.file}: metadata condyle.side_of_body is {side!r}; surface {name!r} is on body "
                    f"{body!r}: if that is a {side} knee, say --side-of-body {side}"
                )
    return side


def _inputs(
    files: TrialFiles, surfaces: dict[str, SurfaceFile], joint: JointSurfaces
) -> dict[str, Path | None]:
    inputs = trial_options.trial_inputs(files.model, files.motion, files.loads, files.paths)
    inputs |= {"surrogate": files.surrogate, "law_table": files.law_table}
    mappings = [Path(source) for source in files.meshes if Path(source).suffix == ".json"]
    inputs |= {f"meshes_{i + 1}": file for i, file in enumerate(mappings)}
    for part in ("femur", "insert", "patella"):
        name = getattr(joint, part)
        inputs[f"{part}_mesh"] = surfaces[name].file if name in surfaces else None
    return inputs


def _log(folder: Path, text: str) -> None:
    """Adds a line to run.log, the one file with a clock in it."""
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    with (folder / "run.log").open("a", encoding="utf-8") as file:
        file.write(f"{stamp} {text}\n")
