# SPDX-License-Identifier: Apache-2.0
"""What ``condyle model`` says on the screen: of a model, and of what an analysis left out or did not find."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from condyle.cli.console import console, errors

if TYPE_CHECKING:
    from condyle.model import (
        HingedPatella,
        JointSurfaces,
        ModelSummary,
        MusculoskeletalModel,
        Trial,
        TrialAnalysis,
    )

#: Names of a group, or time frames, that the screen shows; files have them all.
_SHOWN = 8


def say(text: str) -> None:
    """One line on standard output, as it is."""
    console.print(text, highlight=False, markup=False, soft_wrap=True)


def _clipped(names: tuple[str, ...] | list[str]) -> str:
    if len(names) <= _SHOWN:
        return ", ".join(names) or "none"
    return f"{', '.join(names[:_SHOWN])} and {len(names) - _SHOWN} more"


def tell_summary(file: Path, found: ModelSummary) -> None:
    """What a model holds, who balances what, and what may not be meant."""
    words = {"ligaments": "ligament strands", "wraps": "wrapping surfaces"}
    counts = [
        f"{n} {words.get(what, what.replace('_', ' '))}" for what, n in found.counts.items() if n
    ]
    say(f"{file}: model {found.name!r}" + (f" from {found.source}" if found.source else ""))
    say(f"{', '.join(counts)}; {found.total_mass:.4g} kg")
    say(f"balanced by muscles: {', '.join(found.balanced_by_muscles) or 'none'}")
    say(f"force-dependent: {', '.join(found.force_dependent) or 'none'}")
    for title, coordinates in (("locked", found.locked), ("follow another", found.coupled)):
        if coordinates:
            say(f"{title}: {', '.join(coordinates)}")
    if found.wraps_passed_by:
        owners = sorted({text.split("'")[1] for text in found.wraps_passed_by})
        say(
            f"past surfaces that need path snapshots (condyle opensim paths): {len(owners)} paths: "
            + _clipped(owners)
        )
    if found.meshes_missing:
        say(f"contact surfaces without their file here: {', '.join(found.meshes_missing)}")
    if found.not_supported:
        say("left out or changed when it was made:")
    for sentence in found.not_supported:
        reason, _, names = sentence.rpartition(": ")
        say(f"  - {reason}: {_clipped(names.split(', '))}" if reason else f"  - {names}")
    for sentence in found.findings:
        reason, _, names = sentence.rpartition(": ")
        say(f"look at: {reason}: {_clipped(names.split(', '))}")


def tell_passed_by(texts: tuple[str, ...], *, given: bool) -> None:
    """Wrapping surfaces that paths went by without touching them."""
    if texts:
        owners = sorted({text.split("'")[1] for text in texts})
        say(
            f"{len(owners)} paths go straight past wrapping surfaces that are not computed"
            + (" and not in --paths: " if given else " (--paths): ")
            + _clipped(owners)
        )


def tell_force_dependent(model: MusculoskeletalModel, trial: Trial) -> None:
    """Coordinates that a simulation would find, and an analysis takes as they are."""
    if model.force_dependent:
        say(
            f"{len(model.force_dependent)} force-dependent coordinates are where the motion has them: "
            "their residuals are what contact would have to give"
        )
    if trial.at_default:
        say(f"without a column, at their default: {', '.join(trial.at_default)}")


def tell_hinge(file: Path, joint: JointSurfaces, hinged: HingedPatella) -> None:
    """The hinge and what it was fitted to, the patella at rest on it, its ligament."""
    fit, seat, coordinates = hinged.trochlea.cylinder, hinged.seat, hinged.coordinates
    axis, centre = (", ".join(f"{x:.4f}" for x in v) for v in (fit.axis, 1e3 * fit.centre))
    say(f"{file}: {joint.patella} on a hinge of {joint.femur}, {coordinates.turn} turns about it")
    say(
        f"cylinder fitted to {fit.points} faces of the trochlea over {math.degrees(fit.arc):.1f}°: radius "
        f"{1e3 * fit.radius:.2f} mm, RMS {1e3 * fit.rms:.3f} mm, largest distance {1e3 * fit.largest:.2f} mm"
    )
    say(f"its axis, in the mesh's frame: ({axis}) through ({centre}) mm")
    say(
        f"at rest the button is seated in the groove: {1e3 * seat.along:.2f} mm along the axis and "
        f"{1e3 * seat.inwards:.2f} mm towards it from the default posture; over 60° of flexion it is up to "
        f"{1e3 * seat.overlap:.2f} mm in the trochlea and {1e3 * seat.gap:.2f} mm off it"
    )
    say(
        f"patellar ligament {hinged.ligament.name}: {hinged.stiffness:g} N/m, slack length "
        f"{1e3 * hinged.slack_length:.2f} mm, in the place of {len(hinged.ligament.strands)} strands"
    )
    say(f"follow {coordinates.turn} and move nothing: {', '.join(coordinates.followers)}")
    if hinged.contact_pairs:
        say(f"contact left out: {', '.join(hinged.contact_pairs)}")
    say("the patella's mass is on the femur")


def tell_failed(found: TrialAnalysis) -> int:
    """Time frames whose muscle forces are none; how many. What they have in common is said once."""
    from condyle.model import failed_frames

    bad = failed_frames(found)
    if not bad:
        return 0
    warn(f"muscle forces were not found at {len(bad)} of {len(found.times)} time frames:")
    causes: dict[str, list[str]] = {}
    for i in bad:
        cause, not_met, rest = found.messages[i].partition("Not met: ")
        causes.setdefault(cause.strip(), []).append(
            f"{found.times[i]:g} s: {not_met}{rest}".strip()
        )
    for cause, frames in causes.items():
        warn(cause)
        for text in frames[:_SHOWN]:
            warn(f"  {text}")
        if len(frames) > _SHOWN:
            warn(f"  and {len(frames) - _SHOWN} more")
    return len(bad)


def warn(text: str) -> None:
    """One line on standard error, as it is."""
    errors.print(text, highlight=False, markup=False, soft_wrap=True)
