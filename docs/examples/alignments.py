# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: T201  (an example prints)
"""Peak medial and lateral contact force of a trial under 27 alignments of the tibial component.

    python docs/examples/alignments.py dm.json coordinates.sto --loads external_loads.xml --paths paths.json \
      --from 2.406 --to 3.125 --reserve 20 --negligible-force 20 --meshes docs/examples/dm_surfaces.json \
      --side-of-body right

Varus, slope and external rotation are changed from where the model has the component. With `--surrogate FILE.onnx` that
evaluates the knee's contact, else the meshes (`fast`) do. The exit code is 1 where time frames are not in equilibrium.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from condyle.fdk import (
    AlignedSimulation,
    ReferenceSettings,
    alignment_grid,
    patellofemoral_contact,
    simulate_alignments,
    tibiofemoral_contact,
)
from condyle.model import (
    MuscleSettings,
    MusculoskeletalModel,
    joint_surfaces,
    read_trial,
    surface_files,
)
from condyle.surrogate import OnnxContactModel

VARUS_DEG = (-3.0, 0.0, 3.0)
SLOPE_DEG = (-3.0, 0.0, 3.0)
ROTATION_DEG = (-5.0, 0.0, 5.0)


def read_arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """What `condyle simulate` takes, as far as this needs it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("motion", type=Path)
    parser.add_argument("--loads", type=Path)
    parser.add_argument("--paths", type=Path)
    parser.add_argument("--from", dest="start", type=float)
    parser.add_argument("--to", dest="end", type=float)
    parser.add_argument("--reserve", type=float, default=0.0)
    parser.add_argument("--negligible-force", type=float, default=0.0)
    parser.add_argument("--meshes", action="append", default=[])
    parser.add_argument("--side-of-body", choices=("left", "right"), required=True)
    parser.add_argument("--surrogate", type=Path)
    parser.add_argument("--cache", type=Path)
    parser.add_argument("--threads", type=int, default=0)
    return parser.parse_args(argv)


def simulate(given: argparse.Namespace) -> tuple[AlignedSimulation, ...]:
    """All alignments, the rotation's values next to each other."""
    model = MusculoskeletalModel.read(given.model)
    trial = read_trial(
        model,
        given.motion,
        external_loads=given.loads,
        snapshots=given.paths,
        start=given.start,
        end=given.end,
        negligible_force=given.negligible_force,
    )
    surfaces, joint = surface_files(model, given.meshes), joint_surfaces(model)
    reference = ReferenceSettings(cache_directory=given.cache)
    surrogate = OnnxContactModel(given.surrogate) if given.surrogate else None
    joints = [
        tibiofemoral_contact(
            surfaces, joint, given.side_of_body, "surrogate" if surrogate else "fast",
            settings=reference, surrogate=surrogate, pressures=False,
        )
    ]  # fmt: skip
    if joint.patella is not None:
        joints.append(
            patellofemoral_contact(
                surfaces, joint, given.side_of_body, settings=reference, pressures=False
            )
        )
    return simulate_alignments(
        model,
        trial,
        [contact.contact for contact in joints],
        alignment_grid(
            tibial_varus_deg=VARUS_DEG,
            tibial_posterior_slope_deg=SLOPE_DEG,
            tibial_external_rotation_deg=ROTATION_DEG,
        ),
        MuscleSettings(reserve_moment=given.reserve),
        threads=given.threads,
    )


def peaks(one: AlignedSimulation) -> str:
    """Medial and lateral peak over the time frames in equilibrium [N]."""
    if one.simulation is None:
        return "none"
    kept = [record.converged for record in one.simulation.records]
    if not any(kept):
        return "none"
    contact = one.simulation.contact("tibiofemoral")
    medial, lateral = one.simulation.wrenches[kept, contact, :, 1].max(axis=0)
    return f"{medial:.0f} / {lateral:.0f}"


def main(argv: Sequence[str] | None = None) -> int:
    """Prints the table; returns the exit code."""
    found = simulate(read_arguments(argv))
    print("Peak medial / lateral Fy [N] by the tibial component's external rotation [°]")
    print("varus  slope  " + "".join(f"{turn:>14g}" for turn in ROTATION_DEG))
    for i in range(0, len(found), len(ROTATION_DEG)):
        row, alignment = found[i : i + len(ROTATION_DEG)], found[i].alignment
        print(
            f"{alignment.tibial_varus_deg:5g}  {alignment.tibial_posterior_slope_deg:5g}  "
            + "".join(f"{peaks(one):>14}" for one in row)
        )
    trouble = [one for one in found if not one.converged]
    for one in trouble:
        said = one.failure or (one.simulation.summary if one.simulation is not None else "")
        print(f"{one.alignment.sentence()}: {said}", file=sys.stderr)
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
