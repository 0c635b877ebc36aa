# SPDX-License-Identifier: Apache-2.0
"""The J-curve: what its radii and angles promise holds for its points."""

import math
from dataclasses import replace

import numpy as np
import pytest

from condyle.implants import preset
from condyle.implants.sagittal import SagittalProfile, femoral_profile


@pytest.fixture(params=[0.87, 1.13])
def profile(request: pytest.FixtureRequest) -> SagittalProfile:
    return femoral_profile(preset("flat", size=request.param))


def test_points_are_the_integral_of_the_radius(profile: SagittalProfile) -> None:
    # Composite Simpson with 2000 steps a segment: error ~ (width/2000)^4 / 180, far below 1e-12.
    for start, end in zip(profile.angles[:-1], profile.angles[1:], strict=True):
        angle = np.linspace(start, end, 2001)
        inside = angle.copy()
        inside[-1] -= 1e-13  # the end belongs to the next segment
        speed = -profile.radius(inside)[:, None] * np.stack([np.cos(angle), -np.sin(angle)], -1)
        weights = np.ones(2001)
        weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
        chord = weights @ speed * (end - start) / 6000.0
        ends = profile.point(np.array([start, end]))
        np.testing.assert_allclose(ends[1] - ends[0], chord, atol=1e-12)


def test_tangent_is_continuous_and_perpendicular_to_the_normal(profile: SagittalProfile) -> None:
    step = 1e-5
    for angle in [*profile.angles[1:-1], -1.1, 0.04, 0.131, 1.3, 2.2]:
        before, here, after = profile.point(np.array([angle - step, angle, angle + step]))
        tangent = np.array([-math.cos(angle), math.sin(angle)])
        for chord in (here - before, after - here):
            # A chord over the angle `step` turns by step / 2 from the tangent at its end.
            turn = (chord[0] * tangent[1] - chord[1] * tangent[0]) / np.linalg.norm(chord)
            assert abs(turn) < 0.51 * step
            assert chord @ tangent > 0.0


def test_curvature_is_continuous_across_blends(profile: SagittalProfile) -> None:
    inner = profile.angles[1:-1]
    jump = profile.radius(inner - 1e-9) - profile.radius(inner + 1e-9)
    np.testing.assert_allclose(jump, 0.0, atol=1e-10)
    assert np.ptp(profile.radius(inner)) > 0.015  # it does change from 38 mm to 17.5 mm


def test_blends_of_no_width_leave_tangent_continuous_arcs() -> None:
    p = replace(preset("flat"), mid_start_angle=math.radians(5.0), mid_end_angle=math.radians(80.0))
    profile = femoral_profile(p)
    angles = np.radians([4.99, 5.01, 79.99, 80.01])
    np.testing.assert_allclose(profile.radius(angles), [38e-3, 26e-3, 26e-3, 17.5e-3], rtol=1e-12)
    gap = profile.point(profile.angles[1:-1] - 1e-12) - profile.point(profile.angles[1:-1])
    assert np.abs(gap).max() < 1e-12


def test_arc_length_is_the_length_of_the_points_and_inverts(profile: SagittalProfile) -> None:
    angle = np.linspace(profile.angles[0], profile.angles[-1], 20001)
    points = profile.point(angle)
    # Chords are shorter than arcs by (d angle)² / 24 = 2e-9 of their length.
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert profile.arc_length(angle[-1:])[0] == pytest.approx(length, rel=1e-8)
    found, back = profile.at_arc_length(profile.arc_length(angle))
    np.testing.assert_allclose(back, angle, atol=1e-12)
    np.testing.assert_allclose(found, points, atol=1e-14)


def test_the_flange_goes_straight_up(profile: SagittalProfile) -> None:
    points, _ = profile.at_arc_length(np.array([-profile.flange_length, -0.004, 0.0]))
    np.testing.assert_allclose(points[:, 0], points[2, 0], atol=1e-15)
    rise = points[:, 1] - points[2, 1]
    np.testing.assert_allclose(rise, [profile.flange_length, 0.004, 0.0], atol=1e-15)


def test_sizes_are_those_of_the_design() -> None:
    p = preset("curved", size=1.07)
    profile = femoral_profile(p)
    front, low, back, end = profile.point(
        np.array([-math.pi / 2, 0.0, math.pi / 2, profile.angles[-1]])
    )
    assert front[0] - back[0] == pytest.approx(p.femoral_ap, abs=1e-12)
    np.testing.assert_allclose(low, [-p.distal_point_offset, -p.distal_point_height], atol=1e-15)
    assert end[1] - low[1] == pytest.approx(p.posterior_condyle_height, abs=1e-12)
    assert front[1] + profile.flange_length == pytest.approx(p.flange_height, abs=1e-12)
    assert profile.angles[-1] > math.radians(120.0)
