# SPDX-License-Identifier: Apache-2.0
"""Every time frame of a recorded gait trial of DM: the right leg's hip, knee and ankle."""

import csv
import json
import os
from pathlib import Path

import numpy as np
import pytest
from recruitment_problems import Problem, by_clarabel

from condyle.recruitment import Recruiter, Reserves

DATA = Path(os.environ.get("CONDYLE_DATA", Path(__file__).parents[4] / "shared" / "data"))
TRIAL = DATA / "subjects" / "dm" / "oracles" / "DM_ngait_og1"
COORDINATES = (
    "hip_flex_r",
    "hip_add_r",
    "hip_rot_r",
    "knee_flex_r",
    "ankle_flex_r",
    "subt_angle_r",
)
#: The model's patella is free, so that the quadriceps act on pf_* and not on the knee: their pull reaches the tibia
#: through the patellar ligament, about 45 mm ahead of the knee's axis.
QUADRICEPS = ("recfem_r", "vasint_r", "vaslat_r", "vasmed_r")
PATELLAR_ARM = 0.045  # m; knee_flex_r is positive in flexion


def table(name: str) -> tuple[list[str], np.ndarray]:
    with (TRIAL / name).open() as file:
        rows = list(csv.reader(file))
    return rows[0], np.array(rows[1:], dtype=np.float64)


@pytest.fixture(scope="module")
def trial() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Moment arms (t, 6, 44), loads (t, 6), strengths (44,)."""
    if not TRIAL.exists():
        pytest.skip("no trial of DM (set CONDYLE_DATA, or put shared/data beside the project)")
    summary = json.loads((DATA / "subjects/dm/dm_model_summary.json").read_text())
    muscles = {m["name"]: float(m["max_isometric_force"]) for m in summary["muscles"]}
    arm_names, arms = table("moment_arms.csv")
    load_names, loads = table("inverse_dynamics.csv")
    where = {name: k for k, name in enumerate(arm_names)}
    found = np.zeros((len(arms), len(COORDINATES), len(muscles)))
    for j, coordinate in enumerate(COORDINATES):
        for i, muscle in enumerate(muscles):
            column = where.get(f"{muscle}|{coordinate}")
            if column is not None:
                found[:, j, i] = arms[:, column]
    for i, muscle in enumerate(muscles):
        if muscle in QUADRICEPS:
            found[:, COORDINATES.index("knee_flex_r"), i] = -PATELLAR_ARM
    taken = loads[:, [load_names.index(c) for c in COORDINATES]]
    return found, taken, np.array(list(muscles.values()))


@pytest.mark.parametrize("criterion", [1.0, 1.5, 2.0, 3.0, 5.0, "min_max"])
def test_every_time_frame_satisfies_the_optimality_conditions(trial, criterion) -> None:
    arms, loads, strengths = trial
    recruiter = Recruiter(
        6,
        len(strengths),
        criterion=criterion,
        reserves=Reserves(10.0, 100.0),
        coordinate_names=COORDINATES,
    )
    found = recruiter.solve_series(arms, loads, strengths)
    assert found.converged.all(), [m for m in found.message if m][:3]
    assert found.kkt.max() <= 1e-9
    given = np.einsum("tnm,tm->tn", arms, found.forces) + found.reserves
    # Loads of 100 Nm.
    np.testing.assert_allclose(given, loads, rtol=0, atol=1e-9)


def test_time_frames_against_an_independent_solver(trial) -> None:
    pytest.importorskip("cvxpy")
    pytest.importorskip("clarabel")
    arms, loads, strengths = trial
    recruiter = Recruiter(6, len(strengths), criterion=2.0, reserves=Reserves(10.0, 5.0))
    for k in range(0, len(loads), 20):
        found = recruiter.solve(arms[k], loads[k], strengths)
        problem = Problem(arms[k], loads[k], strengths, np.full(6, 10.0))
        objective, forces = by_clarabel(problem, 2.0, True)
        assert found.objective == pytest.approx(objective, rel=1e-8)
        assert np.abs(found.forces - forces).max() <= 1e-4
