# SPDX-License-Identifier: Apache-2.0
"""A leg standing on one foot, in files: the model of tests/cpp/fdk/leg_model.hpp on the parametric implant's meshes.

Thigh on a driven hip, shank on a knee of six coordinates of which flexion is driven and balanced by muscles and five
are force-dependent; eight ligament bundles, a floor's reaction on the shank. Frames are turned and offset, one axis
carries two functions and others curved ones: nothing is aligned or unit-valued. A left leg is the right one mirrored in
z: its coordinates have the right one's values.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from condyle._core import io
from condyle.fdk import default_ligaments
from condyle.implants import generate, preset, write_implant

#: F in the thigh, T in the shank: body-fixed x-y-z angles [rad] and origins [m] of a right leg.
THIGH_F = ((0.03, -0.02, 0.05), (0.004, -0.396, 0.003))
SHANK_T = ((0.02, 0.01, -0.03), (-0.003, -0.0365, 0.001))
REFERENCE_POSE = (0.0068, 0.0405, 0.0, 0.0, 0.0, 0.0)
FORCE_DEPENDENT = ("adduction", "rotation", "tx", "ty", "tz")
LOADS = """<OpenSimDocument Version="40000"><ExternalLoads><objects>
<ExternalForce name="floor"><applied_to_body>shank</applied_to_body>
<force_identifier>floor_v</force_identifier><point_identifier>floor_p</point_identifier>
<torque_identifier>floor_m</torque_identifier>
</ExternalForce></objects><datafile>floor.sto</datafile></ExternalLoads></OpenSimDocument>"""


@dataclass(frozen=True)
class Leg:
    """Files of a leg and its trial; ``content`` is the model file's."""

    folder: Path
    model: Path
    motion: Path
    loads: Path
    content: dict


def rotation(angles):
    """Rx·Ry·Rz of body-fixed angles."""
    R = np.eye(3)
    for axis, angle in enumerate(angles):
        one, (j, k) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
        one[j, j] = one[k, k] = np.cos(angle)
        one[j, k], one[k, j] = -np.sin(angle), np.sin(angle)
        R = R @ one
    return R


class Side:
    """Mirrors in z for a left leg, nothing for a right one."""

    def __init__(self, side_of_body):
        self.sign = -1.0 if side_of_body == "left" else 1.0

    def vector(self, v):
        """Positions, forces, directions of translation."""
        return [float(v[0]), float(v[1]), self.sign * float(v[2])]

    def turn(self, v):
        """Angles, axes of rotation, moments: pseudo-vectors."""
        return [self.sign * float(v[0]), self.sign * float(v[1]), float(v[2])]

    def frame(self, body, translation, angles=(0.0, 0.0, 0.0)):
        return {
            "body": body,
            "translation": self.vector(translation),
            "orientation_xyz": self.turn(angles),
        }


def write_leg(folder, side_of_body="right", frames=9, reaction=650.0, mesh_edge=1.5e-3):
    """Writes leg.json, its meshes, motion.sto and floor.xml with floor.sto."""
    parameters = replace(preset("curved", side_of_body=side_of_body), mesh_edge_length=mesh_edge)
    write_implant(folder, generate(parameters))
    content = leg_model(side_of_body)
    (folder / "leg.json").write_text(json.dumps(content, indent=1), encoding="utf-8")
    times = 0.5 + 0.02 * np.arange(frames)
    flexion = 0.35 + 0.15 * np.sin(5 * times)
    motion = np.stack([0.5 * flexion, flexion], axis=1)
    write_table(folder / "motion.sto", ["hip", "flexion"], times, motion)
    write_floor(folder, side_of_body, times, reaction)
    return Leg(folder, folder / "leg.json", folder / "motion.sto", folder / "floor.xml", content)


def add_button(leg, mesh="insert.stl"):
    """A third surface, ``button``, that the femur meets as it would a patella's: of a right leg."""
    frame = dict(leg.content["contact_surfaces"][1]["frame"])
    # 0.2 mm below the insert, and moved and turned: it carries some of the load.
    frame["translation"] = np.add(frame["translation"], [1e-4, -2e-4, 2e-4]).tolist()
    frame["orientation_xyz"] = [0.022, 0.008, -0.031]
    leg.content["contact_surfaces"].append({"name": "button", "mesh": mesh, "frame": frame})
    leg.model.write_text(json.dumps(leg.content, indent=1), encoding="utf-8")


def write_table(file, names, times, data):
    table = io.make_motion(file.stem, names, times, np.ascontiguousarray(data), False)
    io.write_motion(table, file)


def write_floor(folder, side_of_body, times, reaction):
    """The floor pushes up (N, one value or one a time), behind the knee and inwards of it."""
    side = Side(side_of_body)
    up = np.broadcast_to(np.asarray(reaction, dtype=float), times.shape)
    rows = [
        [*side.vector((0.05 * f, f, 0.02 * f)), *side.vector((0.18, 0.08, 0.074)),
         *side.turn((0.3, 1.1, -0.2))]
        for f in up
    ]  # fmt: skip
    names = [f"floor_{kind}{axis}" for kind in "vpm" for axis in "xyz"]
    write_table(folder / "floor.sto", names, times, np.array(rows))
    (folder / "floor.xml").write_text(LOADS, encoding="utf-8")


