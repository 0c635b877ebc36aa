# SPDX-License-Identifier: Apache-2.0
"""Which faces of a femoral component are its trochlea, and what is refused because it has none."""

import os
from pathlib import Path

import numpy as np
import pytest
from patella_model import button_mesh, femur_mesh
from scipy.spatial.transform import Rotation

from condyle._core.geometry import Mesh
from condyle.contact import read_mesh
from condyle.errors import InputDataError
from condyle.model.trochlea import fit_trochlea


@pytest.fixture(scope="module")
def right():
    return fit_trochlea(femur_mesh("right"))


def moved(mesh, R):
    return Mesh(np.ascontiguousarray(np.asarray(mesh.vertices) @ R.T), np.asarray(mesh.faces))


def implants_folder():
    root = Path(os.environ.get("CONDYLE_DATA", Path(__file__).parents[4] / "shared" / "data"))
    if not (root / "implants" / "dm" / "femur_contact.stl").is_file():
        pytest.skip(f"real implants are not at {root} (set CONDYLE_DATA)")
    return root / "implants"


def test_the_groove_s_floor_is_chosen_and_nothing_else(right):
    mesh = femur_mesh("right")
    vertices, corners = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    centroids = vertices[corners[right.faces]].mean(axis=1)
    assert len(right.faces) == right.cylinder.points > 100
    # In front of the notch and below the flange's straight part; a groove about the middle.
    assert centroids[:, 0].min() > 0.0
    assert np.abs(centroids[:, 2]).max() < 0.012
    assert np.abs(centroids[:, 2].mean()) < 1e-4
    away = np.linalg.norm(np.cross(centroids - right.cylinder.centre, right.cylinder.axis), axis=1)
    np.testing.assert_allclose(
        away, right.cylinder.radius, rtol=0, atol=right.cylinder.largest + 1e-9
    )


def test_a_symmetric_component_has_its_axis_straight_across(right):
    fit = right.cylinder
    assert fit.axis[2] > 0.0
    np.testing.assert_allclose(fit.axis, [0, 0, 1], rtol=0, atol=1e-9)
    # The femoral component is some 65 mm deep: a trochlea has about half of that as radius.
    assert 0.028 < fit.radius < 0.040
    assert fit.rms < 0.3e-3 and fit.converged
    assert np.degrees(fit.arc) > 50.0


def test_a_left_component_s_axis_is_the_right_one_s_mirrored(right):
    # Mirrored by hand and tilted, so that the axis is not straight across.
    one = moved(femur_mesh("right"), Rotation.from_rotvec([0.02, 0.03, 0.01]).as_matrix())
    mirror = np.diag([1.0, 1.0, -1.0])
    other = Mesh(
        np.ascontiguousarray(np.asarray(one.vertices) @ mirror),
        np.ascontiguousarray(np.asarray(one.faces)[:, ::-1]),
    )
    a, b = fit_trochlea(one).cylinder, fit_trochlea(other).cylinder
    assert abs(a.axis[0]) > 0.01
    np.testing.assert_allclose(b.axis, a.axis * [-1, -1, 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(b.centre, a.centre * [1, 1, -1], rtol=0, atol=1e-10)
    assert b.radius == pytest.approx(a.radius, rel=1e-9)


@pytest.mark.parametrize(("name", "radius_mm"), [("dm", 32.5), ("jw", 35.8)])
def test_real_components_look_like_trochleae(name, radius_mm):
    mesh = read_mesh(implants_folder() / name / "femur_contact.stl", "m")
    fit = fit_trochlea(mesh, name).cylinder
    # Radii of 32 to 37 mm come of any reasonable choice of faces; this one's is what is pinned.
    assert 1e3 * fit.radius == pytest.approx(radius_mm, abs=0.3)
    assert fit.rms < 0.35e-3
    assert np.degrees(fit.arc) > 60.0
    assert angle_from_z(fit.axis) < 2.0
    # The bone's side of a closed solid faces the other way and is left alone.
    solid = fit_trochlea(
        read_mesh(implants_folder() / name / "femur_solid.stl", "m"), name
    ).cylinder
    assert 1e3 * solid.radius == pytest.approx(1e3 * fit.radius, abs=0.1)
    assert angle_from_z(solid.axis) < 2.0


def angle_from_z(axis):
    return np.degrees(np.arccos(np.clip(axis[2], -1.0, 1.0)))


TURNED = {
    "back to front": np.diag([-1.0, 1.0, -1.0]),
    "upside down": np.diag([-1.0, -1.0, 1.0]),
}


@pytest.mark.parametrize("how", TURNED)
def test_a_mesh_in_other_axes_is_refused(how):
    with pytest.raises(InputDataError, match=r"'femoral' does not look like a trochlea"):
        fit_trochlea(moved(femur_mesh("right"), TURNED[how]), "femoral")


def test_what_has_no_trochlea_is_refused_by_value_and_limit():
    with pytest.raises(
        InputDataError,
        match=r"surface 'button' does not look like a trochlea \(x anterior, y superior, z right\): 0 connected faces "
        r"of its middle look forward and down: must be at least 30",
    ):
        fit_trochlea(button_mesh(), "button")
    cylinder = bent_sheet(arc_deg=(20.0, 45.0), bump=0.0)
    with pytest.raises(
        InputDataError, match=r"reach over 2\d(\.\d)?° of a cylinder: must be at least 40°"
    ):
        fit_trochlea(cylinder, "short")
    rough = bent_sheet(arc_deg=(0.0, 80.0), bump=3e-3)
    with pytest.raises(InputDataError, match=r"mm RMS off a cylinder: must be at most 0\.5 mm"):
        fit_trochlea(rough, "rough")
    aside = bent_sheet(arc_deg=(0.0, 80.0), bump=0.0, aside=True)
    with pytest.raises(InputDataError, match=r"mm from its middle: must be at most 1\d(\.\d)? mm"):
        fit_trochlea(aside, "aside")


def test_an_exact_cylinder_is_found_in_the_sheet():
    fit = fit_trochlea(bent_sheet(arc_deg=(0.0, 80.0), bump=0.0)).cylinder
    # Facets of an inscribed polygon lie a sagitta inside: 33 mm (1 − cos(0.5°)) / 2.
    assert fit.radius == pytest.approx(0.033, abs=2e-6)
    assert fit.rms < 1e-6


def bent_sheet(arc_deg, bump, aside=False):
    """A sheet of 70 mm along z, round where it looks forward and down; `bump`: of its radius, once over the arc.

    With `aside`, only a strip beside its middle looks forward, and the rest of it backwards.
    """
    angles = np.radians(np.arange(arc_deg[0], arc_deg[1] + 0.5, 1.0))
    z = np.arange(-0.035, 0.0351, 1e-3)
    radius = 0.033 + bump * np.sin(2 * np.pi * (angles - angles[0]) / np.ptp(angles))
    outline = np.stack([radius * np.cos(angles), -radius * np.sin(angles)], axis=1)
    vertices = np.array([[x, y, w] for x, y in outline for w in z])
    faces = []
    for i in range(len(angles) - 1):
        for k in range(len(z) - 1):
            a, b = i * len(z) + k, (i + 1) * len(z) + k
            # To the right, then downwards along the arc: counter-clockwise seen from outside.
            quad = [[a, a + 1, b], [a + 1, b + 1, b]]
            inwards = aside and abs(z[k] - 0.0145) > 0.003
            faces += [face[::-1] for face in quad] if inwards else quad
    return Mesh(np.ascontiguousarray(vertices), np.array(faces, dtype=np.int32))
