# SPDX-License-Identifier: Apache-2.0
import hashlib
import struct

import numpy as np
import pytest
from small_implant import box, femur, inserts

from condyle.contact import (
    Derivatives,
    LinearVolumeLaw,
    Mesh,
    MeshContact,
    SignedDistance,
    content_hash,
    rotation_TF,
)

MODULUS = 9.3e9
DEPTH = 0.7e-3
TOUCH = 0.0073 + 0.011  # y where the box's lowest face meets the planes


def test_a_plane_pressed_into_a_plane_is_a_spring_in_closed_form(contact: MeshContact) -> None:
    area = 0.012**2
    pose = np.array([[0.001, TOUCH - DEPTH, 0.0005, 0.0, 0.0, 0.0]])
    loads = contact.evaluate(pose, Derivatives.stiffness, 1)
    force = MODULUS * DEPTH * area
    # Depths come out of coordinates of 0.02: 1e-17 in 7e-4.
    np.testing.assert_allclose(loads.wrench[0, :, 1], force, rtol=1e-12)
    np.testing.assert_allclose(loads.stiffness[0, :, 1, 1], -MODULUS * area, rtol=1e-12)
    assert loads.wrench.shape == (1, 2, 6)
    assert loads.trust.tolist() == [1.0]
    assert not loads.implausible_depth[0]
    detail = contact.evaluate_details(pose, 1)
    np.testing.assert_allclose(detail.energy[0], 0.5 * MODULUS * DEPTH**2 * area, rtol=1e-12)
    np.testing.assert_allclose(detail.volume[0], DEPTH * area, rtol=1e-12)
    np.testing.assert_allclose(detail.area[0], area, rtol=1e-12)
    np.testing.assert_allclose(detail.max_depth[0], DEPTH, rtol=1e-12)
    np.testing.assert_allclose(detail.peak_pressure[0], MODULUS * DEPTH, rtol=1e-12)
    np.testing.assert_allclose(detail.mean_pressure[0], MODULUS * DEPTH, rtol=1e-12)
    np.testing.assert_array_equal(detail.border_area, 0.0)
    expected = [[0.003, 0.0073, -0.021], [0.003, 0.0073, 0.021]]
    np.testing.assert_allclose(detail.centre_of_pressure[0], expected, atol=1e-15)
    np.testing.assert_array_equal(detail.wrench, loads.wrench)
    for pressure in contact.face_pressures(pose[0]):
        np.testing.assert_allclose(pressure, MODULUS * DEPTH, rtol=1e-12)


def test_settings_reach_the_core() -> None:
    law = LinearVolumeLaw(modulus=3.1e9)
    soft = MeshContact(femur(), *inserts(), "right", law=law, plausible_depth=0.5e-3)
    assert soft.law_name() == "linear_volume"
    assert soft.law_parameters() == [("modulus_N_per_m3", 3.1e9)]
    assert soft.settings.plausible_depth == 0.5e-3
    pose = np.array([[0.0, TOUCH - DEPTH, 0.0, 0.0, 0.0, 0.0]])
    loads = soft.evaluate(pose, Derivatives.none, 1)
    np.testing.assert_allclose(loads.wrench[0, :, 1], 3.1e9 * DEPTH * 0.012**2, rtol=1e-12)
    assert loads.stiffness is None
    assert loads.implausible_depth[0]
    assert soft.insert_width == pytest.approx(0.054, rel=1e-12)


def test_meshes_come_back_as_read_only_views(contact: MeshContact) -> None:
    made = femur()
    np.testing.assert_array_equal(contact.femur.vertices, made.vertices)
    np.testing.assert_array_equal(contact.insert_lateral.faces, inserts()[1].faces)
    with pytest.raises(ValueError, match="read-only"):
        contact.femur.vertices[0, 0] = 1.0
    packed = struct.pack("<qq", len(made.vertices), len(made.faces))
    digest = hashlib.sha256(packed + made.vertices.tobytes() + made.faces.tobytes()).hexdigest()
    assert content_hash(made) == digest
    assert contact.mesh_hashes()["femur"] == digest


def test_signed_distance_of_a_box() -> None:
    surface = SignedDistance(box((0.01, 0.02, 0.03), (0.05, 0.0, 0.0)))
    distance, gradient = surface.query(np.array([[0.05, 0.005, 0.001], [0.067, 0.0, 0.0]]))
    np.testing.assert_allclose(distance, [-0.01, 0.007], atol=1e-16)
    np.testing.assert_allclose(gradient[1], [1.0, 0.0, 0.0], atol=1e-15)


def test_rotation_of_a_pose_is_a_rotation() -> None:
    R = rotation_TF(np.array([0.01, 0.04, 0.0, 0.1, -0.2, -0.9]))
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"side_of_body": "both"}, "side_of_body is 'both': must be 'left' or 'right'"),
        ({"evaluation": "rough"}, "evaluation is 'rough': must be 'exact' or 'fast'"),
        ({"plausible_depth": 0.0}, "plausible_depth is 0.000000 m: must be finite"),
        ({"side_of_body": "left"}, "insert \\(medial\\): lies about z = -21 mm but in a left knee"),
        ({"femur": box((0.02, -0.011, 0.04), (0, 0, 0))}, "femur: normals point inwards"),
    ],
)
def test_what_cannot_be_a_contact_is_refused(change: dict[str, object], text: str) -> None:
    medial, lateral = inserts()
    arguments: dict[str, object] = {
        "femur": femur(),
        "insert_medial": medial,
        "insert_lateral": lateral,
        "side_of_body": "right",
    }
    with pytest.raises(ValueError, match=text):
        MeshContact(**{**arguments, **change})  # type: ignore[arg-type]


def test_a_mesh_of_another_kind_is_refused() -> None:
    with pytest.raises(ValueError, match="mesh: a face uses vertex 9 of 3"):
        Mesh(np.zeros((3, 3)), np.array([[0, 1, 9]], np.int32))
    with pytest.raises(TypeError):
        Mesh(np.zeros((3, 2)), np.array([[0, 1, 2]], np.int32))


def test_a_pose_that_is_not_finite_is_named(contact: MeshContact) -> None:
    poses = np.zeros((3, 6))
    poses[2, 4] = np.nan
    with pytest.raises(ValueError, match="row 2: pose: theta_y is nan: must be finite"):
        contact.evaluate_details(poses, 1)