def leg_model(side_of_body="right"):
    """Content of the model file."""
    side = Side(side_of_body)
    surfaces = [
        {"name": "femoral_component", "frame": side.frame("thigh", THIGH_F[1], THIGH_F[0]),
         "mesh": "femur.stl"},
        {"name": "insert", "frame": side.frame("shank", SHANK_T[1], SHANK_T[0]),
         "mesh": "insert.stl"},
    ]  # fmt: skip
    return {
        "format": "condyle-model",
        "version": 1,
        "name": f"{side_of_body} leg",
        "bodies": [_body(side, "thigh", 7.3, 0.4), _body(side, "shank", 4.1, 0.42)],
        "joints": [_hip(side), _knee(side)],
        "coordinates": _coordinates(),
        "springs": [{"coordinate": "rotation", "stiffness": 4.0, "rest": 0.02, "viscosity": 0.3}],
        "muscles": _muscles(side),
        "ligaments": _ligaments(side_of_body),
        "contact_surfaces": surfaces,
        "contact_pairs": [{"name": "knee", "first": "femoral_component", "second": "insert"}],
    }


def _body(side, name, mass, length):
    inertia = [0.11, 0.013, 0.12, 0.002, side.sign * -0.001, side.sign * 0.003]
    centre = side.vector((0.011, -0.43 * length, 0.007))
    return {"name": name, "mass": mass, "mass_centre": centre, "inertia": inertia}


def _coordinates():
    made = []
    for name in ("hip", "flexion", *FORCE_DEPENDENT):
        motion = "translational" if name.startswith("t") else "rotational"
        coordinate = {"name": name, "motion": motion, "range": [-2.0, 2.0]}
        if name == "flexion":
            coordinate["balanced_by"] = "muscles"
        if name in FORCE_DEPENDENT:
            coordinate["role"] = "force_dependent"
        made.append(coordinate)
    return made


def _term(coordinate, *coefficients):
    if len(coefficients) == 1:
        return {"coordinate": coordinate, "function": {"kind": "linear", "slope": coefficients[0]}}
    function = {"kind": "polynomial", "coefficients": list(coefficients)}
    return {"coordinate": coordinate, "function": function}


def _hip(side):
    turn = {"axis": side.turn((0.05, 0.02, 1.0)), "terms": [_term("hip", 1.0)]}
    return {
        "name": "hip",
        "parent": side.frame("ground", (0.1, 0.9, 0.08), (0.05, 0.1, 0.02)),
        "child": {"body": "thigh"},
        "rotations": [turn, {"axis": side.turn((1, 0, 0))}, {"axis": side.turn((0, 1, 0))}],
    }


def _knee(side):
    rotations = [
        ((0.02, -0.03, 1.0), [_term("flexion", -1.0)]),
        ((1.0, 0.04, -0.02), [_term("adduction", 0.0, 1.1, 0.2)]),
        ((-0.03, 1.0, 0.05), [_term("rotation", 0.9), _term("flexion", 0.0, 0.05, 0.02)]),
    ]
    translations = [
        ((1.0, 0.02, 0.01), [_term("tx", 1.0)]),
        ((0.01, 1.0, -0.03), [_term("ty", 0.0, 1.2, 0.7), _term("flexion", -0.001)]),
        ((0.02, -0.01, 1.0), [_term("tz", 1.0)]),
    ]
    return {
        "name": "knee",
        "parent": side.frame("thigh", (0.002, -0.4, 0.001), (0.02, -0.01, 0.03)),
        "child": side.frame("shank", (0.001, 0.002, -0.001), (-0.01, 0.02, 0.01)),
        "rotations": [{"axis": side.turn(a), "terms": terms} for a, terms in rotations],
        "translations": [{"axis": side.vector(a), "terms": terms} for a, terms in translations],
    }


def _muscles(side):
    def muscle(name, strength, slack, *points):
        return {
            "name": name,
            "max_isometric_force": strength,
            "optimal_fibre_length": 0.11,
            "tendon_slack_length": slack,
            "pennation_at_optimal": 0.15,
            "path": {"points": [{"body": b, "location": side.vector(p)} for b, p in points]},
        }

    return [
        muscle("quadriceps_medial", 2100.0, 0.26, ("thigh", (0.03, -0.12, -0.01)),
               ("thigh", (0.052, -0.39, -0.006)), ("shank", (0.042, -0.07, 0.002))),
        muscle("quadriceps_lateral", 2600.0, 0.26, ("thigh", (0.03, -0.11, 0.02)),
               ("thigh", (0.051, -0.39, 0.012)), ("shank", (0.042, -0.07, 0.004))),
        muscle("hamstring_medial", 1300.0, 0.30, ("thigh", (-0.04, -0.03, -0.02)),
               ("shank", (-0.025, -0.05, -0.025))),
        muscle("hamstring_lateral", 1100.0, 0.30, ("thigh", (-0.04, -0.03, 0.02)),
               ("shank", (-0.02, -0.04, 0.035))),
    ]  # fmt: skip


def _ligaments(side_of_body):
    """The knee simulator's bundles, whose attachments are given in F and T of this side."""
    side = Side(side_of_body)
    R_F, R_T = rotation(side.turn(THIGH_F[0])), rotation(side.turn(SHANK_T[0]))
    p_F, p_T = np.array(side.vector(THIGH_F[1])), np.array(side.vector(SHANK_T[1]))
    made = []
    for bundle in default_ligaments(side_of_body, REFERENCE_POSE):
        ends = [
            ("thigh", R_F @ np.asarray(bundle.p_FoA_F) + p_F),
            ("shank", R_T @ np.asarray(bundle.p_ToB_T) + p_T),
        ]
        made.append(
            {
                "name": bundle.name,
                "stiffness": bundle.stiffness,
                "slack_length": bundle.slack_length,
                "transition_strain": bundle.transition,
                "path": {"points": [{"body": b, "location": list(map(float, p))} for b, p in ends]},
            }
        )
    return made
