# SPDX-License-Identifier: Apache-2.0
"""Medial and lateral contact force of an instrumented knee in two gait trials, beside what it measured.

    OMP_NUM_THREADS=1 .venv/bin/python tests/benchmarks/jw_contact_forces.py

Subject JW of the 4th Grand Challenge Competition to Predict In Vivo Knee Loads (CONDYLE_DATA, or shared/data beside the
project). `condyle.fdk.solve_given_loads` on inverse dynamics without contact forces, moment arms, knee flexion and
the implant; strengths and ligaments are another subject's (DM), scaled by the rules below. The measurement is read for
scoring only. No parameter is fitted: the first case of a trial's table is the prediction, the others show what
single assumptions weigh. Time frames that do not converge are scored as they are.

Rules
- strengths: DM's maximal isometric forces times (JW's mass / DM's mass)^(2/3), at every length and velocity;
- recruitment: sum of cubed activities over hip (3), knee, ankle and subtalar coordinates;
- ligaments: DM's eight bundles seen from its implant, attachments times the ratio of the inserts' widths, stiffness per
  strain times its square, reference strains as DM's, at JW's seated pose in extension;
- restraint: eight straight bundles leave sliding and turning nearly free in a knee without an anterior cruciate
  ligament. For what else is there (wrapping, capsule, iliotibial band, friction) stands the library's default of knee
  simulators, 30 N/mm along x and 0.6 Nm/deg about y, about the seated pose. It has no part in the axial force and
  the adduction moment;
- contact: the default pressure modulus.
"""

from __future__ import annotations

import json
import os
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from condyle._core.fdk import ligament_length
from condyle.contact import MeshContact
from condyle.fdk import (
    GivenLoadsSimulation,
    Ligament,
    RestraintSprings,
    default_ligaments,
    seated_pose,
    solve_given_loads,
)
from condyle.recruitment import Criterion

Floats = NDArray[np.float64]
Case = tuple[list[Ligament], RestraintSprings | None, Criterion, str | None]
DATA = Path(os.environ.get("CONDYLE_DATA", Path(__file__).parents[3] / "shared" / "data"))
JW = DATA / "subjects" / "jw"
MASS_JW, MASS_DM = 66.0, 69.98  # [kg]
WIDTH_JW, WIDTH_DM = 76.2, 79.2  # of the inserts [mm]
BALANCED = (
    "hip_flexion",
    "hip_adduction",
    "hip_rotation",
    "knee_flexion",
    "ankle_angle",
    "subtalar_angle",
)
#: x, y, z, θx, θy of the pose by the trial's knee coordinates, and their signs: its axes are x posterior, z medial,
#: and its angles R_TF = Rx(a) Ry(b) Rz(c); so R_TF = Rx(-a) Ry(b) Rz(-c) in ours: θx = a, θy = -b, θz = c.
SECONDARY = (
    ("knee_tx", -1.0),
    ("knee_ty", 1.0),
    ("knee_tz", -1.0),
    ("knee_adduction", 1.0),
    ("knee_rotation", -1.0),
)
#: Root-mean-square errors of the challenges' winners [N].
WINNERS = {"medial": "229–312", "lateral": "238–326"}


@dataclass(frozen=True)
class Trial:
    """Input of one trial over (t,) time frames, and what is known about the muscles."""

    time: Floats
    flexion: Floats
    loads: Floats
    moment_arms: Floats
    secondary_loads: Floats
    secondary_arms: Floats
    strengths: Floats
    muscles: list[str]


def table(path: Path) -> dict[str, Floats]:
    """Columns of a CSV file by name."""
    values = np.genfromtxt(path, delimiter=",", names=True, deletechars="")
    return {name: values[name] for name in values.dtype.names or ()}


def read_trial(name: str) -> Trial:
    """Reads the input; never the measurement."""
    folder = JW / "gait_processed" / name
    dynamics = table(folder / "inverse_dynamics_without_contact_forces.csv")
    kinematics = table(folder / "kinematics.csv")
    with np.load(folder / "moment_arms.npz") as arms:
        instants, r = arms["time"], arms["r"]
        coordinates = [str(c) for c in arms["coordinates"]]
        muscles = [str(m) for m in arms["muscles"]]
    of = {c: r[:, coordinates.index(c)] for c in coordinates}
    dm = json.loads((DATA / "subjects" / "dm" / "dm_model_summary.json").read_text())
    force = {m["name"]: m["max_isometric_force"] for m in dm["muscles"]}
    scale = (MASS_JW / MASS_DM) ** (2.0 / 3.0)
    return Trial(
        time=instants,
        # Flexion is negative in the trial.
        flexion=-np.interp(instants, kinematics["time"], kinematics["knee_flexion"]),
        loads=np.stack([dynamics[c] for c in BALANCED], axis=1),
        moment_arms=np.stack([of[c] for c in BALANCED], axis=1),
        secondary_loads=np.stack([sign * dynamics[c] for c, sign in SECONDARY], axis=1),
        secondary_arms=np.stack([sign * of[c] for c, sign in SECONDARY], axis=1),
        strengths=np.array([scale * force[f"{m}_r"] for m in muscles]),
        muscles=muscles,
    )


