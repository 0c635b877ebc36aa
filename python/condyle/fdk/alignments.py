# SPDX-License-Identifier: Apache-2.0
"""One trial under many alignments of the implant, each a simulation of its own, on a pool of threads.

What moves with a component is its surface, and with it the frame that contact is computed in. The bones do not: muscles
and ligaments keep their attachments and slack lengths, inertia its place, and the motion is the recorded one. So the
numbers say what an alignment does to contact under one and the same motion, not how a patient would walk with it, nor
what a surgeon would release. A patella on a hinge stays on it: the axis belongs to the model.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle._core import fdk as _fdk
from condyle.errors import InputDataError
from condyle.fdk.alignment import Alignment, aligned_contacts
from condyle.fdk.body_contact import BodyContact
from condyle.fdk.joint_contacts import TIBIOFEMORAL
from condyle.fdk.trial_simulation import TrialSimulation, simulate_trial
from condyle.model import MuscleSettings, MusculoskeletalModel, Trial

Array = NDArray[np.float64]


@dataclass(frozen=True)
class AlignedSimulation:
    """A trial under one alignment.

    Attributes:
        alignment: of the implant.
        simulation: its results; time frames that did not converge are in them, as in any. None where it could not run.
        failure: why it could not; empty where it did.
    """

    alignment: Alignment
    simulation: TrialSimulation | None
    failure: str = ""

    @property
    def converged(self) -> bool:
        """It ran, and every time frame is in equilibrium."""
        return self.simulation is not None and self.simulation.converged


def simulate_alignments(
    model: MusculoskeletalModel,
    trial: Trial,
    contacts: Sequence[BodyContact],
    placements: Sequence[Alignment],
    muscles: MuscleSettings | None = None,
    settings: _fdk.TrialSimulationSettings | None = None,
    *,
    starts: Array | None = None,
    tibiofemoral: str = TIBIOFEMORAL,
    threads: int = 0,
) -> tuple[AlignedSimulation, ...]:
    """Runs :func:`simulate_trial` for every alignment.

    Contact models are shared, not rebuilt: nothing in them depends on where they are on the bones. An alignment that
    cannot be simulated does not cost the others. The same bytes for any number of threads. All results are held in
    memory, some MB each for a trial of a few seconds: give thousands of alignments in parts.

    Args:
        model: as for :func:`simulate_trial`.
        trial: likewise.
        contacts: likewise, where the model has them; each alignment moves them from there.
        placements: the alignments.
        muscles: as for :func:`simulate_trial`.
        settings: likewise, but for ``threads``: each simulation has one.
        starts: likewise, the same for all.
        tibiofemoral: name of the contact of femoral and tibial component.
        threads: alignments at a time; 0 for all cores.

    Returns:
        One for each alignment, in their order.

    Raises:
        InputDataError: no contact of that name, threads below 0, or not one alignment can be simulated (the text is the
            first one's).
    """
    if threads < 0:
        raise InputDataError(f"threads {threads}: must be at least 0")
    moved = [aligned_contacts(contacts, placement, tibiofemoral) for placement in placements]

    def run(item: tuple[Alignment, tuple[BodyContact, ...]]) -> AlignedSimulation:
        placement, where = item
        try:
            own = _own_settings(settings)
            return AlignedSimulation(
                placement, simulate_trial(model, trial, where, muscles, own, starts=starts)
            )
        except (ValueError, RuntimeError) as error:
            return AlignedSimulation(placement, None, str(error))

    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        found = tuple(pool.map(run, zip(placements, moved, strict=True)))
    if found and all(one.simulation is None for one in found):
        raise InputDataError(
            f"none of {len(found)} alignments can be simulated; {found[0].alignment.sentence()}: {found[0].failure}"
        )
    return found


def _own_settings(settings: _fdk.TrialSimulationSettings | None) -> _fdk.TrialSimulationSettings:
    """A copy for one simulation, which writes into its settings; with one thread."""
    own = _fdk.TrialSimulationSettings()
    for name, value in vars(type(own)).items():
        if settings is not None and isinstance(value, property):
            setattr(own, name, getattr(settings, name))
    own.threads = 1
    return own
