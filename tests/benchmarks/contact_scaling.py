# SPDX-License-Identifier: Apache-2.0
"""What one pose of the contact costs over contact area and mesh size: see README.md.

python tests/benchmarks/contact_scaling.py [FOLDER OF femur_contact.stl, insert_contact_medial.stl, …]
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from condyle.contact import Derivatives, MeshContact, read_implant, refine_mesh
from condyle.contact.mesh_refinement import mean_edge_length
from condyle.fdk import seated_pose

DEPTHS_MM = (0.1, 0.3, 0.5, 0.7, 0.9, 1.2)


def quickest(contact: MeshContact, pose: np.ndarray, repeats: int) -> float:
    """Seconds for wrench and stiffness at one pose, one thread."""
    best = np.inf
    for _ in range(repeats):
        start = time.perf_counter()
        contact.evaluate(pose, Derivatives.stiffness, 1)
        best = min(best, time.perf_counter() - start)
    return best


def main() -> None:
    """Prints the table."""
    data = Path(os.environ.get("CONDYLE_DATA", Path(__file__).parents[3] / "shared" / "data"))
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else data / "implants" / "dm"
    implant = read_implant(
        femur=folder / "femur_contact.stl",
        insert_medial=folder / "insert_contact_medial.stl",
        insert_lateral=folder / "insert_contact_lateral.stl",
        units="m",
        side_of_body="right",
    )
    print("insert edges  faces   depth    area  loaded   fast      a loaded  exact")
    print("          mm             mm     mm^2   faces     us       face ns     ms")
    seat = None
    edge = mean_edge_length(implant["insert_medial"])
    with tempfile.TemporaryDirectory() as cache:
        for splits in (0, 1):
            sides = [implant["insert_medial"], implant["insert_lateral"]]
            if splits:
                sides = [refine_mesh(side, 0.6 * edge) for side in sides]
            exact = MeshContact(implant["femur"], *sides, "right")
            fast = MeshContact(
                implant["femur"], *sides, "right", evaluation="fast", cache_directory=cache
            )
            if seat is None:
                seat = np.asarray(seated_pose(fast, 0.0).pose)
            for depth in DEPTHS_MM:
                pose = seat[None, :].copy()
                pose[0, 1] -= 1e-3 * depth
                area = float(np.sum(fast.evaluate_details(pose, 1).area))
                loaded = sum(int(np.count_nonzero(p)) for p in fast.face_pressures(pose[0]))
                took = quickest(fast, pose, 300)
                print(
                    f"{1e3 * mean_edge_length(sides[0]):12.2f} {sum(len(s.faces) for s in sides):6d}"
                    f" {depth:7.1f} {1e6 * area:7.0f} {loaded:7d} {1e6 * took:6.0f}"
                    f" {1e9 * took / loaded:13.1f} {1e3 * quickest(exact, pose, 3):6.1f}"
                )


if __name__ == "__main__":
    main()