def scaled_ligaments(contact: MeshContact) -> list[Ligament]:
    """DM's bundles on JW's implant."""
    seat = seated_pose(contact, 0.0)
    assert seat.converged, seat.advice
    ratio = WIDTH_JW / WIDTH_DM
    ligaments = []
    for bundle in default_ligaments("right", seat.pose):
        strain = ligament_length(bundle, seat.pose) / bundle.slack_length - 1.0
        bundle.p_FoA_F = np.asarray(bundle.p_FoA_F) * ratio
        bundle.p_ToB_T = np.asarray(bundle.p_ToB_T) * ratio
        bundle.stiffness *= ratio**2
        bundle.slack_length = ligament_length(bundle, seat.pose) / (1.0 + strain)
        ligaments.append(bundle)
    return ligaments


def seated_restraint(contact: MeshContact) -> RestraintSprings:
    """The default springs of knee simulators about the seated pose in extension."""
    seat = seated_pose(contact, 0.0).pose
    springs = RestraintSprings()
    springs.reference_x, springs.reference_z = float(seat[0]), float(seat[2])
    springs.reference_theta_y = 0.0
    return springs


def measured(name: str, instants: Floats) -> tuple[str, Floats]:
    """Medial and lateral axial force (t, 2) [N], compression positive, and where it is from. For scoring."""
    loads = JW / "knee_loads"
    if (path := loads / f"jw_{name}_etibia.csv").exists():
        cells = table(path)
        sides, source = [cells["F_medial_N"], cells["F_lateral_N"]], "load cells"
    else:
        cells = table(loads / f"jw_{name}_contact_loads.csv")
        sides, source = [-cells["medial_Fy_N"], -cells["lateral_Fy_N"]], "published contact loads"
    return source, np.stack([np.interp(instants, cells["time"], s) for s in sides], axis=1)


def predict(
    contact: MeshContact,
    trial: Trial,
    ligaments: list[Ligament],
    restraint: RestraintSprings | None,
    criterion: Criterion = 3.0,
    knee: str | None = "knee_flexion",
) -> GivenLoadsSimulation:
    """Equilibria of all time frames."""
    return solve_given_loads(
        contact,
        "right",
        flexion=trial.flexion,
        loads=trial.loads,
        moment_arms=trial.moment_arms,
        strengths=trial.strengths,
        secondary_arms=trial.secondary_arms,
        secondary_loads=trial.secondary_loads,
        knee_coordinate=knee,
        knee_counts_flexion=False,
        ligaments=ligaments,
        restraint=restraint,
        criterion=criterion,
        coordinate_names=BALANCED,
        muscle_names=trial.muscles,
    )


def score(truth: Floats, found: Floats) -> str:
    """RMS error [N], 1 − SSE/SST and the squared correlation."""
    rms = float(np.sqrt(np.mean((found - truth) ** 2)))
    explained = 1.0 - np.sum((found - truth) ** 2) / np.sum((truth - truth.mean()) ** 2)
    return f"{rms:.0f} | {explained:.2f} | {np.corrcoef(truth, found)[0, 1] ** 2:.2f}"


def main() -> None:
    """Prints a table a trial."""
    implant = DATA / "implants" / "jw"
    contact = MeshContact.from_files(
        femur=implant / "femur_contact.stl",
        insert_medial=implant / "insert_contact_medial.stl",
        insert_lateral=implant / "insert_contact_lateral.stl",
        units="m",
        side_of_body="right",
        evaluation="fast",
    )
    ligaments, springs = scaled_ligaments(contact), seated_restraint(contact)
    print(f"winners of the blinded challenges, RMS error N: {WINNERS}; R² up to 0.91 and 0.70")
    for name in ("ngait_og1", "ngait_og3"):
        trial = read_trial(name)
        source, truth = measured(name, trial.time)
        print(f"\n{name}, scored against {source}; peaks {truth.max(axis=0).round()} N\n")
        print("| case | converged | ms a frame | side | peak N | RMS N | R² | correlation² |")
        print("|---|---|---|---|---|---|---|---|")
        cases: dict[str, Case] = {
            "prediction": (ligaments, springs, 3.0, "knee_flexion"),
            "ligaments alone": (ligaments, None, 3.0, "knee_flexion"),
            "restraint alone": ([], springs, 3.0, "knee_flexion"),
            "squared activities": (ligaments, springs, 2.0, "knee_flexion"),
            "min-max": (ligaments, springs, "min_max", "knee_flexion"),
            "contact does no work in flexion": (ligaments, springs, 3.0, None),
        }
        for case, (bundles, restraint, criterion, knee) in cases.items():
            begun = time.perf_counter()
            found = predict(contact, trial, bundles, restraint, criterion, knee)
            each = 1e3 * (time.perf_counter() - begun) / len(trial.time)
            good = np.isin(found.status, ("converged", "implausible_depth"))
            forces = found.wrenches[:, :, 1]
            columns = {"medial": forces[:, 0], "lateral": forces[:, 1], "total": forces.sum(axis=1)}
            wanted = {"medial": truth[:, 0], "lateral": truth[:, 1], "total": truth.sum(axis=1)}
            for side, column in columns.items():
                print(
                    f"| {case} | {good.sum()}/{len(good)} | {each:.1f} | {side} | "
                    f"{column.max():.0f} | {score(wanted[side], column)} |"
                )


if __name__ == "__main__":
    main()
