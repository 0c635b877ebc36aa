# SPDX-License-Identifier: Apache-2.0
"""Muscle recruitment beside a general convex solver: time, objective and forces, on random problems.

    .venv/bin/pip install -e '.[test]'
    OMP_NUM_THREADS=1 .venv/bin/python tests/benchmarks/recruitment_speed.py [PROBLEMS]

cvxpy with clarabel, told to go as far as it can; its time is with cvxpy's set-up, as its user has it. Of 1 000
problems, every criterion with and without bounds and reserves gets some 42.
"""

import itertools
import sys
import time
import warnings
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "recruitment"))
from recruitment_problems import PRICE, by_clarabel, random_problem

from condyle.recruitment import Recruiter, Reserves

CRITERIA = (1.0, 1.5, 2.0, 3.0, 5.0, "min_max")


def main(problems: int) -> None:
    warnings.simplefilter("ignore")
    cases = list(itertools.product(CRITERIA, (True, False), (True, False)))
    each = -(-problems // len(cases))
    print(
        "| criterion | bounds | reserves | µs | clarabel µs | ratio | objective | worse | forces N | KKT |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    for criterion, bounds, with_reserves in cases:
        ours, theirs, off, worse, forces_off, kkt = [], [], [], 0, [], 0.0
        for seed in range(each):
            p = random_problem(seed, with_reserves)
            n, m = p.moment_arms.shape
            reserves = Reserves(p.reserves, PRICE) if p.reserves is not None else None
            recruiter = Recruiter(n, m, criterion=criterion, upper_bounds=bounds, reserves=reserves)
            arms, loads = np.stack([p.moment_arms] * 50), np.stack([p.loads] * 50)
            start = time.perf_counter()
            recruiter.solve_series(arms, loads, p.strengths, warm_starts=False)
            ours.append((time.perf_counter() - start) / 50)
            found = recruiter.solve(p.moment_arms, p.loads, p.strengths)
            kkt = max(kkt, found.primal, found.stationarity, found.complementarity)
            start = time.perf_counter()
            objective, forces = by_clarabel(p, criterion, bounds)
            theirs.append(time.perf_counter() - start)
            off.append(found.objective / objective - 1.0)
            worse += found.objective > objective * (1.0 + 1e-8)
            forces_off.append(np.abs(found.forces - forces).max())
        mine, his = 1e6 * np.median(ours), 1e6 * np.median(theirs)
        print(
            f"| {criterion} | {bounds} | {with_reserves} | {mine:.1f} | {his:.0f} | {his / mine:.0f} | "
            f"{np.abs(off).max():.1e} | {worse} | {np.max(forces_off):.1e} | {kkt:.1e} |"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
