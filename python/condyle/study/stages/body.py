# SPDX-License-Identifier: Apache-2.0
"""Stage ``body``: the model of the body, and what its trials need that is not recorded: coordinates, paths.

An .osim is imported, markers become coordinates, and paths on ellipsoids become snapshots, all by the package
``opensim``. A model file and recorded coordinates need none of it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import condyle
from condyle.errors import InputDataError
from condyle.study.body import StudyBody
from condyle.study.body_sections import BodySection, TrialSection
from condyle.study.context import StudyContext
from condyle.study.run_directory import digest_of_file
from condyle.whole_files import write_whole

#: Markers are followed for so long before and after a trial's window: a filter needs a run-up [s].
_RUN_UP_S: Final = 0.5


def run(context: StudyContext) -> bool:
    """Makes the files."""
    study, body = context.study, context.body
    _require_files("body", body.section)
    for name, trial in study.trials.items():
        _require_files(f"trials.{name}", trial)
    section = body.section
    inputs = {
        "model": digest_of_file(section.model),
        "roles": [section.force_dependent, section.muscles],
        "trials": {name: _trial_inputs(section, trial) for name, trial in study.trials.items()},
        "version": condyle.__version__,
    }

    def work() -> list[Path]:
        context.reporter.stage("body", f"{body.section.model.name}, {', '.join(study.trials)}")
        body.folder.mkdir(parents=True, exist_ok=True)
        told = [_make_model(body)]
        made = [body.model_file]
        for name, trial in study.trials.items():
            if trial.markers is not None:
                told.append(_follow_markers(context, name, trial))
                made.append(body.motion_file(name, trial))
            if body.section.imported and trial.paths is None:
                _hold_paths(context, name, trial)
                made.append(body.folder / name / "paths.json")
        context.reporter.finished("body", "; ".join(told))
        return made

    return context.directory.run_stage("body", inputs, work)


def _require_files(label: str, section: BodySection | TrialSection) -> None:
    """Raises InputDataError naming the key of a file that is not there."""
    for key in type(section).model_fields:
        file = getattr(section, key)
        if isinstance(file, Path) and not file.is_file():
            raise InputDataError(f"{label}.{key}: {file}: no such file")


def _trial_inputs(body: BodySection, trial: TrialSection) -> dict[str, Any]:
    """What decides a trial's files that are made here: nothing else starts inverse kinematics again."""
    inputs: dict[str, Any] = {}
    if trial.markers is not None:
        files = {
            "ik_model": body.ik_model or body.model,
            "markers": trial.markers,
            "marker_weights": trial.marker_weights,
        }
        inputs |= {what: digest_of_file(file) for what, file in files.items() if file is not None}
        inputs["window"] = [trial.start_s, trial.end_s, trial.filter_hz]
    if body.imported and trial.paths is None:
        inputs["paths_of"] = "markers" if trial.motion is None else digest_of_file(trial.motion)
    return inputs


def _make_model(body: StudyBody) -> str:
    section = body.section
    if not section.imported:
        from condyle.model import MusculoskeletalModel

        MusculoskeletalModel.read(
            section.model
        )  # says what is wrong with the user's file, not with the copy
        write_whole(body.model_file, section.model.read_bytes())
        return f"{section.model.name} as it is"
    from condyle.opensim import import_model, summary, write_model

    content = import_model(
        section.model, force_dependent=section.force_dependent, muscles=section.muscles
    )
    write_model(body.model_file, content)
    return summary(content)


def _follow_markers(context: StudyContext, name: str, trial: TrialSection) -> str:
    from condyle.opensim import inverse_kinematics, write_coordinates

    section = context.body.section
    assert trial.markers is not None
    result = inverse_kinematics(
        section.ik_model or section.model,
        trial.markers,
        weights=trial.marker_weights,
        filter_hz=trial.filter_hz,
        start=None if trial.start_s is None else trial.start_s - _RUN_UP_S,
        end=None if trial.end_s is None else trial.end_s + _RUN_UP_S,
        progress=lambda done, of: context.reporter.progress(
            "inverse kinematics", done / of, f"{name}, {done} of {of} time frames"
        ),
    )
    file = context.body.motion_file(name, trial)
    file.parent.mkdir(parents=True, exist_ok=True)
    write_coordinates(file, result)
    return f"{name}: markers within {1e3 * float(result.rms.mean()):.0f} mm RMS, {result.filter_in_words}"


def _hold_paths(context: StudyContext, name: str, trial: TrialSection) -> None:
    from condyle.opensim import path_snapshots, write_snapshots

    body = context.body
    snapshots = path_snapshots(
        body.section.model,
        body.motion_file(name, trial),
        progress=lambda done, of: context.reporter.progress(
            "paths", done / of, f"{name}, {done} of {of} time frames"
        ),
    )
    file = body.folder / name / "paths.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    write_snapshots(file, snapshots)
