# SPDX-License-Identifier: Apache-2.0
"""What sampling costs by number of samples: time, contact evaluations and memory.

    .venv/bin/condyle demo
    .venv/bin/python tests/benchmarks/sampling_scale.py runs/demo [SAMPLES ...]

The run's implant and reference curves; the paper's six domains, each with its share of SAMPLES (1 000, 10 000 and
100 000 by default). Every size in a process of its own, into a directory that is removed. Memory is resident: of the
process when its contact is ready (libraries, meshes, distance field), and the most that sampling adds to that after
any chunk.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from condyle.contact import MeshContact
from condyle.sampling import (
    PAPER_COUNTS,
    DomainTarget,
    ReferenceCurves,
    SamplingPlan,
    SamplingProgress,
    sample,
)
from condyle.sampling.evaluate import equilibrium_solver
from condyle.study.simulation_files import read_simulation

SIZES = (1_000, 10_000, 100_000)
MIB = 2**20


def plan_of(samples: int) -> SamplingPlan:
    """The paper's plan, scaled."""
    share = samples / sum(train + test for train, test in PAPER_COUNTS.values())
    targets = (
        DomainTarget(domain, round(train * share), round(test * share))
        for domain, (train, test) in PAPER_COUNTS.items()
    )
    return SamplingPlan(tuple(targets), seed=2017)


def curves_of(run: Path) -> ReferenceCurves:
    """As the run's reference stage simulated them."""
    traces = {
        file.stem.removesuffix("_reference"): read_simulation(file)
        for file in sorted((run / "simulations").glob("*_reference.csv"))
    }
    return ReferenceCurves.from_activities(
        {name: (t["time"], t["poses"], t["wrenches"]) for name, t in traces.items()}
    )


def resident_mib() -> float:
    """Of this process, now [MiB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MIB


def measure(run: Path, samples: int) -> dict[str, float]:
    """One size, in this process."""
    identity = json.loads((run / "samples" / "manifest.json").read_text())["identity"]
    contact = MeshContact.from_files(
        femur=run / "implant" / "femur.stl",
        insert_medial=run / "implant" / "insert_medial.stl",
        insert_lateral=run / "implant" / "insert_lateral.stl",
        units="m",
        side_of_body=identity["side_of_body"],
        evaluation="fast",
        cache_directory=run / "cache",
    )
    plan = plan_of(samples)
    solver = equilibrium_solver(contact, max_depth=plan.max_depth)
    curves = curves_of(run)
    before, started = resident_mib(), time.perf_counter()
    most = before

    def watch(_: SamplingProgress | None) -> None:
        nonlocal most
        most = max(most, resident_mib())

    with tempfile.TemporaryDirectory() as folder:
        report = sample(plan, curves, solver, Path(folder), identity, watch)
    watch(None)
    table = report.to_json()
    return {
        "samples": report.samples,
        "candidates": sum(row["candidates"] for row in table["domains"]),
        "seconds": time.perf_counter() - started,
        "evaluations": table["evaluations_per_accepted"],
        "before": before,
        "added": most - before,
    }


def main() -> None:
    """Prints the table."""
    run, *sizes = sys.argv[1:]
    print(
        "| samples | candidates | wall s | samples/s | evaluations per accepted | MiB before | sampling adds MiB |"
    )
    print("|---|---|---|---|---|---|---|")
    for size in [int(text) for text in sizes] or SIZES:
        command = [sys.executable, __file__, "--one", run, str(size)]
        seen = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        print(
            f"| {seen['samples']:,} | {seen['candidates']:,} | {seen['seconds']:.1f} "
            f"| {seen['samples'] / seen['seconds']:.0f} | {seen['evaluations']:.2f} "
            f"| {seen['before']:.0f} | {seen['added']:.0f} |".replace(",", " "),
            flush=True,
        )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(Path(sys.argv[2]), int(sys.argv[3]))))
    else:
        main()
