# SPDX-License-Identifier: Apache-2.0
"""What tests/benchmarks/dm_fluoroscopy.py compares with is read rightly: its poses leave the real parts in touch."""

import os
from pathlib import Path

import numpy as np
import pytest

from condyle.contact import MeshContact, rotation_TF

ROOT = Path(__file__).parents[3]
DATA = Path(os.environ.get("CONDYLE_DATA", ROOT.parent / "shared" / "data"))
FILE = DATA / "subjects" / "dm" / "fluoroscopy" / "fluoroscopy_gait.csv"
IMPLANT = DATA / "implants" / "dm"


@pytest.fixture(autouse=True)
def benchmarks_folder(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tests" / "benchmarks"))


@pytest.fixture
def measured():
    if not FILE.exists():
        pytest.skip(f"no shared data: {FILE}")
    from fluoroscopy_gait import read_fluoroscopy

    return read_fluoroscopy(FILE)


@pytest.fixture(scope="module")
def contact():
    if not IMPLANT.exists():
        pytest.skip(f"no shared data: {IMPLANT}")
    return MeshContact.from_files(
        femur=IMPLANT / "femur_contact.stl",
        insert=IMPLANT / "insert_contact.stl",
        units="m",
        side_of_body="right",
        evaluation="exact",
    )


def test_body_fixed_angles_turn_about_axes_that_turn_along():
    from fluoroscopy_gait import body_fixed

    a, b, c = 0.3, -0.2, 0.7
    rx = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    ry = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    rz = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    angles = np.array([[a, b, c]])
    np.testing.assert_allclose(body_fixed(angles, "xyz")[0], rx @ ry @ rz, atol=1e-15)
    np.testing.assert_allclose(body_fixed(angles, "zyx")[0], rz @ ry @ rx, atol=1e-15)


def test_poses_are_the_files_rotations_and_positions(measured):
    rotations = np.array([rotation_TF(np.ascontiguousarray(pose)) for pose in measured.poses])
    # The file has 8 digits.
    np.testing.assert_allclose(rotations, measured.rotations, atol=2e-8)
    # x and z of the source point the other way.
    turned = measured.native_position * [-1.0, 1.0, -1.0]
    np.testing.assert_allclose(measured.poses[:, :3], turned, atol=1e-9)
    assert np.degrees(measured.kinematics[:, 0]).min() == pytest.approx(5.3, abs=0.1)
    assert np.degrees(measured.kinematics[:, 0]).max() == pytest.approx(53.2, abs=0.1)
    # Clinical flexion and an angle about z differ by the other two angles' product, 0.17 × 0.03 at most.
    np.testing.assert_allclose(
        np.degrees(measured.kinematics[:, 0]), measured.flexion, atol=np.degrees(0.005)
    )


def test_as_read_the_parts_touch_and_by_other_readings_less(measured, contact):
    from fluoroscopy_gait import other_readings, vertical_gaps

    every = slice(0, 101, 10)
    gaps = vertical_gaps(contact, measured.poses[every])
    # The file's gaps are of points of one mesh above the other, these of face centroids 0.7 mm apart.
    np.testing.assert_allclose(gaps, measured.gaps[every], atol=4e-5)
    spread = {
        name: np.ptp(vertical_gaps(contact, poses[every]), axis=0).sum()
        for name, poses in other_readings(measured).items()
    }
    as_read, rebuilt, *others = spread.values()
    assert rebuilt == pytest.approx(as_read, abs=1e-6)
    assert as_read < 0.9 * min(others), spread


def test_vertical_gaps_are_heights(measured, contact):
    from fluoroscopy_gait import vertical_gaps

    pose = measured.poses[30:31]
    raised = pose.copy()
    raised[:, 1] += 1.2e-3
    # Each is found to a tenth of a micrometre.
    np.testing.assert_allclose(
        vertical_gaps(contact, raised) - vertical_gaps(contact, pose), 1.2e-3, atol=2e-7
    )


def test_a_rounded_clock_becomes_even():
    from dm_trial import even_clock

    even = 0.44 + np.arange(668) / 120.0
    repaired = even_clock(np.round(even, 3), 120.0)
    np.testing.assert_allclose(np.diff(repaired), 1.0 / 120.0, atol=1e-12)
    # The mean of 668 roundings of ±0.5 ms.
    np.testing.assert_allclose(repaired, even, atol=5e-5)
