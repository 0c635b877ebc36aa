# SPDX-License-Identifier: Apache-2.0
"""The insert has the dish, eminence, lips and outline that its parameters promise."""

import math
from dataclasses import replace

import numpy as np
import pytest

from condyle.implants import Implant, preset
from condyle.implants.insert import dish_profile, insert_height, insert_mesh


def test_dish_is_a_circle_of_the_given_radius(implant: Implant, measure) -> None:
    p = implant.parameters
    points = measure.section(implant.insert, 2, p.condyle_centre + 0.3e-3)
    arc = points[np.abs(points[:, 0]) < 13e-3]
    centre, radius, rms = measure.circle(arc)
    sagitta = (1.3 * p.mesh_edge_length) ** 2 / (8.0 * p.insert_sagittal_radius)
    half = math.asin(13e-3 / p.insert_sagittal_radius)
    # The curved compartment's own cross-section adds its chord's sagitta, evenly.
    if p.coronal_profile == "curved":
        sagitta += (1.1 * p.mesh_edge_length) ** 2 / (8.0 * p.insert_coronal_radius)
    assert rms < sagitta
    assert radius == pytest.approx(p.insert_sagittal_radius, abs=sagitta / (1.0 - math.cos(half)))
    assert centre[0] == pytest.approx(0.0, abs=sagitta / half)


def test_dish_is_twice_smooth_and_ends_level_at_the_lips() -> None:
    p = preset("flat", size=1.12)
    front = p.insert_ap_offset + 0.5 * p.insert_ap
    back = p.insert_ap_offset - 0.5 * p.insert_ap
    ends = dish_profile(p, np.array([back, 0.0, front]))
    np.testing.assert_allclose(
        ends, [p.posterior_lip_height, 0.0, p.anterior_lip_height], atol=1e-15
    )
    x = np.linspace(back, front, 40_001)
    step = x[1] - x[0]
    slope = np.diff(dish_profile(p, x)) / step
    curvature = np.diff(slope) / step
    assert abs(slope[0]) < 1e-3
    assert abs(slope[-1]) < 1e-3
    assert (slope[x[:-1] > 1e-4] > -1e-9).all()  # no bump before the lip
    # A jump of curvature would show as a step of order 1/R between neighbours; rounding of second
    # differences is eps y / step² = 1e-4 of that.
    assert np.abs(np.diff(curvature)).max() < 0.05 / p.insert_sagittal_radius


def test_eminence_has_its_height_and_flank_radius(flat: Implant, curved: Implant, measure) -> None:
    for p in (flat.parameters, curved.parameters):
        ridge = insert_height(p, np.zeros(1), np.zeros(1))[0] - p.dish_height
        assert ridge == pytest.approx(p.eminence_height, abs=1e-12)
    p = flat.parameters
    p = replace(p, mesh_edge_length=0.25e-3)
    points = measure.section(insert_mesh(p), 0, 0.2e-3)
    inside = p.condyle_centre - p.flat_half_width
    flank = points[(points[:, 1] > 12.5e-3) & (points[:, 1] < inside - 0.5e-3)]
    flank = flank[:, ::-1]
    _, radius, rms = measure.circle(flank)
    sagitta = (1.3 * p.mesh_edge_length) ** 2 / (8.0 * p.eminence_flank_radius)
    assert rms < sagitta
    half = 0.5 * (inside - 12.5e-3) / p.eminence_flank_radius
    assert radius == pytest.approx(p.eminence_flank_radius, abs=sagitta / (1.0 - math.cos(half)))


def test_flat_compartments_are_flat_and_round_ones_conform(flat: Implant, curved: Implant) -> None:
    p = flat.parameters
    z = np.linspace(p.condyle_centre - p.flat_half_width, 0.5 * p.insert_ml, 50)
    np.testing.assert_allclose(insert_height(p, np.zeros(50), z), p.dish_height, atol=1e-15)
    p = curved.parameters
    assert p.insert_coronal_radius / p.femoral_coronal_radius == pytest.approx(1.1, rel=1e-14)
    offset = np.linspace(-8e-3, 12e-3, 41)
    height = insert_height(p, np.zeros(41), p.condyle_centre + offset) - p.dish_height
    # On a circle of radius R through its lowest point: offset² + height² = 2 R height.
    np.testing.assert_allclose(
        offset**2 + height**2, 2.0 * p.insert_coronal_radius * height, atol=1e-16
    )


def test_height_has_a_continuous_gradient_everywhere(implant: Implant) -> None:
    p = implant.parameters
    generator = np.random.default_rng(20170)
    start = generator.uniform([-0.018, -0.035], [0.023, 0.035], size=(60, 2))
    angle = generator.uniform(0.0, math.pi, size=60)
    step = 5e-6
    along = np.arange(-600, 601) * step
    x = start[:, :1] + np.cos(angle)[:, None] * along
    z = start[:, 1:] + np.sin(angle)[:, None] * along
    slope = np.diff(insert_height(p, x, z), axis=1) / step
    # The strongest curvature is the merger of flank and ridge: under 1 / (1.5 mm).
    assert np.abs(np.diff(slope, axis=1)).max() < step / 1.5e-3


@pytest.mark.parametrize(("name", "size"), [("flat", 0.9), ("curved", 1.15)])
def test_sizes_match_the_parameters(name: str, size: float) -> None:
    p = preset(name, size=size)  # type: ignore[arg-type]
    vertices = insert_mesh(p).vertices
    extent = np.ptp(vertices, axis=0)
    # The outline is rounded: its extremes fall between vertices, and beside the cutout.
    assert extent[0] == pytest.approx(p.insert_ap, rel=3e-3)
    assert extent[2] == pytest.approx(p.insert_ml, rel=3e-3)
    assert vertices[:, 1].min() == pytest.approx(p.dish_height, abs=1e-5)
    assert vertices[:, 0].max() == pytest.approx(p.insert_ap_offset + 0.5 * p.insert_ap, abs=1e-12)


def test_the_ligament_cutout_opens_the_middle_of_the_back(implant: Implant) -> None:
    vertices = implant.insert.vertices
    middle = vertices[vertices[:, 2] == 0.0, 0].min()
    assert middle - vertices[:, 0].min() > 0.2 * implant.parameters.insert_ap


def test_refinement_converges_with_the_square_of_the_edge() -> None:
    p = preset("curved", size=1.04)
    errors = []
    for edge in (1.6e-3, 0.8e-3, 0.4e-3):
        centroids = insert_mesh(replace(p, mesh_edge_length=edge)).centroids()
        error = centroids[:, 1] - insert_height(p, centroids[:, 0], centroids[:, 2])
        errors.append(np.sqrt(np.mean(error**2)))
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] > 1e-9
    np.testing.assert_allclose(slopes, 2.0, atol=0.1)


def test_posterior_slope_lowers_the_back() -> None:
    p = preset("curved", size=0.95)
    slope = math.radians(4.3)
    x, z = np.array([-0.0131, 0.0077]), np.array([0.021, -0.027])
    change = insert_height(replace(p, posterior_slope=slope), x, z) - insert_height(p, x, z)
    np.testing.assert_allclose(change, x * math.tan(slope), atol=1e-15)
    assert change[0] < 0.0 < change[1]
