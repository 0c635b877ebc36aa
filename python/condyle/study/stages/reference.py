# SPDX-License-Identifier: Apache-2.0
"""Stage ``reference``: the study's activities simulated with the reference contact.

They are the reference curves that the sampled domains are drawn around, and what the surrogate is compared with.
"""

import time
from pathlib import Path

import condyle
from condyle.study.context import StudyContext
from condyle.study.simulate import require_converged, simulate
from condyle.study.simulation_files import write_simulation


def run(context: StudyContext) -> bool:
    """Simulates every activity; fails, naming time frame and coordinate, if one does not converge."""
    inputs = {
        **context.study.canonical("contact", "simulator"),
        "implant": context.outputs_of("implant"),
        "activities": context.activity_digests(),
        "version": condyle.__version__,
    }

    def work() -> list[Path]:
        context.reporter.stage("reference", "building the contact model")
        seconds = {}
        made = []
        error = context.reference.fast_error
        if error is not None:
            made.append(context.directory.write_table("fast_error", error.to_json()))
        for i, (name, load_case) in enumerate(context.load_cases.items()):
            context.reporter.progress("simulating", i / len(context.load_cases), name)
            start = time.perf_counter()
            simulation = simulate(context.reference, load_case, context)
            seconds[name] = time.perf_counter() - start
            file = context.directory.simulations / f"{name}_reference.csv"
            write_simulation(file, simulation)
            require_converged(name, simulation)
            made.append(file)
        made.append(context.directory.write_table("reference_seconds", seconds))
        told = [", ".join(f"{name} in {s:.1f} s" for name, s in seconds.items())]
        if error is not None:
            told.append(error.sentence())
        context.reporter.finished("reference", "; ".join(told))
        return made

    return context.directory.run_stage("reference", inputs, work)
