# SPDX-License-Identifier: Apache-2.0
"""What ``condyle simulate`` says of a trial: result, peaks, time, and each kind of trouble."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from condyle.cli.model_words import say, warn

if TYPE_CHECKING:
    from condyle.fdk import (
        ContactPressures,
        JointContact,
        TrialSimulation,
        TrialSimulationSettings,
    )
    from condyle.model import MuscleSettings, Trial

#: Time frames of one kind of trouble that the screen shows; files have them all.
_SHOWN = 8


def tell_start(trial: Trial, unknowns: int, contacts: Sequence[JointContact]) -> None:
    """What is about to be solved, with what: `exact` may take minutes."""
    models = ", ".join(f"{contact.contact.name} {contact.kind}" for contact in contacts)
    times = trial.times
    say(
        f"{_counted(len(times))} from {times[0]:g} to {times[-1]:g} s; {unknowns} force-dependent coordinates; "
        f"contact: {models}"
    )
    for contact in contacts:
        if error := contact.identity.get("reference", {}).get("error_against_exact"):
            say(f"{contact.contact.name} {error}")


def tell_result(folder: Path, written: Sequence[Path], simulation: TrialSimulation) -> None:
    """How many time frames converged, and where results are."""
    say(simulation.summary.partition(";")[0])
    say(f"{folder}: {', '.join(file.name for file in written)}")


def _counted(frames: int) -> str:
    return f"{frames} time frame" + ("s" if frames != 1 else "")


def tell_peaks(
    simulation: TrialSimulation,
    contacts: Sequence[JointContact],
    pressures: Mapping[str, ContactPressures],
) -> None:
    """Peak forces by contact; where a surrogate solved, how far the reference is at the same poses."""
    from condyle.fdk.simulation_summary import contact_peaks

    for contact in contacts:
        name = contact.contact.name
        peaks = contact_peaks(simulation, name)
        load = peaks.pop("load")
        if peaks:
            shown = ", ".join(
                f"{part} {peak['value_N']:.1f} N at {peak['time']:g} s"
                for part, peak in peaks.items()
            )
            say(f"{name} {load}: peak {shown}")
        if peaks and contact.kind in ("surrogate", "hybrid") and name in pressures:
            index = simulation.contact(name)
            good = [i for i, record in enumerate(simulation.records) if record.converged]
            gap = simulation.wrenches[good, index, :, 1] - pressures[name].wrench[good, :, 1]
            rms = np.sqrt(np.mean(gap**2, axis=0))
            say(
                f"{name} Fy against the reference at the same poses: RMS medial {rms[0]:.2f} N, "
                f"lateral {rms[1]:.2f} N"
            )


def tell_quality(
    simulation: TrialSimulation,
    settings: TrialSimulationSettings,
    muscles: MuscleSettings,
    scaled: NDArray[np.float64],
    contacts: Sequence[JointContact],
) -> None:
    """Residuals, work, trust and reserves."""
    newton = settings.solver.newton
    good = [i for i, record in enumerate(simulation.records) if record.converged]
    steps = sum(record.iterations for record in simulation.records)
    calls = sum(record.evaluations for record in simulation.records)
    if good:
        say(
            f"largest residual {scaled[good].max():.2g} of its tolerance ({newton.force_tolerance:g} N, "
            f"{newton.moment_tolerance:g} Nm); {steps} Newton steps, {calls} evaluations"
        )
    if any(contact.kind in ("surrogate", "hybrid") for contact in contacts):
        say(f"least trust {min(record.least_trust for record in simulation.records):.2f}")
    for contact in contacts:
        if contact.kind == "hybrid":
            calls = getattr(contact.contact.model, "reference_calls", 0)
            say(f"{contact.contact.name}: {calls} evaluations were the reference's")
    if muscles.reserve_moment > 0 and good and simulation.reserves.size:
        used = np.abs(simulation.reserves[good])
        frame, k = np.unravel_index(int(used.argmax()), used.shape)
        say(
            f"largest reserve {used[frame, k]:.3g} Nm on {simulation.balanced[int(k)]} at "
            f"{simulation.times[good[int(frame)]]:g} s (of {muscles.reserve_moment:g} Nm)"
        )


def tell_time(simulation: TrialSimulation, seconds: float, before: float, after: float) -> str:
    """Time by phase; returns the lines, which are no result and go to the log."""
    times = simulation.times
    by_phase = sorted(simulation.seconds().items(), key=lambda item: -item[1])
    total = sum(value for _, value in by_phase) or 1.0
    shares = ", ".join(f"{name.replace('_', ' ')} {value / total:.0%}" for name, value in by_phase)
    text = f"solved in {seconds:.2f} s, {1e3 * seconds / len(times):.2f} ms a time frame"
    if len(times) > 1:
        text += f", {(times[-1] - times[0]) / seconds:.2g} times real time"
    text += f" ({shares}); contact surfaces {before:.1f} s, pressures {after:.2f} s"
    say(text)
    return text


def tell_trouble(
    simulation: TrialSimulation,
    settings: TrialSimulationSettings,
    pressures: Mapping[str, ContactPressures],
) -> None:
    """Each kind of trouble once, with the time frames it befell, on standard error."""
    _tell_not_solved(simulation)
    records = list(zip(simulation.times.tolist(), simulation.records, strict=True))
    deep = [t for t, record in records if record.status == "implausible_depth"]
    _tell(deep, "deeper than plausible: check loads, pressure modulus and the implant's placement")
    low = settings.least_trust
    _tell(
        [t for t, record in records if record.least_trust < low],
        f"a contact model's trust is below {low:g}: widen its sampled domains, or take the reference or hybrid contact",
    )
    _tell(
        [t for t, record in records if record.converged and not record.sharing_settled],
        "in equilibrium, but how muscles share load had not quite settled",
    )
    newton = settings.solver.newton
    _tell(
        [
            t
            for t, record in records
            if record.attainable[0] > newton.force_tolerance
            or record.attainable[1] > newton.moment_tolerance
        ],
        "a tolerance is below what rounding leaves (record.csv: attainable): raise it",
    )
    for name, found in pressures.items():
        beyond = found.border_area.sum(axis=1) > 0.0
        _tell(
            simulation.times[beyond].tolist(),
            f"{name}: overlap beyond a surface's open border is left out (up to "
            f"{1e6 * found.border_area.max():.3g} mm²)",
        )


def _tell_not_solved(simulation: TrialSimulation) -> None:
    """Time frames that are not in equilibrium, by what is to be done about them."""
    if simulation.converged:
        return
    warn(
        f"not in equilibrium: {simulation.not_converged} of {_counted(len(simulation.times))}; the best that was "
        "found is written:"
    )
    kinds: dict[str, list[str]] = {}
    for time, record in zip(simulation.times, simulation.records, strict=True):
        if not record.converged:
            advice, _, rest = record.message.partition("; ")
            kinds.setdefault(advice, []).append(f"{time:g} s: {rest}")
    for advice, frames in kinds.items():
        warn(advice)
        for text in frames[:_SHOWN]:
            warn(f"  {text}")
        if len(frames) > _SHOWN:
            warn(f"  and {len(frames) - _SHOWN} more")


def _tell(times: Sequence[float], what: str) -> None:
    if times:
        shown = ", ".join(f"{t:g}" for t in times[:_SHOWN])
        more = f" and {len(times) - _SHOWN} more" if len(times) > _SHOWN else ""
        warn(f"{_counted(len(times))}: {what}: {shown}{more} s")
