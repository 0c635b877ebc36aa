# SPDX-License-Identifier: Apache-2.0
"""The femoral mesh has the radii, widths and shape that its parameters promise."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from condyle.implants import Implant, generate, preset
from condyle.implants.femur import femur_mesh, femur_surface
from condyle.implants.sagittal import femoral_profile

# Surface angles inside each arc, degrees, and the parameter that holds there.
ARCS = [
    (-38.0, 4.0, "femoral_distal_radius"),
    (11.0, 59.0, "femoral_mid_radius"),
    (81.0, 145.0, "femoral_posterior_radius"),
]


@pytest.mark.parametrize(("start", "end", "field"), ARCS)
def test_sagittal_sections_are_circles_of_the_given_radii(
    implant: Implant, measure, start: float, end: float, field: str
) -> None:
    p = implant.parameters
    radius = getattr(p, field)
    profile = femoral_profile(p)
    start, end = math.radians(start), math.radians(end)
    ends = profile.point(np.array([start, end]))
    centre = ends[0] - radius * np.array([-math.sin(start), -math.cos(start)])
    points = measure.section(implant.femur, 2, -p.condyle_centre)
    angle = np.arctan2(-(points[:, 0] - centre[0]), -(points[:, 1] - centre[1]))
    arc = points[(angle > start) & (angle < end)]
    fitted, found, rms = measure.circle(arc)
    # Section points lie on chords: within the sagitta h²/8R of the arc. A radial error e spread
    # over an arc of half angle b changes the fitted radius by at most about e / (1 - cos b).
    sagitta = (1.3 * p.mesh_edge_length) ** 2 / (8.0 * radius)
    assert rms < sagitta
    assert found == pytest.approx(radius, abs=sagitta / (1.0 - math.cos(0.5 * (end - start))))
    np.testing.assert_allclose(fitted, centre, atol=sagitta / (1.0 - math.cos(0.5 * (end - start))))


@pytest.mark.parametrize(("name", "size"), [("flat", 0.84), ("flat", 1.0), ("curved", 1.17)])
def test_sizes_match_the_parameters(name: str, size: float) -> None:
    p = preset(name, size=size)  # type: ignore[arg-type]
    vertices = femur_mesh(p).vertices
    # Extremes fall between vertices: a chord of the smallest radius there, h²/8R, is 8 um.
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    assert high[0] - low[0] == pytest.approx(p.femoral_ap, abs=2e-5)
    assert high[2] - low[2] == pytest.approx(p.femoral_ml, abs=1e-9)
    assert low[1] == pytest.approx(-p.distal_point_height, abs=2e-5)
    assert high[1] == pytest.approx(p.flange_height, abs=2e-5)
    condyle = vertices[vertices[:, 0] < -p.distal_point_offset]
    top = condyle[:, 1].max() + p.distal_point_height
    assert top == pytest.approx(p.posterior_condyle_height, abs=2e-5)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_condyles_stand_at_the_given_spacing(implant: Implant, sign: float) -> None:
    p = implant.parameters
    vertices = implant.femur.vertices[sign * implant.femur.vertices[:, 2] > 0.0]
    low = vertices[vertices[:, 1] < vertices[:, 1].min() + 1e-9, 2]
    middle = 0.5 * (low.min() + low.max())
    # A flat's ends are seen to one edge length each.
    assert middle == pytest.approx(sign * 0.5 * p.condyle_spacing, abs=p.mesh_edge_length)
    assert np.ptp(low) == pytest.approx(2.0 * p.flat_half_width, abs=2.0 * p.mesh_edge_length)


def test_flat_condyles_are_flat_and_curved_ones_round(
    flat: Implant, curved: Implant, measure
) -> None:
    for implant, points in [(i, measure.section(i.femur, 0, -0.0113)) for i in (flat, curved)]:
        p = implant.parameters
        y, z = points[points[:, 0] < -0.020].T  # the lower sheet
        off = np.abs(z) - p.condyle_centre
        if p.coronal_profile == "flat":
            on = np.abs(off) < p.flat_half_width - p.mesh_edge_length
            assert on.sum() > 30
            assert np.ptp(y[on]) < 1.2 * p.mesh_edge_length**2 / (8.0 * p.femoral_distal_radius)
        else:
            # Tilted by asin(4.5/38) = 7 degrees from the normal: depth d shows as y up to
            # d / cos, 0.7 %, and the arc itself moves by as little.
            on = np.abs(off) < 8e-3
            _, radius, _ = measure.circle(np.column_stack([off[on], y[on]]))
            assert radius == pytest.approx(p.femoral_coronal_radius, rel=0.01)


def test_notch_is_open_behind_its_front_and_the_groove_runs_before_it(implant: Implant) -> None:
    p, vertices = implant.parameters, implant.femur.vertices
    profile = femoral_profile(p)
    front = profile.point(np.array([p.notch_angle]))[0]
    behind = vertices[vertices[:, 0] < -p.distal_point_offset]
    assert np.abs(behind[:, 2]).min() == pytest.approx(0.5 * p.notch_width, abs=1e-6)
    middle = vertices[vertices[:, 2] == 0.0]
    assert len(middle) > 50
    assert middle[:, 0].min() > front[0] - p.groove_depth
    # On the flange's line the normal is +x: the groove lies its depth behind the ridge.
    ridge = vertices[vertices[:, 1] > 0.006, 0].max()
    on_flange = middle[middle[:, 1] > 0.006]
    np.testing.assert_allclose(ridge - on_flange[:, 0], p.groove_depth, atol=1e-12)


def test_surface_needs_no_smoothing(implant: Implant, measure) -> None:
    p = implant.parameters
    angle, place = measure.turns(implant.femur)
    articular = (np.abs(np.abs(place[:, 2]) - p.condyle_centre) < 6e-3) & (place[:, 0] < 0.0)
    # Neighbouring faces turn by edge / radius; cells are up to 1.1 edges, diagonals see both ways.
    radius = min(p.femoral_posterior_radius, p.femoral_coronal_radius)
    assert articular.sum() > 5000
    assert angle[articular].max() < 1.6 * p.mesh_edge_length / radius
    # The sharpest place by design is the notch's edge.
    sharpest = 0.5 * p.femoral_edge_radius
    assert angle.max() < 2.0 * p.mesh_edge_length / sharpest


@pytest.mark.parametrize("name", ["flat", "curved"])
def test_tangents_are_continuous_across_the_articular_surface(name: str) -> None:
    surface = femur_surface(preset(name))  # type: ignore[arg-type]
    profile = surface.sagittal
    step = 1e-5  # m along the surface
    lengths = profile.arc_length(np.radians(np.linspace(-10.0, 138.0, 75)))[:, None]
    across = np.arange(-5e-3, 5e-3, step)[None, :]  # over the junction of inner and outer part
    inner = 1.0 + np.minimum(across, 0.0) / surface.coronal.leg.length
    outer = np.maximum(across, 0.0) / surface.coronal.outer.length
    points = surface.point(*np.broadcast_arrays(lengths, inner, outer))
    tangent = np.diff(points, axis=1)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    turn = np.linalg.norm(np.diff(tangent, axis=1), axis=-1)
    # Coronal radius 25 mm or infinite; corner rounding slides rows by up to a few per cent.
    assert turn.max() < 1.5 * step / preset("curved").femoral_coronal_radius


def test_refinement_converges_to_one_surface_with_the_square_of_the_edge() -> None:
    p = preset("flat", size=1.07)
    profile = femoral_profile(p)
    # The nearest of points 5e-6 rad apart misses the foot by 1e-7 m, the distance by 1e-12 m.
    table = np.linspace(profile.angles[2], profile.angles[-1], 600_001)
    tree = cKDTree(profile.point(table))
    errors = []
    for edge in (1.6e-3, 0.8e-3, 0.4e-3):
        centroids = femur_mesh(replace(p, mesh_edge_length=edge)).centroids()
        z = np.abs(centroids[:, 2]) - p.condyle_centre
        inner_arcs = centroids[:, 0] < -p.distal_point_offset
        on_flat = centroids[(np.abs(z) < p.flat_half_width - edge) & inner_arcs]
        nearest = tree.query(on_flat[:, :2])[0]
        errors.append(np.sqrt(np.mean(nearest**2)))
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] > 1e-9
    np.testing.assert_allclose(slopes, 2.0, atol=0.1)


def test_insert_and_femur_are_the_same_at_any_mesh_edge() -> None:
    p = preset("curved")
    coarse = generate(replace(p, mesh_edge_length=1.3e-3))
    fine = generate(replace(p, mesh_edge_length=0.65e-3))
    for a, b in ((coarse.femur, fine.femur), (coarse.insert, fine.insert)):
        areas = [np.linalg.norm(m.area_vectors(), axis=1).sum() for m in (a, b)]
        # Chordal area deficit, (h / R)² / 12 with the 2 mm notch edge the worst: under 1 %.
        assert areas[0] == pytest.approx(areas[1], rel=0.01)
