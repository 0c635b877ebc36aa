# SPDX-License-Identifier: Apache-2.0
"""Recordings that a model's own markers would give: what inverse kinematics has to find is known."""

import numpy as np
from forward_kinematics import placements, point_in_ground

from condyle.opensim import import_model


def slow_swing(frames=30):
    """Times [s] and coordinates of the leg of osim_models."""
    times = np.arange(frames) / 100.0
    phase = 2 * np.pi * times / 0.6
    return times, {
        "hip_flex": 0.4 + 0.3 * np.sin(phase),
        "knee_flex": 0.6 + 0.4 * np.cos(phase),
        "knee_shift": 0.01 + 0.005 * np.sin(phase + 1),
    }


def marker_positions(osim_file, times, q):
    """Names (n) and positions (T, n, 3) [m] of a model's markers; what q leaves out is at its default."""
    model = import_model(osim_file)
    defaults = {c["name"]: c["default"] for c in model["coordinates"]}
    positions = []
    for i in range(len(times)):
        placed = placements(model, defaults | {name: values[i] for name, values in q.items()})
        row = [point_in_ground(placed, m["body"], m["location"]) for m in model["markers"]]
        positions.append(row)
    return [m["name"] for m in model["markers"]], np.array(positions)


def write_trc(file, names, times, positions, unit="mm"):
    scale = {"m": 1.0, "mm": 1e3}[unit]
    rate = 1.0 / (times[1] - times[0]) if len(times) > 1 else 100.0
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{file.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{len(times)}\t{len(names)}\t{unit}\t{rate}\t1\t{len(times)}",
        "Frame#\tTime\t" + "\t\t\t".join(names) + "\t\t",
        "\t\t" + "\t".join(f"{a}{i + 1}" for i in range(len(names)) for a in "XYZ"),
        "",
    ]
    for i, (time, row) in enumerate(zip(times, positions, strict=True)):
        cells = ["" if np.isnan(v) else f"{scale * v:.9f}" for v in row.ravel()]
        head.append("\t".join([str(i + 1), f"{time:.9f}", *cells]))
    file.write_text("\n".join(head) + "\n", encoding="utf-8")
    return file
