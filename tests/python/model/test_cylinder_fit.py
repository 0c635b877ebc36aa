# SPDX-License-Identifier: Apache-2.0
"""The nearest cylinder: exact ones in general pose, noisy ones beside scipy's least squares, mistakes by value."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from condyle.errors import InputDataError
from condyle.model.cylinder_fit import fit_cylinder

RADIUS, HALF_LENGTH = 0.0325, 0.006


def patch(seed, arc_deg, noise, count=1500):
    """Points and rough normals of an arc of a cylinder in general pose; its axis, a point on that."""
    rng = np.random.default_rng(seed)
    R, t = Rotation.random(random_state=seed).as_matrix(), rng.uniform(-0.1, 0.1, 3)
    angle = np.radians(rng.uniform(0.0, arc_deg, count))
    along = rng.uniform(-HALF_LENGTH, HALF_LENGTH, count)
    out = np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)
    points = (RADIUS + noise * rng.standard_normal(count))[:, None] * out
    points[:, 2] += along
    # Normals are some 10 degrees off: the start is not the answer.
    normals = out + 0.17 * rng.standard_normal((count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return points @ R.T + t, normals @ R.T, R[:, 2], t


def angle_between(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b)), abs(a @ b))


def distance_to_axis(point, axis, on_axis):
    return np.linalg.norm(np.cross(point - on_axis, axis))


@pytest.mark.parametrize("arc_deg", [360.0, 90.0, 45.0])
def test_an_exact_cylinder_is_found_on_any_arc_in_any_pose(arc_deg):
    points, normals, axis, on_axis = patch(7, arc_deg, 0.0)
    found = fit_cylinder(points, normals)
    assert found.converged and found.iterations > 1
    # Rounding of 0.1 m, magnified by the flatness of the arc.
    assert angle_between(found.axis, axis) < 1e-9
    assert found.radius == pytest.approx(RADIUS, rel=1e-9)
    assert distance_to_axis(found.centre, axis, on_axis) < 1e-10
    assert found.rms < 1e-12 and found.largest < 1e-11
    # 1500 points leave gaps of a fraction of a degree.
    assert np.degrees(found.arc) == pytest.approx(arc_deg, abs=3.0)
    assert found.points == 1500
    # The centre is the axis's point nearest to the mean.
    assert abs((found.centre - points.mean(axis=0)) @ found.axis) < 1e-12


def test_noise_is_what_remains_and_the_rest_averages_out():
    noise = 1e-4
    points, normals, axis, on_axis = patch(11, 70.0, noise)
    found = fit_cylinder(points, normals)
    assert found.rms == pytest.approx(noise, rel=0.1)
    # Depth and radius trade on a short arc: some ten standard errors of the mean.
    assert found.radius == pytest.approx(RADIUS, abs=40 * noise / np.sqrt(len(points)))
    assert distance_to_axis(found.centre, axis, on_axis) < 40 * noise / np.sqrt(len(points))
    assert angle_between(found.axis, axis) < 10 * noise / HALF_LENGTH / np.sqrt(len(points)) * 3


def test_an_independent_least_squares_ends_at_the_same_cylinder():
    points, normals, *_ = patch(3, 65.0, 2e-4, count=400)
    weights = np.random.default_rng(5).uniform(0.2, 2.0, len(points))
    found = fit_cylinder(points, normals, weights)

    def residuals(x):
        axis = x[:3] / np.linalg.norm(x[:3])
        d = points - x[3:6]
        across = d - np.outer(d @ axis, axis)
        return np.sqrt(weights) * (np.linalg.norm(across, axis=1) - x[6]) * 1e3

    start = np.concatenate([found.axis + 0.02, found.centre + 1e-3, [found.radius * 1.05]])
    other = least_squares(residuals, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale="jac")
    rms = np.sqrt(np.sum(other.fun**2) / weights.sum()) * 1e-3
    assert found.rms == pytest.approx(rms, rel=1e-8)
    assert found.radius == pytest.approx(other.x[6], rel=1e-5)
    assert angle_between(found.axis, other.x[:3] / np.linalg.norm(other.x[:3])) < 1e-5
    assert not np.isclose(found.radius, fit_cylinder(points, normals).radius, rtol=1e-7)


def test_moving_the_points_moves_the_cylinder():
    points, normals, *_ = patch(19, 60.0, 1e-4)
    R, t = Rotation.from_rotvec([0.4, -0.9, 1.3]).as_matrix(), np.array([0.3, -0.2, 0.05])
    one, other = fit_cylinder(points, normals), fit_cylinder(points @ R.T + t, normals @ R.T)
    assert other.radius == pytest.approx(one.radius, rel=1e-8)
    assert angle_between(other.axis, R @ one.axis) < 1e-8
    np.testing.assert_allclose(other.centre, R @ one.centre + t, rtol=0, atol=1e-9)
    assert other.arc == pytest.approx(one.arc, abs=1e-6)


def test_mistakes_are_named_by_value():
    points, normals, *_ = patch(2, 90.0, 0.0, count=20)
    with pytest.raises(
        InputDataError, match=r"points of shape \(5, 3\): must be \(n, 3\), n at least 6"
    ):
        fit_cylinder(points[:5], normals[:5])
    with pytest.raises(InputDataError, match=r"normals of shape \(19, 3\): must be \(20, 3\)"):
        fit_cylinder(points, normals[1:])
    with pytest.raises(InputDataError, match=r"weights of shape \(3,\): must be \(20,\)"):
        fit_cylinder(points, normals, np.ones(3))
    with pytest.raises(InputDataError, match="weight -1: must be above 0"):
        fit_cylinder(points, normals, np.r_[-1.0, np.ones(19)])
    with pytest.raises(InputDataError, match="points must be finite"):
        fit_cylinder(np.where(points == points[3, 1], np.nan, points), normals)
    with pytest.raises(InputDataError, match="all 20 points are one"):
        fit_cylinder(np.tile(points[0], (20, 1)), normals)
