# SPDX-License-Identifier: Apache-2.0
"""A surrogate off its reference curves: the simulator under restraints that sampling did not know.

    .venv/bin/python tests/benchmarks/off_curve.py runs/demo

For each change of the restraints and each built-in load case: worst RMSE of any load and of any
clinical coordinate between surrogate and reference (`fast`), and how many time frames the surrogate does not trust.
"""

import sys
from pathlib import Path

import numpy as np

from condyle.activities import BUILT_IN, load_case
from condyle.contact import MeshContact
from condyle.fdk import (
    KneeSimulatorSettings,
    RestraintSprings,
    default_ligaments,
    settled_pose,
    simulate_knee,
)
from condyle.surrogate import describe, load_surrogate

CHANGES = (
    "as sampled",
    "ligaments added",
    "2 mm medial-lateral shift",
    "4 mm AP shift",
    "4 deg rotation",
)


def settings_for(change: str, reference: MeshContact, side: str) -> KneeSimulatorSettings:
    """The demo's simulator, with one thing changed."""
    extended = settled_pose(reference, 0.0)
    x, z, theta_y = extended[[0, 2, 4]]
    springs = RestraintSprings()
    if change == "2 mm medial-lateral shift":
        z, springs.ml_stiffness = z + 2e-3, 1e5
    if change == "4 mm AP shift":
        x -= 4e-3
    if change == "4 deg rotation":
        theta_y = np.radians(4.0)
    springs.reference_x, springs.reference_z, springs.reference_theta_y = x, z, theta_y
    settings = KneeSimulatorSettings()
    settings.insert_width = reference.insert_width
    settings.restraint = springs
    settings.initial_pose = extended
    if change == "ligaments added":
        settings.ligaments = default_ligaments(side, extended)
    return settings


def main(run: Path) -> None:
    """Prints the table of one run directory."""
    surrogate = load_surrogate(run / "surrogate.onnx")
    side = describe(run / "surrogate.onnx")["side_of_body"]
    reference = MeshContact.from_files(
        femur=run / "implant" / "femur.stl",
        insert_medial=run / "implant" / "insert_medial.stl",
        insert_lateral=run / "implant" / "insert_lateral.stl",
        units="m",
        side_of_body=side,
        evaluation="fast",
        cache_directory=run / "cache",
    )
    units = np.array([180 / np.pi] * 3 + [1e3] * 3)
    row = "{:<28}{:<16}{:>8}{:>8}{:>8}{:>8}{:>12}{:>12}".format
    print(row("restraints", "activity", "N", "Nm", "deg", "mm", "converged", "trust<0.5"))
    for change in CHANGES:
        for activity in BUILT_IN:
            settings = settings_for(change, reference, side)
            known, found = (
                simulate_knee(m, load_case(activity), settings) for m in (reference, surrogate)
            )
            loads = np.sqrt(np.mean((found.wrenches - known.wrenches) ** 2, axis=0))
            motion = units * np.sqrt(np.mean((found.kinematics - known.kinematics) ** 2, axis=0))
            worst = (loads[:, :3].max(), loads[:, 3:].max(), motion[:3].max(), motion[3:].max())
            converged = int(np.sum(found.status == "converged"))
            text = [f"{value:.3g}" for value in worst]
            print(row(change, activity, *text, converged, int(np.sum(found.trust < 0.5))))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
