# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from condyle.contact import contact_map
from condyle.errors import InputDataError

POSE = np.array([0.002, 0.0073 + 0.011 - 0.0004, 0.001, 0.0, 0.0, 0.0])


def test_a_map_holds_what_the_faces_carry(contact):
    found = contact_map(contact, POSE)
    assert found.status == "ok"
    assert found.side_of_body == "right"
    assert "9.3e+09" in found.law
    for i, side in enumerate(found.sides.values()):
        # Planes: depth 0.4 mm on all of the 12 mm square.
        np.testing.assert_allclose(side.depth, 0.4e-3, rtol=1e-9)
        np.testing.assert_allclose(side.pressure, 9.3e9 * 0.4e-3, rtol=1e-9)
        assert side.wrench[1] == pytest.approx(9.3e9 * 0.4e-3 * 0.012**2, rel=1e-9)
        assert side.area == pytest.approx(0.012**2, rel=1e-9)
        np.testing.assert_allclose(
            side.centre_of_pressure, [0.003, 0.0073, (-0.021, 0.021)[i]], atol=1e-12
        )
    assert found.peak_pressure == pytest.approx(9.3e9 * 0.4e-3, rel=1e-9)


def test_the_femur_is_placed_in_the_tibial_frame(contact):
    pose = np.array([0.004, 0.05, -0.003, 0.0, 0.0, -np.pi / 2])
    found = contact_map(contact, pose)
    local = np.asarray(contact.femur.vertices)
    # R_TF = Rz(−θz): flexion by 90° takes the femoral x axis to y_T and y to −x_T.
    turned = np.stack([-local[:, 1], local[:, 0], local[:, 2]], axis=1) + pose[:3]
    np.testing.assert_allclose(found.femur_vertices, turned, atol=1e-15)
    assert found.peak_pressure == 0.0


def test_a_pose_of_another_shape_is_refused(contact):
    with pytest.raises(InputDataError, match=r"pose has shape \(1, 6\)"):
        contact_map(contact, POSE[None])
