# SPDX-License-Identifier: Apache-2.0
"""One time frame of the subject DM without contact, beside OpenSim 4.6 on the same trial in the same run.

    python tests/benchmarks/musculoskeletal_speed.py [--frames N]

OpenSim does inverse dynamics (``InverseDynamicsSolver``) and static optimisation (its tool, squared activations,
a reserve on every coordinate). Condyle does kinematics, inverse dynamics, paths, ligaments and recruitment. Both
on one core. Needs the package opensim, the shared data, and the program from ``-DCONDYLE_BENCHMARKS=ON``.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import opensim as osim
from condyle.opensim import import_model, path_snapshots, write_model, write_snapshots

ROOT = Path(__file__).parents[2]
DATA = Path(os.environ.get("CONDYLE_DATA", ROOT.parent / "shared" / "data"))
DM = DATA / "subjects" / "dm"
TRIAL = DM / "trials" / "DM_ngait_og1"
START = 2.45


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=30, help="time frames of OpenSim's part")
    parser.add_argument(
        "--program",
        type=Path,
        default=ROOT / "build/benchmarks/tests/benchmarks/benchmark_musculoskeletal_speed",
    )
    options = parser.parse_args()
    osim.Logger.setLevelString("Off")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ours = condyle_part(options.program, folder)
        inverse_dynamics = dynamics_part(options.frames)
        optimisation = optimisation_part(folder, options.frames)
    theirs = inverse_dynamics + optimisation
    print(f"  {'OpenSim 4.6: inverse dynamics':32}{1e3 * inverse_dynamics:9.2f} ms")
    print(f"  {'OpenSim 4.6: static optimisation':32}{1e3 * optimisation:9.2f} ms")
    print(f"  {'ratio, all of a time frame':32}{theirs / ours:9.0f} ×")


def condyle_part(program: Path, folder: Path) -> float:
    """Runs the C++ program on all of the trial; seconds a time frame."""
    model, paths = folder / "dm.json", folder / "paths.json"
    write_model(model, import_model(DM / "model" / "DM.osim"))
    write_snapshots(
        paths, path_snapshots(DM / "model" / "DM_stripped.osim", TRIAL / "coordinates.sto")
    )
    files = [model, TRIAL / "coordinates.sto", TRIAL / "external_loads.xml", paths]
    run = subprocess.run(
        [program, *files], check=True, capture_output=True, text=True, env={"OMP_NUM_THREADS": "1"}
    )
    print(run.stdout, end="")
    return float(run.stdout.splitlines()[-1].split()[1]) * 1e-6


def dynamics_part(frames: int) -> float:
    """OpenSim's inverse dynamics with the model's forces switched off; seconds a time frame."""
    model = osim.Model(str(DM / "model" / "DM_stripped.osim"))
    model.initSystem()
    forces = model.updForceSet()
    for i in range(forces.getSize()):
        forces.get(i).set_appliesForce(False)
    state = model.initSystem()
    solver = osim.InverseDynamicsSolver(model)
    rates = osim.Vector(state.getNU(), 0.1)
    started = time.perf_counter()
    for i in range(frames):
        model.getCoordinateSet().get("knee_flex_r").setValue(state, 0.2 + 0.01 * i, False)
        model.getCoordinateSet().get("knee_flex_r").setSpeedValue(state, 1.0)
        solver.solve(state, rates)
    return (time.perf_counter() - started) / frames


def optimisation_part(folder: Path, frames: int) -> float:
    """OpenSim's static optimisation of the first time frames of stance; seconds a time frame."""
    model = osim.Model(str(DM / "model" / "DM_stripped.osim"))
    model.initSystem()
    for coordinate in _items(model.getCoordinateSet()):
        reserve = osim.CoordinateActuator(coordinate.getName())
        reserve.setName(f"reserve_{coordinate.getName()}")
        reserve.setOptimalForce(100.0)
        reserve.setMinControl(-1e4)
        reserve.setMaxControl(1e4)
        model.addForce(reserve)
    file = folder / "with_reserves.osim"
    model.finalizeConnections()
    model.printToXML(str(file))
    tool = osim.AnalyzeTool()
    tool.setName("so")
    tool.setModelFilename(str(file))
    tool.setCoordinatesFileName(str(TRIAL / "coordinates.sto"))
    tool.setExternalLoadsFileName(str(TRIAL / "external_loads.xml"))
    tool.setLoadModelAndInput(True)
    tool.setResultsDir(str(folder / "results"))
    tool.setInitialTime(START)
    tool.setFinalTime(START + (frames - 0.5) / 120)
    analysis = osim.StaticOptimization()
    analysis.setStartTime(START)
    analysis.setEndTime(START + (frames - 0.5) / 120)
    analysis.setStepInterval(1)
    analysis.setUseModelForceSet(True)
    analysis.setActivationExponent(2)
    tool.updAnalysisSet().cloneAndAppend(analysis)
    setup = folder / "so.xml"
    tool.printToXML(str(setup))
    loaded = osim.AnalyzeTool(str(setup), True)
    started = time.perf_counter()
    loaded.run()
    elapsed = time.perf_counter() - started
    rows = osim.Storage(str(folder / "results" / "so_StaticOptimization_force.sto")).getSize()
    return elapsed / rows


def _items(collection: Any) -> list[Any]:
    return [collection.get(i) for i in range(collection.getSize())]


if __name__ == "__main__":
    main()
