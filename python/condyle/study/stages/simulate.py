# SPDX-License-Identifier: Apache-2.0
"""Stage ``simulate``: the study's activities with the surrogate, compared with the reference's."""

import time
from pathlib import Path
from typing import Any

import condyle
from condyle.evaluation import kinematics_error_table, simulation_load_error_table
from condyle.study.context import StudyContext
from condyle.study.simulate import require_converged, simulate
from condyle.study.simulation_files import read_simulation, write_simulation


def run(context: StudyContext) -> bool:
    """Simulates with the surrogate and writes the error and time tables."""
    from condyle.surrogate import load_surrogate

    inputs = {
        "surrogate": context.outputs_of("train"),
        "reference": context.outputs_of("reference"),
        "version": condyle.__version__,
    }

    def work() -> list[Path]:
        context.reporter.stage("simulate", ", ".join(context.load_cases))
        model = load_surrogate(context.directory.surrogate)
        reference_seconds = context.directory.read_table("reference_seconds")
        loads: list[dict[str, Any]] = []
        kinematics: list[dict[str, Any]] = []
        times: list[dict[str, Any]] = []
        made = []
        for i, (name, load_case) in enumerate(context.load_cases.items()):
            context.reporter.progress("simulating", i / len(context.load_cases), name)
            start = time.perf_counter()
            simulation = simulate(model, load_case, context)
            seconds = time.perf_counter() - start
            file = context.directory.simulations / f"{name}_surrogate.csv"
            write_simulation(file, simulation)
            require_converged(name, simulation)
            made.append(file)
            known = read_simulation(context.directory.simulations / f"{name}_reference.csv")
            loads += simulation_load_error_table(name, known["wrenches"], simulation.wrenches)
            kinematics += kinematics_error_table(name, known["kinematics"], simulation.kinematics)
            times.append(
                {
                    "what": f"{name}, {len(simulation.time)} time frames",
                    "reference_s": reference_seconds[name],
                    "surrogate_s": seconds,
                }
            )
        for table, rows in (
            ("simulation_loads", loads),
            ("simulation_kinematics", kinematics),
            ("times", times),
        ):
            made.append(context.directory.write_table(table, rows))
        worst = {
            u: max(r["rmse"] for r in (*loads, *kinematics) if r["unit"] == u)
            for u in ("N", "Nm", "mm", "deg")
        }
        context.reporter.finished(
            "simulate",
            "worst RMSE " + ", ".join(f"{value:.3g} {unit}" for unit, value in worst.items()),
        )
        return made

    return context.directory.run_stage("simulate", inputs, work)
