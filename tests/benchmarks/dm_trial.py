# SPDX-License-Identifier: Apache-2.0
"""Subject DM in one of its recorded trials, for benchmarks: imported through OpenSim once, then read from a cache."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

import condyle
from condyle.fdk import (
    BodyContact,
    ReferenceSettings,
    patellofemoral_contact,
    tibiofemoral_contact,
)
from condyle.model import (
    MuscleSettings,
    MusculoskeletalModel,
    SurfaceFile,
    Trial,
    hinge_patella,
    joint_surfaces,
    read_trial,
    surface_files,
)
from condyle.surrogate import load_surrogate
from condyle.whole_files import write_whole

Floats = NDArray[np.float64]
ROOT: Final = Path(__file__).parents[2]
DATA: Final = Path(os.environ.get("CONDYLE_DATA", ROOT.parent / "shared" / "data"))
DM: Final = DATA / "subjects" / "dm"
#: What is imported once; may be deleted at any time.
CACHE: Final = ROOT / "build" / "benchmarks_dm"
MASS: Final = 69.98  # [kg]
BODY_WEIGHT: Final = MASS * 9.81  # [N]
#: As in docs/examples/dm_trials.toml.
FORCE_DEPENDENT: Final = ("knee_[art]*_r", "pf_*_r")
RESERVE: Final = 20.0  # [Nm]
NEGLIGIBLE_FORCE: Final = 20.0  # [N]
MUSCLES: Final = MuscleSettings(reserve_moment=RESERVE)
#: Of the motion capture [1/s].
FRAME_RATE: Final = 120.0
#: Time frames this far from evenly spaced are those of a rounded clock [s].
_UNEVEN: Final = 1e-4


@dataclass(frozen=True)
class DmTrial:
    """A trial, and where its parts came from.

    Attributes:
        model: of the body.
        trial: motion, loads, paths.
        cache: folder of what was made for it.
        clock_repair: the largest change that the trial's clock needed [s].
    """

    model: MusculoskeletalModel
    trial: Trial
    cache: Path
    clock_repair: float


def read_dm_trial(
    name: str,
    start: float,
    end: float,
    cache: Path = CACHE,
    *,
    repair_clock: bool = True,
    hinged: bool = False,
) -> DmTrial:
    """Reads a trial of the data; imports model and paths where the cache has none.

    Args:
        name: of the trial's folder.
        start: first time [s].
        end: last time [s].
        cache: a folder for what takes OpenSim to make.
        repair_clock: even out a rounded clock, see :func:`even_motion`.
        hinged: with the patella of Marra et al. 2017 (:func:`condyle.model.hinge_patella`).
    """
    folder = DM / "trials" / name
    motion, repair = folder / "coordinates.sto", 0.0
    if repair_clock:
        motion, repair = even_motion(motion, cache)
    model_file = _model_file(cache)
    model = MusculoskeletalModel.read(model_file)
    if hinged:
        hinge = hinge_patella(model, _surfaces(model), joint_surfaces(model))
        hinged_file = cache / f"hinged_{model_file.name}"
        write_whole(hinged_file, hinge.text())
        model = MusculoskeletalModel.read(hinged_file)
    trial = read_trial(
        model,
        motion,
        external_loads=folder / "external_loads.xml",
        snapshots=_paths_file(motion, name, cache),
        start=start,
        end=end,
        negligible_force=NEGLIGIBLE_FORCE,
    )
    return DmTrial(model, trial, cache, repair)


def dm_contacts(subject: DmTrial, kind: str, surrogate: Path | None = None) -> list[BodyContact]:
    """Tibiofemoral contact of a kind; the patella's, where it has one, is ``fast`` beside all of them."""
    model = subject.model
    surfaces = _surfaces(model)
    joint = joint_surfaces(model)
    settings = ReferenceSettings(cache_directory=subject.cache)
    knee = tibiofemoral_contact(
        surfaces,
        joint,
        "right",
        kind,
        settings=settings,
        surrogate=None if surrogate is None else load_surrogate(surrogate),
        pressures=False,
    )
    if joint.patella is None:
        return [knee.contact]
    # A button may sink in deeper than a condyle: its rim is narrow.
    settings = replace(settings, plausible_depth=4e-3)
    patella = patellofemoral_contact(surfaces, joint, "right", settings=settings, pressures=False)
    return [knee.contact, patella.contact]


def even_motion(motion: Path, cache: Path) -> tuple[Path, float]:
    """The motion with an even clock, and the largest change of a time [s].

    One trial's times are rounded to ms. Differentiated twice, the rounding alone makes accelerations of tens of
    rad/s²; the cameras ran at 120 Hz.
    """
    from condyle.opensim.motion import read_motion, write_sto

    read = read_motion(motion)
    even = even_clock(read.times, FRAME_RATE)
    repair = float(np.abs(even - read.times).max())
    if repair < _UNEVEN:
        return motion, 0.0
    assert not read.in_degrees
    file = cache / f"{motion.parent.name}_{_digest(motion)}.sto"
    if not file.exists():
        write_sto(file, "Coordinates", ["Even clock, 120 Hz."], even, list(read.names), read.values)
    return file, repair


def even_clock(times: Floats, rate: float) -> Floats:
    """The evenly spaced times nearest to these, in least squares."""
    steps = np.arange(len(times)) / rate
    return np.asarray(np.mean(times - steps) + steps)


def _surfaces(model: MusculoskeletalModel) -> dict[str, SurfaceFile]:
    places = surface_files(model, [ROOT / "docs" / "examples" / "dm_surfaces.json"])
    return {name: _in_data(place) for name, place in places.items()}


def _in_data(place: SurfaceFile) -> SurfaceFile:
    """The same surface, its mesh from the data at hand."""
    assert place.file is not None
    return replace(place, file=DATA / "implants" / "dm" / place.file.name)


def _model_file(cache: Path) -> Path:
    source = DM / "model" / "DM.osim"
    file = cache / f"model_{_digest(source)}.json"
    if not file.exists():
        from condyle.opensim import import_model, write_model

        write_model(file, import_model(source, force_dependent=FORCE_DEPENDENT))
    return file


def _paths_file(motion: Path, name: str, cache: Path) -> Path:
    source = DM / "model" / "DM.osim"
    file = cache / f"{name}_{_digest(source, motion)}.json"
    if not file.exists():
        from condyle.opensim import path_snapshots, write_snapshots

        write_snapshots(file, path_snapshots(source, motion))
    return file


def _digest(*sources: Path) -> str:
    """Of what goes in: the files' content and the program that imports them."""
    digest = hashlib.sha256(condyle.__version__.encode())
    for source in sources:
        digest.update(source.read_bytes())
    return digest.hexdigest()[:12]
