# SPDX-License-Identifier: Apache-2.0
"""Both presets articulate like a knee through 0 to 110 degrees of flexion.

The oracle is the meshes themselves: femoral vertices against the interpolated insert mesh.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

from condyle.errors import InputDataError
from condyle.implants import Implant, generate, preset, settle
from condyle.implants.sagittal import femoral_profile


def rotation_TF(theta: np.ndarray) -> np.ndarray:
    """R_TF = Rx(-theta_x) Ry(-theta_y) Rz(-theta_z), built from elementary rotations."""
    cx, cy, cz = np.cos(-theta)
    sx, sy, sz = np.sin(-theta)
    rx = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    ry = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    rz = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return rx @ ry @ rz


class Contact:
    """Vertical gaps between the two meshes of an implant."""

    def __init__(self, implant: Implant) -> None:
        self.implant = implant
        insert = implant.insert.vertices
        self.height = LinearNDInterpolator(insert[:, [0, 2]], insert[:, 1])
        self.insert_border = cKDTree(insert[implant.insert.border_vertices()])
        self.femur_border = cKDTree(implant.femur.vertices[implant.femur.border_vertices()])

    def gaps(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gaps (k,), places (k, 3) and vertex indices (k,) of the femur's lower vertices."""
        placed = self.implant.femur.vertices @ rotation_TF(pose[3:]).T + pose[:3]
        low = np.flatnonzero(placed[:, 1] < placed[:, 1].min() + 0.02)
        height = self.height(placed[low][:, [0, 2]])
        inside = np.isfinite(height)
        low, height = low[inside], height[inside]
        return placed[low, 1] - height, placed[low], low


@pytest.fixture(scope="module")
def contacts(flat: Implant, curved: Implant) -> dict[str, Contact]:
    left = generate(preset("curved", size=0.88, side_of_body="left"))
    large = generate(preset("flat", size=1.2))
    named = {"flat": flat, "curved": curved, "small left curved": left, "large flat": large}
    return {name: Contact(implant) for name, implant in named.items()}


FULL = [(name, flexion) for name in ("flat", "curved") for flexion in range(0, 111, 10)]
ENDS = [(n, f) for n in ("small left curved", "large flat") for f in (0, 55, 110)]


@pytest.mark.parametrize(("name", "flexion_deg"), FULL + ENDS)
def test_both_condyles_touch_well_inside_both_surfaces(
    contacts: dict[str, Contact], name: str, flexion_deg: int
) -> None:
    contact = contacts[name]
    settled = settle(contact.implant, math.radians(flexion_deg))
    gaps, places, vertices = contact.gaps(settled.pose)
    # Interpolation errors: h² / 8R of the insert's flank (19 mm) in both directions is 10 um.
    assert abs(gaps.min()) < 0.02e-3
    medial_sign = 1.0 if contact.implant.parameters.side_of_body == "left" else -1.0
    side_gaps = []
    for row, sign in enumerate((medial_sign, -medial_sign)):
        side = np.flatnonzero(sign * places[:, 2] > 0.0)
        touch = side[np.argmin(gaps[side])]
        side_gaps.append(gaps[touch])
        for place, vertex in (
            (places[touch], vertices[touch]),
            (settled.touch_points[row], settled.femur_vertices[row]),
        ):
            assert abs(place[0]) < 15e-3
            assert sign * place[2] > 10e-3
            assert contact.insert_border.query(place)[0] > 2e-3
            on_femur = contact.implant.femur.vertices[vertex]
            assert contact.femur_border.query(on_femur)[0] > 3e-3
    assert abs(side_gaps[0] - side_gaps[1]) < 0.1e-3
    assert abs(settled.gaps[0] - settled.gaps[1]) < 0.1e-3


@pytest.mark.parametrize("name", ["flat", "curved"])
@pytest.mark.parametrize("flexion_deg", [0, 37, 84, 110])
def test_the_femur_rests_where_it_cannot_sink_further(
    contacts: dict[str, Contact], name: str, flexion_deg: int
) -> None:
    contact = contacts[name]
    pose = settle(contact.implant, math.radians(flexion_deg)).pose
    for shift in ([3e-3, 0.0], [-3e-3, 0.0], [0.0, 1e-3], [0.0, -1e-3]):
        moved = pose + np.array([shift[0], 0.0, shift[1], 0.0, 0.0, 0.0])
        # After a shift the surfaces overlap or touch: the femur would have to rise.
        assert contact.gaps(moved)[0].min() < 0.02e-3
    forward = pose + np.array([3e-3, 0.0, 0.0, 0.0, 0.0, 0.0])
    # Rising on a dish of radius R with a condyle of radius r: dx² / 2 (R - r), at least 80 um.
    assert contact.gaps(forward)[0].min() < -0.07e-3


def test_rest_follows_the_j_curve_on_the_dish(flat: Implant) -> None:
    # On the dish's floor the resting femur touches with surface angle = flexion, at To's x = 0.
    profile = femoral_profile(flat.parameters)
    for flexion in np.radians([0.0, 23.0, 71.0, 104.0]):
        point = profile.point(np.array([flexion]))[0]
        c, s = math.cos(flexion), math.sin(flexion)
        expected = -np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])
        expected[1] += flat.parameters.dish_height
        pose = settle(flat, float(flexion)).pose
        # Height to the mesh's sagitta, h² / 8R = 5 um; x to the flat valley that this leaves,
        # sqrt(2 * 5 um * (R - r)) = 0.6 mm at most.
        assert pose[1] == pytest.approx(expected[1], abs=5e-6)
        assert pose[0] == pytest.approx(expected[0], abs=0.6e-3)


def test_a_sloped_insert_lets_the_femur_rest_further_back() -> None:
    level = preset("curved")
    slope = math.radians(5.0)
    tilted = settle(generate(replace(level, posterior_slope=slope)), 0.6).touch_points
    # The dish's lowest point moves to x = -R sin(slope) (4.7 mm); the mesh leaves 0.6 mm of doubt.
    expected = -level.insert_sagittal_radius * math.sin(slope)
    np.testing.assert_allclose(tilted[:, 0], expected, atol=0.9e-3)


@pytest.mark.parametrize("flexion", [-0.5, 2.5, math.nan])
def test_flexion_out_of_range_is_refused(flat: Implant, flexion: float) -> None:
    with pytest.raises(InputDataError, match=r"flexion = .*: must lie in \[-0\.35, 2\.3\] rad"):
        settle(flat, flexion)
