# SPDX-License-Identifier: Apache-2.0
"""How well a run's samples carry the loads that were asked for, judged by ``exact``.

    .venv/bin/condyle sample STUDY.toml
    .venv/bin/python tests/benchmarks/sample_accuracy.py runs/NAME [ROWS]

Of every domain whose samples solve an equilibrium, evenly spaced rows are evaluated anew on the triangles: the share
whose total Fy and Mx are within 0.3 % + 0.5 N and 0.3 % + 0.02 Nm of what was prescribed, and the worst. For studies
with the default contact law.
"""

import json
import sys
from pathlib import Path

import numpy as np

from condyle.contact import Derivatives, MeshContact
from condyle.sampling import Dataset


def main() -> None:
    """Prints the table."""
    run = Path(sys.argv[1])
    rows = int(sys.argv[2]) if len(sys.argv) > 2 else 6500
    samples = Dataset.read(run / "samples")
    exact = MeshContact.from_files(
        femur=run / "implant" / "femur.stl",
        insert_medial=run / "implant" / "insert_medial.stl",
        insert_lateral=run / "implant" / "insert_lateral.stl",
        units="m",
        side_of_body=samples.manifest["identity"]["side_of_body"],
    )
    print(json.dumps(samples.manifest["identity"]["contact_law"]))
    prescribed = samples.prescribed_loads
    solved = np.flatnonzero(np.isfinite(prescribed[:, 0]))
    chosen = solved[:: max(1, len(solved) // rows)]
    wrench = np.asarray(exact.evaluate(samples.poses[chosen], Derivatives.none, 0).wrench).sum(1)
    limits = ((0, 1, "Fy", 0.5), (1, 3, "Mx", 0.02))
    print(f"{'domain':>6} {'load':>4} {'rows':>6} {'within':>7} {'99th % of limit':>15}  worst")
    for domain in [*np.unique(samples.domain[chosen]), 0]:
        part = (samples.domain[chosen] == domain) | (domain == 0)
        for column, axis, name, absolute in limits:
            wanted = prescribed[chosen[part], column]
            known = np.isfinite(wanted)
            if not known.any():
                continue
            found, wanted = wrench[part][known, axis], wanted[known]
            ratio = np.abs(found - wanted) / (0.003 * np.abs(wanted) + absolute)
            worst = int(np.argmax(ratio))
            candidate = samples.candidate[chosen[part]][known][worst]
            print(
                f"{domain or 'all':>6} {name:>4} {len(ratio):6d} {np.mean(ratio <= 1):7.1%}"
                f" {np.quantile(ratio, 0.99):15.2f}  {found[worst]:.4g} for {wanted[worst]:.4g}"
                f" (candidate {candidate})"
            )


if __name__ == "__main__":
    main()
