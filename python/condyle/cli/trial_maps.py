# SPDX-License-Identifier: Apache-2.0
"""Pressure maps of a simulated trial at the times that the user asks for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from condyle.errors import InputDataError

if TYPE_CHECKING:
    from condyle.fdk import JointContact, TrialSimulation
    from condyle.model import Trial

FIGURE: Final = "tibiofemoral_pressure_map.png"


def frames_of(trial: Trial, times: Sequence[float], knee: JointContact) -> list[int]:
    """Time frames nearest to the times, before anything is solved.

    Raises:
        InputDataError: a time is not the trial's, or there are no meshes to press.
    """
    if times and knee.reference is None:
        raise InputDataError(
            "--map-at needs the meshes of the knee: name them (--meshes), and leave --no-pressures out"
        )
    return [trial.nearest(time) for time in times]


def draw_maps(
    folder: Path,
    simulation: TrialSimulation,
    knee: JointContact,
    frames: Sequence[int],
    *,
    vtp: bool,
) -> list[Path]:
    """The meshes' own contact at the poses that were found: one picture of all, VTP files for each.

    Args:
        folder: of the results.
        simulation: with the knee as its first contact.
        knee: with a reference.
        frames: time frames to draw.
        vtp: also ``pressure_TIME/`` for ParaView.

    Returns:
        The files written.
    """
    from condyle.contact import MeshContact, contact_map
    from condyle.report.pressure_map import Panel, pressure_map_figure
    from condyle.report.style import house_style, save

    assert isinstance(knee.reference, MeshContact)
    flexion = np.degrees(simulation.kinematics(knee.contact.name)[:, 0])
    made, panels = [], []
    for frame in frames:
        found = contact_map(knee.reference, simulation.poses[frame, 0])
        time = simulation.times[frame]
        force = sum(side.wrench[1] for side in found.sides.values())
        panels.append(
            Panel(f"{time:.3f} s, {flexion[frame]:.0f}° of flexion, {force:.0f} N", found)
        )
        if vtp:
            from condyle.report.vtp_files import write_vtp

            made += write_vtp(folder / f"pressure_{time:.3f}", found)
    with house_style():
        made.append(save(pressure_map_figure(panels, title=panels[0].contact.law), folder / FIGURE))
    return made
