# SPDX-License-Identifier: Apache-2.0
"""What a picture is drawn from: the example, with surfaces on it."""

import json
from pathlib import Path

import numpy as np
import pytest

from condyle.contact import Mesh, write_mesh
from condyle.model import (
    MusculoskeletalModel,
    analyse_trial,
    make_trial,
    scene_at,
    surface_files,
)

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "pendulum.json"
#: Of the size of a knee component, in general position.
CORNERS = np.array([[0, 0, 0], [0.05, 0.01, 0], [0.01, 0.06, 0.02], [0.02, 0.01, 0.05]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int32)
FRAME = {"body": "lower", "translation": [0.01, -0.02, 0.03], "orientation_xyz": [0.3, -0.4, 0.5]}


@pytest.fixture
def model(tmp_path):
    content = json.loads(EXAMPLE.read_text(encoding="utf-8"))
    content["contact_surfaces"] = [{"name": "cup", "frame": FRAME, "mesh": "cup.stl"}]
    (tmp_path / "arm.json").write_text(json.dumps(content), encoding="utf-8")
    write_mesh(tmp_path / "cup.stl", Mesh(CORNERS, FACES))
    return MusculoskeletalModel.read(tmp_path / "arm.json")


@pytest.fixture
def trial(model):
    loads = np.array([[[0, 12.0, 5.0, 0.1, 0.2, 0.3, 0, 0, 0]], [[0, 0.5, 0, 0, 0, 0, 0, 0, 0]]])
    q = np.array([[0.4, 0.9], [0.1, 0.2]])
    return make_trial(model, np.arange(2.0), q, load_bodies=("lower",), loads=loads)


def turned(angles):
    """R = Rx Ry Rz."""
    R = np.eye(3)
    for axis, angle in enumerate(angles):
        K = np.zeros((3, 3))
        K[(axis + 2) % 3, (axis + 1) % 3], K[(axis + 1) % 3, (axis + 2) % 3] = 1.0, -1.0
        R = R @ (np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)
    return R


def in_ground(trial, points):
    """Points in the forearm's frame, by the two angles of the arm alone."""
    a, b = trial.q[0]
    upper, lower = turned([0, 0, a]), turned([0, 0, a + b])
    return [0, 1.4, 0] + upper @ [0, -0.3, 0] + points @ lower.T


def test_a_scene_is_the_arm(model, trial):
    found = analyse_trial(model, trial)
    scene = scene_at(model, trial, 0, found)
    assert scene.title == "double pendulum, 0.000 s"
    elbow = in_ground(trial, np.zeros((1, 3)))[0]
    np.testing.assert_allclose(scene.joints, [[0, 1.4, 0], elbow], atol=1e-14)
    # The forearm, where nothing hangs, goes through its mass centre.
    tip = in_ground(trial, np.array([[0, -0.24, 0]]))[0]
    np.testing.assert_allclose(scene.bones, [[[0, 1.4, 0], elbow], [elbow, tip]], atol=1e-14)
    (flexor,) = scene.muscles
    assert flexor.amount == found.activities[0, 0] > 0
    np.testing.assert_allclose(flexor.points[0], [0.03, 1.41, 0.005], atol=1e-14)
    np.testing.assert_allclose(scene.forces, [[[0.1, 0.2, 0.3], [0, 12, 5]]])
    assert len(scene_at(model, trial, 1).forces) == 0  # half a newton is nothing to draw
    np.testing.assert_array_equal(scene.up, [0, 1, 0])
    # An arm on the wall faces nowhere: ground's x.
    np.testing.assert_array_equal(scene.forward, [1, 0, 0])


def test_surfaces_stand_in_their_frames(model, trial, tmp_path):
    R, p = turned(FRAME["orientation_xyz"]), np.array(FRAME["translation"])
    expected = in_ground(trial, CORNERS @ R.T + p)
    (surface,) = scene_at(model, trial, 0).surfaces
    order = [int(np.linalg.norm(expected - v, axis=1).argmin()) for v in surface.vertices]
    # STL holds single precision.
    np.testing.assert_allclose(surface.vertices, expected[order], atol=1e-8)
    assert sorted(order) == [0, 1, 2, 3]


def test_meshes_about_other_axes_are_placed_by_a_mapping(model, trial, tmp_path):
    """The same surface, its mesh turned: the mapping turns it back."""
    (tmp_path / "others").mkdir()
    Q, R = turned([0.7, 0.2, -1.1]), turned(FRAME["orientation_xyz"])
    write_mesh(tmp_path / "others" / "cup2.stl", Mesh(CORNERS @ Q.T, FACES))
    back = R @ Q.T
    angles = [
        np.arctan2(-back[1, 2], back[2, 2]),
        np.arcsin(back[0, 2]),
        np.arctan2(-back[0, 1], back[0, 0]),
    ]
    np.testing.assert_allclose(turned(angles), back, atol=1e-15)
    surface = {"name": "cup", "mesh": "cup2.stl", "frame": FRAME | {"orientation_xyz": angles}}
    mapping = tmp_path / "others" / "surfaces.json"
    mapping.write_text(json.dumps({"contact_surfaces": [surface]}), encoding="utf-8")
    expected = scene_at(model, trial, 0).surfaces[0].vertices
    (found,) = scene_at(model, trial, 0, surfaces=surface_files(model, [mapping])).surfaces
    gaps = np.linalg.norm(found.vertices[:, None] - expected, axis=2).min(axis=1)
    assert gaps.max() < 2e-8


def test_what_is_named_later_is_taken_and_the_models_own_folder_last(model, tmp_path):
    (tmp_path / "others").mkdir()
    write_mesh(tmp_path / "others" / "cup.stl", Mesh(CORNERS, FACES))
    assert surface_files(model)["cup"].file == tmp_path / "cup.stl"
    assert surface_files(model, [tmp_path / "others"])["cup"].file.parent.name == "others"
    named = surface_files(model, [tmp_path / "others", f"cup={tmp_path / 'cup.stl'}"])
    assert named["cup"].file == tmp_path / "cup.stl"


def test_no_such_time_frame(model, trial):
    with pytest.raises(ValueError, match="time frame 2: the trial has 0 to 1"):
        scene_at(model, trial, 2)
