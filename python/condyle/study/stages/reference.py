# SPDX-License-Identifier: Apache-2.0
"""Stage ``reference``: the study's activities simulated with the reference contact.

They are the reference curves that the sampled domains are drawn around, and what the surrogate is compared with.
A load case that does not converge ends the study, naming time frame and coordinate. Of a trial, time frames may
fail: they are kept, said, and left out of what follows.
"""

from pathlib import Path
from typing import Any

import condyle
from condyle.study.context import StudyContext
from condyle.study.simulation_files import write_simulation


def run(context: StudyContext) -> bool:
    """Simulates every activity."""
    inputs = {
        **context.study.canonical("contact", "simulator"),
        **muscle_settings(context),
        "implant": context.outputs_of("implant"),
        "activities": context.activity_digests(),
        "version": condyle.__version__,
    }

    def work() -> list[Path]:
        context.reporter.stage("reference", "building the contact model")
        seconds, phases = {}, {}
        unconverged: list[dict[str, str | float]] = []
        made = []
        error = context.reference.fast_error
        if error is not None:
            made.append(context.directory.write_table("fast_error", error.to_json()))
        for i, (name, activity) in enumerate(context.activities.items()):
            context.reporter.progress("simulating", i / len(context.activities), name)
            outcome = activity.simulate(context.reference, "reference")
            seconds[name], phases[name] = outcome.seconds, outcome.phases
            unconverged += outcome.unconverged(name, "reference")
            file = context.directory.simulations / f"{name}_reference.csv"
            write_simulation(file, outcome.simulated)
            made += [file, *outcome.files]
        made += [
            context.directory.write_table("reference_seconds", seconds),
            context.directory.write_table("reference_phases", phases),
            context.directory.write_table("reference_unconverged", unconverged),
        ]
        told = [", ".join(f"{name} in {s:.1f} s" for name, s in seconds.items())]
        if error is not None:
            told.append(error.sentence())
        context.reporter.finished("reference", "; ".join(told))
        return made

    return context.directory.run_stage("reference", inputs, work)


def muscle_settings(context: StudyContext) -> dict[str, Any]:
    """How the muscles of a body share load, for hashing; nothing where there is no body."""
    section = context.study.body
    if section is None:
        return {}
    names = {"femur", "insert", "patella", "criterion", "strength", "reserve_Nm"}
    return {"body": section.model_dump(mode="json", include=names)}
