# SPDX-License-Identifier: Apache-2.0
"""A knee with a patella in files: the parametric femoral component, a domed button, a patella of six coordinates.

Frames are turned and offset, and no parameter is one. A left knee is the right one mirrored in z: positions and
translations change z's sign, angles those of x and y, so that coordinates have the right one's values.
"""

import json
from dataclasses import replace
from functools import cache

import numpy as np
from leg_model import Side

from condyle._core.geometry import Mesh
from condyle.contact import write_mesh
from condyle.implants import generate, preset

SIX = ("p_flex", "p_rot", "p_tilt", "p_tx", "p_ty", "p_tz")
#: Defaults of the six: the button 1 to 2 mm in front of the groove and beside its bottom, a little turned.
DEFAULTS = (0.21, 0.02, -0.03, 0.0435, 0.0065, 0.0012)
DOME_RADIUS, DOME_HEIGHT, BASE = 0.024, 0.009, -0.0013


@cache
def femur_mesh(side_of_body, edge=1.5e-3):
    parameters = replace(preset("curved", side_of_body=side_of_body), mesh_edge_length=edge)
    made = generate(parameters).femur
    return Mesh(
        np.ascontiguousarray(made.vertices),
        np.ascontiguousarray(made.faces, dtype=np.int32),
    )


@cache
def button_mesh(rings=24):
    """A spherical cap about −x of P: apex at x = BASE − DOME_HEIGHT, normals out of it."""
    across = np.arccos(1.0 - DOME_HEIGHT / DOME_RADIUS)
    vertices, faces = [[BASE - DOME_HEIGHT, 0.0, 0.0]], []
    starts = [0]
    for ring in range(1, rings + 1):
        starts.append(len(vertices))
        polar = across * ring / rings
        for k in range(6 * ring):
            turn = 2.0 * np.pi * k / (6 * ring)
            aside = DOME_RADIUS * np.sin(polar)
            vertices.append(
                [
                    BASE - DOME_HEIGHT + DOME_RADIUS * (1.0 - np.cos(polar)),
                    aside * np.cos(turn),
                    aside * np.sin(turn),
                ]
            )
    for ring in range(1, rings + 1):
        inner, outer, n = max(6 * (ring - 1), 1), 6 * ring, starts[ring - 1]
        i = o = 0
        while i < (inner if ring > 1 else 0) or o < outer:
            # The next triangle is on the circle that lags behind.
            a, b = n + i % inner, starts[ring] + o % outer
            if ring > 1 and (i + 0.5) / inner < (o + 0.5) / outer:
                faces.append([a, b, n + (i + 1) % inner])
                i += 1
            else:
                faces.append([a, b, starts[ring] + (o + 1) % outer])
                o += 1
    mesh = np.array(faces, dtype=np.int32)
    points = np.array(vertices)
    p, q, r = (points[mesh[:, k]] for k in range(3))
    if np.cross(q - p, r - p)[:, 0].mean() > 0:
        mesh = mesh[:, ::-1]
    return Mesh(np.ascontiguousarray(points), np.ascontiguousarray(mesh))


def write_knee(folder, side_of_body="right", edit=None):
    """Writes knee.json, femur.stl, button.stl, and an insert that nobody reads; returns the model's file."""
    content = knee_model(side_of_body)
    if edit is not None:
        edit(content)
    (folder / "knee.json").write_text(json.dumps(content, indent=1), encoding="utf-8")
    write_mesh(folder / "femur.stl", femur_mesh(side_of_body))
    write_mesh(folder / "button.stl", button_mesh())
    (folder / "insert.stl").touch()
    return folder / "knee.json"


def knee_model(side_of_body="right"):
    """Content of the model file."""
    side = Side(side_of_body)
    return {
        "format": "condyle-model",
        "version": 1,
        "name": f"{side_of_body} knee",
        "source": "written by hand",
        "bodies": _bodies(side),
        "joints": [_hip(side), _knee(side), _patella(side)],
        "coordinates": _coordinates(),
        "springs": [{"coordinate": "p_tx", "viscosity": 5.0}],
        "muscles": [_quadriceps(side)],
        "ligaments": _ligaments(side),
        "contact_surfaces": [
            {
                "name": "femur",
                "frame": side.frame("thigh", (0.004, -0.396, 0.003), (0.03, -0.02, 0.05)),
                "mesh": "femur.stl",
            },
            {"name": "insert", "frame": side.frame("shank", (0, -0.04, 0)), "mesh": "insert.stl"},
            {
                "name": "button",
                "frame": side.frame("kneecap", (0.0011, 0.0007, -0.0004), (0.01, 0.02, -0.015)),
                "mesh": "button.stl",
            },
        ],
        "contact_pairs": [
            {"name": "knee", "first": "femur", "second": "insert"},
            {"name": "trochlea", "first": "femur", "second": "button"},
        ],
    }


