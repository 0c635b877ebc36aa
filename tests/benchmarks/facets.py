# SPDX-License-Identifier: Apache-2.0
"""What the error of ``fast`` against ``exact`` is made of: the same smooth femur, meshed finer and finer.

    .venv/bin/python tests/benchmarks/facets.py [POSES]

The parametric femur (preset curved) at several edge lengths, on one insert; each mesh's ``fast`` against its own
``exact``, at the same poses (seed 1). Were it the field's error, a finer mesh would not help.
"""

import dataclasses
import sys

import numpy as np

from condyle._core.contact import PlausiblePoses, measure_accuracy, plausible_poses
from condyle.contact import Mesh, MeshContact
from condyle.fdk import seated_pose
from condyle.implants import SurfaceMesh, generate, preset

EDGES_MM = (1.2, 0.8, 0.5, 0.35, 0.25)


def mesh(surface: SurfaceMesh) -> Mesh:
    """As the contact takes it."""
    return Mesh(surface.vertices, surface.faces)


def main(count: int) -> None:
    """Prints the table."""
    design = preset("curved", size=1.0, side_of_body="right")
    implant = generate(design)
    inserts = mesh(implant.insert_medial), mesh(implant.insert_lateral)
    poses = np.empty((0, 6))
    print(
        "femur's edge mm   faces | F median %  99th % | M median %  99th % | F, M error/tolerance"
    )
    for edge in EDGES_MM:
        finer = dataclasses.replace(design, mesh_edge_length=1e-3 * edge)
        femur = mesh(generate(finer).femur)
        fast, exact = (
            MeshContact(femur, *inserts, "right", evaluation=evaluation)
            for evaluation in ("fast", "exact")
        )
        if len(poses) == 0:
            box = PlausiblePoses()
            box.settled, box.count = seated_pose(fast).pose, count
            poses = plausible_poses(fast, box, 0)
        total = measure_accuracy(fast, exact, poses, 0).total
        f, m = total.force, total.moment
        print(
            f"{edge:15.2f} {len(femur.faces):7d} | {100 * f.median:10.4f} {100 * f.p99:7.3f} | "
            f"{100 * m.median:10.4f} {100 * m.p99:7.3f} | {f.tolerance_p99:9.2f} {m.tolerance_p99:6.2f}",
            flush=True,
        )


main(int(sys.argv[1]) if len(sys.argv) > 1 else 400)
