# SPDX-License-Identifier: Apache-2.0
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from condyle.contact import Derivatives, MeshContact, read_implant, refine_mesh
from condyle.errors import InputDataError
from condyle.fdk import SeatingSettings, first_touch, load_seated, seated_pose
from condyle.implants import generate, preset, settle


@pytest.fixture(scope="module")
def data() -> Path:
    named = os.environ.get("CONDYLE_DATA")
    folder = Path(named) if named else Path(__file__).parents[3].parent / "shared" / "data"
    if not (folder / "implants").is_dir():
        pytest.skip("no implants: set CONDYLE_DATA, or put shared/data beside the project")
    return folder / "implants"


def near_contact() -> SeatingSettings:
    """Starts lower than by default: `exact` evaluation is slow far from contact."""
    settings = SeatingSettings()
    settle_settings = settings.settle
    touch = settle_settings.touch
    touch.y_high = 0.045
    settings.farthest = 0.05
    settle_settings.touch = touch
    settings.settle = settle_settings
    return settings


def test_first_touch_does_not_depend_on_the_start(right_knee):
    pose = np.array([0.0055, 0.0, 0.0007, 0.003, 0.011, -0.17])
    heights = []
    for start in (0.02, 0.043, 0.3, np.nan):
        pose[1] = start
        touch = first_touch(right_knee, pose)
        assert touch.converged
        heights.append(touch.pose[1])
        np.testing.assert_array_equal(np.delete(touch.pose, 1), np.delete(pose, 1))
    assert len(set(heights)) == 1
    # Just above there is nothing, at it there is load: within the tolerance of 1e-9 m.
    at = np.array([touch.pose, touch.pose])
    at[1, 1] += 1.1e-9
    loaded, free = right_knee.evaluate(at, Derivatives.none, threads=1).wrench[:, :, 1].sum(axis=1)
    assert loaded > 0.0
    assert free == 0.0


@pytest.mark.parametrize("flexion", [0.0, 0.8])
def test_the_built_in_implant_seats_where_its_profiles_do(right_knee, flexion):
    """Against its own search, on the insert's formula; the mesh has edges of h = 1.1 mm."""
    p = preset("curved")
    expected = settle(generate(replace(p, mesh_edge_length=1.1e-3)), flexion).pose
    seat = seated_pose(right_knee, flexion)
    assert seat.converged
    x, y, z = seat.pose[:3]
    # Chords of the condyle (radius R) fall short of it by h²/8R, and the insert's centroids lie off its arc
    # likewise; x is within √(2·a·that) of the bottom of a bowl of radius a = r·R/(r − R), r the insert's.
    R = p.femoral_distal_radius if flexion == 0.0 else p.femoral_mid_radius
    r, h = p.insert_sagittal_radius, 1.1e-3
    sag = h * h / 8 * (1 / R + 1 / r + 1 / p.femoral_coronal_radius + 1 / p.insert_coronal_radius)
    assert y == pytest.approx(expected[1], abs=sag)
    assert x == pytest.approx(expected[0], abs=np.sqrt(2 * sag * r * R / (r - R)))
    b = 1 / (1 / p.femoral_coronal_radius - 1 / p.insert_coronal_radius)
    assert z == pytest.approx(0.0, abs=np.sqrt(2 * sag * b))
    np.testing.assert_array_equal(seat.pose[3:], [0.0, 0.0, -flexion])


def test_left_and_right_seat_in_mirror_images(right_knee, left_knee):
    right, left = (seated_pose(knee, 0.4).pose for knee in (right_knee, left_knee))
    # The meshes are mirror images; polls are not, and end within the last ring's reach of the same place.
    assert left[1] == pytest.approx(right[1], abs=1e-7)
    assert left[0] == pytest.approx(right[0], abs=1e-4)


def test_a_load_presses_the_femur_down_where_it_sits(right_knee):
    seat = seated_pose(right_knee, 0.4)
    found = load_seated(right_knee, seat, 640.0, Mx=0.7)
    assert found.converged[0]
    np.testing.assert_array_equal(found.poses[0, [0, 2, 4, 5]], seat.pose[[0, 2, 4, 5]])
    assert found.poses[0, 1] < seat.pose[1]
    total = found.wrenches[0].sum(axis=0)
    assert total[1] == pytest.approx(640.0, abs=0.65)  # 0.1 % + 0.01 N
    assert total[3] == pytest.approx(0.7, abs=0.0012)  # 0.1 % + 0.0005 Nm


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "edge_mm", "x", "y", "z"),
    [("dm", 1.0, 6.404, 41.107, -0.218), ("jw", 0.7, -1.625, 42.508, -0.010)],
)
def test_real_implants_seat_where_an_independent_search_put_them(data, name, edge_mm, x, y, z):
    """JW's insert, faces 1.1 mm wide, is refined: its centroids stand 5 µm below its vertices."""
    meshes = read_implant(
        femur=data / name / "femur_contact.stl",
        insert_medial=data / name / "insert_contact_medial.stl",
        insert_lateral=data / name / "insert_contact_lateral.stl",
        units="m",
        side_of_body="right",
    )
    for part in ("insert_medial", "insert_lateral"):
        meshes[part] = refine_mesh(meshes[part], 1e-3 * edge_mm)
    seat = seated_pose(MeshContact(**meshes, side_of_body="right"), settings=near_contact())
    assert seat.status == "converged"
    mm = 1e3 * seat.pose[:3]
    assert mm[0] == pytest.approx(x, abs=0.1)
    assert mm[1] == pytest.approx(y, abs=0.005)
    assert mm[2] == pytest.approx(z, abs=0.3)


def test_mistakes_are_named(right_knee):
    with pytest.raises(InputDataError, match=r"pose has shape \(3,\)"):
        first_touch(right_knee, np.zeros(3))
    with pytest.raises(InputDataError, match="flexion is nan"):
        seated_pose(right_knee, np.nan)
    settings = SeatingSettings()
    settings.disc_radius = -1.0
    with pytest.raises(InputDataError, match="disc_radius is -1"):
        seated_pose(right_knee, 0.0, settings)
    beside = first_touch(right_knee, np.array([0.09, 0.0, 0.0, 0.0, 0.0, 0.0]), near_contact())
    assert (beside.status, beside.converged) == ("no_contact", False)
    assert "origins" in beside.advice
