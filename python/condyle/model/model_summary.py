# SPDX-License-Identifier: Apache-2.0
"""What a model holds, and what of it may surprise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from condyle._core.fdk import wraps_ignored
from condyle.model.musculoskeletal_model import MusculoskeletalModel
from condyle.model.surface_files import surface_files
from condyle.model.trial import make_trial
from condyle.model.trial_analysis import analyse_trial

#: A muscle or a coordinate whose largest moment arm is below this has none [m, -].
_NO_ARM = 1e-6
#: A muscle weaker than this part of its maximum isometric force has no strength.
_WEAK = 1e-3


@dataclass(frozen=True)
class ModelSummary:
    """What :func:`summarise` finds.

    Attributes:
        name: of the model.
        source: what it was made from, in words.
        counts: of every list, by its key in the model file.
        total_mass: [kg].
        balanced_by_muscles: names of coordinates.
        force_dependent: likewise.
        locked: likewise.
        coupled: coordinates that follow another.
        wraps_passed_by: paths past surfaces that are not computed, in words: they need path snapshots.
        meshes_missing: contact surfaces without a file beside the model's.
        not_supported: what an importer left out, in words.
        findings: what may not be meant, in words; at the default posture.
    """

    name: str
    source: str
    counts: dict[str, int]
    total_mass: float
    balanced_by_muscles: tuple[str, ...]
    force_dependent: tuple[str, ...]
    locked: tuple[str, ...]
    coupled: tuple[str, ...]
    wraps_passed_by: tuple[str, ...]
    meshes_missing: tuple[str, ...]
    not_supported: tuple[str, ...]
    findings: tuple[str, ...]


def summarise(model: MusculoskeletalModel) -> ModelSummary:
    """Counts, roles and findings."""
    core = model.core
    locked = zip(model.coordinate_names, core.coordinate_is_locked, strict=True)
    with_files = surface_files(model)
    balanced = model.balanced_by_muscles
    return ModelSummary(
        name=model.name,
        source=core.description.provenance,
        counts={
            "bodies": len(model.body_names),
            "joints": len(core.joint_names),
            "coordinates": len(model.coordinate_names),
            "couplings": len(core.coupled_coordinates),
            "springs": len(core.sprung_coordinates),
            "muscles": len(model.muscle_names),
            "ligaments": len(model.ligament_names),
            "wraps": len(core.wrap_names),
            "markers": len(core.marker_names),
            "contact_surfaces": len(core.contact_surface_names),
            "contact_pairs": len(core.contact_pair_names),
        },
        total_mass=float(sum(core.masses)),
        balanced_by_muscles=balanced,
        force_dependent=model.force_dependent,
        locked=tuple(name for name, is_locked in locked if is_locked),
        coupled=tuple(core.coupled_coordinates),
        wraps_passed_by=tuple(wraps_ignored(core)),
        meshes_missing=tuple(n for n in core.contact_surface_names if n not in with_files),
        not_supported=model.not_supported,
        findings=_findings(model, balanced),
    )


def _findings(model: MusculoskeletalModel, balanced: tuple[str, ...]) -> tuple[str, ...]:
    """What recruitment would trip over."""
    trial = make_trial(model, np.zeros(1), model.default_q()[None])
    found = analyse_trial(model, trial, recruitment=False, ligaments=False, threads=1)
    sentences: list[str] = []
    if model.muscle_names:
        arms = np.abs(found.moment_arms[0])
        rows = [model.coordinate(name) for name in balanced]
        helpless = [
            name for name, row in zip(balanced, rows, strict=True) if arms[row].max() < _NO_ARM
        ]
        idle = [
            name
            for name, column in zip(model.muscle_names, arms.T, strict=True)
            if column[rows].max(initial=0.0) < _NO_ARM
        ]
        maxima = np.array(model.core.muscle_max_forces)
        weak = np.flatnonzero(found.muscle_strengths[0] < _WEAK * maxima)
        _say(sentences, "balanced by muscles, but none has a moment arm", helpless)
        if balanced:
            _say(sentences, "muscles without a moment arm on what they balance", idle)
        _say(
            sentences,
            "muscles without strength (fibres too short or too long)",
            [model.muscle_names[int(i)] for i in weak],
        )
    elif balanced:
        _say(sentences, "balanced by muscles, but the model has none", list(balanced))
    return tuple(sentences)


def _say(sentences: list[str], what: str, names: list[str]) -> None:
    if names:
        sentences.append(f"{what}: {', '.join(names)}")