def _bodies(side):
    def body(name, mass, centre, inertia):
        signed = [*inertia[:4], *(side.sign * x for x in inertia[4:])]
        return {
            "name": name,
            "mass": mass,
            "mass_centre": side.vector(centre),
            "inertia": signed,
        }

    return [
        body("thigh", 7.3, (0.011, -0.17, 0.007), [0.11, 0.013, 0.12, 0.002, -0.001, 0.003]),
        body("shank", 4.1, (0.007, -0.18, -0.004), [0.06, 0.008, 0.07, 0.001, 0.002, -0.001]),
        body("kneecap", 0.31, (0.004, 0.012, 0.002), [3e-5, 5e-5, 4e-5, 2e-6, -3e-6, 1e-6]),
    ]


def _coordinates():
    made = [
        {"name": "hip", "motion": "rotational", "range": [-2.0, 2.0]},
        {"name": "flexion", "motion": "rotational", "range": [-1, 2.5], "balanced_by": "muscles"},
    ]
    for name, default in zip(SIX, DEFAULTS, strict=True):
        made.append(
            {
                "name": name,
                "motion": "translational" if "_t" in name and name != "p_tilt" else "rotational",
                "default": default,
                "range": [-2.0, 2.0],
                "role": "force_dependent",
            }
        )
    return made


def _term(coordinate, slope):
    return [{"coordinate": coordinate, "function": {"kind": "linear", "slope": slope}}]


def _hip(side):
    return {
        "name": "hip",
        "parent": side.frame("ground", (0.1, 0.9, 0.08), (0.05, 0.1, 0.02)),
        "child": {"body": "thigh"},
        "rotations": [
            {"axis": side.turn((0.05, 0.02, 1.0)), "terms": _term("hip", 1.0)},
            {"axis": side.turn((1, 0, 0))},
            {"axis": side.turn((0, 1, 0))},
        ],
    }


def _knee(side):
    return {
        "name": "knee",
        "parent": side.frame("thigh", (0.002, -0.397, 0.001), (0.02, -0.01, 0.03)),
        "child": side.frame("shank", (0.001, 0.002, -0.001), (-0.01, 0.02, 0.01)),
        "rotations": [
            {"axis": side.turn((0.02, -0.03, 1.0)), "terms": _term("flexion", -1.0)},
            {"axis": side.turn((1, 0, 0))},
            {"axis": side.turn((0, 1, 0))},
        ],
    }


def _patella(side):
    flex, rot, tilt, *moves = SIX
    return {
        "name": "patella",
        "parent": side.frame("thigh", (-0.001, -0.4, 0.002), (0.01, 0.015, 0.02)),
        "child": side.frame("kneecap", (0.002, -0.001, 0.001), (0.01, -0.02, 0.03)),
        "rotations": [
            {"axis": side.turn((0, 0, 1)), "terms": _term(flex, -1.0)},
            {"axis": side.turn((1, 0, 0)), "terms": _term(rot, 1.0)},
            {"axis": side.turn((0, 1, 0)), "terms": _term(tilt, 1.0)},
        ],
        "translations": [
            {"axis": side.vector(axis), "terms": _term(move, 1.0)}
            for axis, move in zip(np.eye(3), moves, strict=True)
        ],
    }


def _point(side, body, location):
    return {"body": body, "location": side.vector(location)}


def _quadriceps(side):
    return {
        "name": "quadriceps",
        "max_isometric_force": 4100.0,
        "optimal_fibre_length": 0.11,
        "tendon_slack_length": 0.24,
        "pennation_at_optimal": 0.15,
        "path": {
            "points": [
                _point(side, "thigh", (0.03, -0.06, 0.01)),
                _point(side, "kneecap", (0.009, 0.021, 0.001)),
            ]
        },
    }


def _ligaments(side):
    strands = []
    for name, z in (("PT1", -0.011), ("PT2", 0.001), ("PT3", 0.009)):
        strands.append(
            {
                "name": name,
                "stiffness": 4900.0,
                "slack_length": 0.05,
                "transition_strain": 0.06,
                "path": {
                    "points": [
                        _point(side, "kneecap", (0.007, -0.019 - 0.1 * z, z)),
                        _point(side, "shank", (0.041, -0.072, 0.7 * z + 0.003)),
                    ]
                },
            }
        )
    strands[1]["path"]["points"].reverse()
    retinaculum = {
        "name": "retinaculum",
        "stiffness": 800.0,
        "slack_length": 0.05,
        "transition_strain": 0.06,
        "path": {
            "points": [
                _point(side, "thigh", (0.003, -0.4, 0.04)),
                _point(side, "kneecap", (0.002, 0.003, 0.02)),
            ]
        },
    }
    return [strands[0], retinaculum, *strands[1:]]
