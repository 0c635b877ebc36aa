# SPDX-License-Identifier: Apache-2.0
"""Draws the pressure maps of docs/implants.md: four implants, each in the same six states.

    .venv/bin/python tests/benchmarks/pressure_gallery.py [FOLDER]      (default: docs/figures)

The parametric presets are made here; DM and JW are drawn where their meshes are found (CONDYLE_DATA, or shared/data
beside the project).
"""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from condyle.contact import Mesh, MeshContact, contact_map
from condyle.fdk import load_seated, seated_pose
from condyle.implants import generate, preset
from condyle.report.pressure_map import Panel, pressure_map_figure
from condyle.report.style import house_style, save

ROOT = Path(__file__).parents[2]
LOAD = 1500.0  # [N] twice a body's weight
FLEXIONS_DEG = (30.0, 60.0, 90.0, 110.0)
#: Adductions to try for the one at which the lateral side lifts off [rad].
ADDUCTIONS = np.radians(np.linspace(0.0, 5.0, 101))


def parametric(name: str) -> MeshContact:
    """A preset, right knee."""
    surfaces = generate(preset(name)).meshes()
    meshes = {
        part: Mesh(np.ascontiguousarray(s.vertices), np.ascontiguousarray(s.faces, dtype=np.int32))
        for part, s in surfaces.items()
        if part in ("femur", "insert_medial", "insert_lateral")
    }
    return MeshContact(**meshes, side_of_body="right", evaluation="fast")


def measured(folder: Path) -> MeshContact:
    """One of the implants of the Grand Challenge competitions, right knees."""
    return MeshContact.from_files(
        femur=folder / "femur_contact.stl",
        insert_medial=folder / "insert_contact_medial.stl",
        insert_lateral=folder / "insert_contact_lateral.stl",
        units="m",
        side_of_body="right",
        evaluation="fast",
    )


def implants() -> Iterator[tuple[str, str, MeshContact]]:
    """File name, title and contact of each implant."""
    yield "flat", "Parametric, flat coronal profile", parametric("flat")
    yield "curved", "Parametric, curved coronal profile", parametric("curved")
    data = Path(os.environ.get("CONDYLE_DATA", ROOT.parent / "shared" / "data")) / "implants"
    for name in ("dm", "jw"):
        if (data / name).is_dir():
            yield name, f"{name.upper()} (Grand Challenge)", measured(data / name)


def central(contact: MeshContact, flexion: float) -> np.ndarray:
    """Carries LOAD without a moment about x, where the femur seats at this flexion."""
    seat = seated_pose(contact, flexion)
    if not seat.converged:
        raise SystemExit(f"{flexion} rad: {seat.advice}")
    found = load_seated(contact, seat, LOAD, Mx=0.0)
    if not found.converged[0]:
        raise SystemExit(f"{flexion} rad: {found.status[0]}")
    return found.poses[0]


def lift_off(contact: MeshContact) -> np.ndarray:
    """Carries LOAD on the medial side alone, at the least adduction that lifts the lateral side off."""
    found = load_seated(contact, seated_pose(contact), LOAD, theta_x=ADDUCTIONS)
    one_sided = found.converged & (found.wrenches[:, 1, 1] <= 0.0)
    if not one_sided.any():
        raise SystemExit("the lateral side does not lift off")
    return found.poses[int(np.argmax(one_sided))]


def panels(contact: MeshContact) -> list[Panel]:
    """The six states."""
    lifted = lift_off(contact)
    shown = [
        ("extension", central(contact, 0.0)),
        (f"adduction {np.degrees(lifted[3]):.2f}°: lateral lift-off", lifted),
        *((f"flexion {deg:.0f}°", central(contact, np.radians(deg))) for deg in FLEXIONS_DEG),
    ]
    return [Panel(title, contact_map(contact, pose)) for title, pose in shown]


def main() -> None:
    """Draws one figure an implant, and prints what is in it."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "figures"
    for name, title, contact in implants():
        drawn = panels(contact)
        with house_style():
            figure = pressure_map_figure(drawn, title=f"{title}: {LOAD:.0f} N")
            file = save(figure, folder / f"pressure_{name}.png", dpi=110)
        print(file)
        for panel in drawn:
            sides = panel.contact.sides.values()
            print(
                f"  {panel.title}: Fy {' / '.join(f'{s.wrench[1]:.0f}' for s in sides)} N, "
                f"area {' / '.join(f'{1e6 * s.area:.0f}' for s in sides)} mm², "
                f"depth {' / '.join(f'{1e3 * s.depth.max():.2f}' for s in sides)} mm, "
                f"peak {1e-6 * panel.contact.peak_pressure:.1f} MPa, {panel.contact.status}"
            )


if __name__ == "__main__":
    main()
