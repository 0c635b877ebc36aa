# SPDX-License-Identifier: Apache-2.0
"""Cells hold their samples, follow a domain's own box, and keep out what only looks like inside."""

import numpy as np
import pytest

from condyle.sampling.principal_axes import PrincipalBox
from condyle.training.sampled_domains import SampledDomains

FY, MX = 1, 3
COLUMNS = ("x", "Fy", "z", "Mx", "theta_y", "theta_z")


@pytest.fixture(scope="module")
def samples():
    """Poses on a curved surface with loads that follow from the depth below it; and lifted ones."""
    generator = np.random.default_rng(61)
    curve = generator.normal(size=(400, 6)) * [4e-3, 500, 8e-4, 6, 0.02, 0.4] + [
        0,
        900,
        0,
        0,
        0,
        -0.7,
    ]
    box = PrincipalBox.around(curve, COLUMNS, 1.2)
    values = box.values(generator.random((3000, 6)))
    values = values[values[:, 1] > 0]
    poses = _poses(values)
    lifted = poses[::4] + generator.uniform(0.5e-3, 2e-3, (len(poses[::4]), 1)) * np.eye(6)[1]
    wrenches = np.concatenate([_wrenches(values), np.zeros((len(lifted), 2, 6))])
    domain = np.repeat([2, 5], [len(poses), len(lifted)])
    return np.concatenate([poses, lifted]), wrenches, domain, box, len(poses)


def _poses(values):
    x, Fy, z, Mx, theta_y, theta_z = values.T
    surface = 0.04 + 2 * x**2 - 0.003 * theta_z + 0.001 * theta_z**2
    return np.column_stack(
        [x, surface - 1e-3 * np.sqrt(np.abs(Fy) / 1e3), z, 1e-3 * Mx, theta_y, theta_z]
    )


def _wrenches(values):
    wrenches = np.zeros((len(values), 2, 6))
    share = 0.5 + np.clip(values[:, 3] / (0.04 * np.maximum(values[:, 1], 1)), -0.5, 0.5)
    wrenches[:, 0, FY], wrenches[:, 1, FY] = share * values[:, 1], (1 - share) * values[:, 1]
    wrenches[:, 0, MX] = values[:, 3]
    return wrenches


def _domains(samples):
    poses, wrenches, domain, box, _ = samples
    definitions = [{"domain": 2, "definition": box.describe()}]
    return SampledDomains.around(poses, wrenches, domain, definitions)


def test_every_training_sample_is_inside(samples):
    domains = _domains(samples)
    assert domains.excess(samples[0], samples[1]).max() <= 1 + 1e-9


def test_the_domains_own_box_decides_where_it_is_known(samples):
    """Scores just outside the box, every other range respected: the excess is that of the scores."""
    _, _, _, box, _ = samples
    domains = _domains(samples)
    generator = np.random.default_rng(62)
    unit = generator.uniform(0.3, 0.7, (200, 6))
    axis = generator.integers(6, size=200)
    unit[np.arange(200), axis] = 1.06  # 12 % of half a side beyond
    values = box.values(unit)
    keep = values[:, 1] > 50
    excess = domains.excess(_poses(values[keep]), _wrenches(values[keep]))
    assert keep.sum() > 100
    assert (excess >= 1.12 - 1e-9).all()


def test_without_a_box_the_samples_own_axes_serve(samples):
    poses, wrenches, domain, _, count = samples
    domains = SampledDomains.around(poses, wrenches, domain)
    assert domains.excess(poses, wrenches).max() <= 1 + 1e-9
    far = poses[:count] + np.array([0.1, 0, 0, 0, 0, 0])
    assert (domains.excess(far, wrenches[:count]) > 1.5).all()


def test_a_pose_far_too_deep_is_outside_whatever_the_loads_say(samples):
    """A network may extrapolate to a usual load: the height above contact is not fooled."""
    poses, wrenches, _, _, count = samples
    deep = poses[:count] - 4e-3 * np.eye(6)[1]
    assert (_domains(samples).excess(deep, wrenches[:count]) > 1.2).all()


def test_a_usual_pose_with_an_unseen_load_is_outside(samples):
    poses, wrenches, _, _, count = samples
    assert (
        _domains(samples).excess(poses[:count], 5 * wrenches[:count].clip(200, None)) > 1.2
    ).all()


def test_flight_and_contact_are_cells_of_their_own(samples):
    domains = _domains(samples)
    assert domains.names == ("domain 2, loaded", "domain 5, lifted")
    # A load in the air belongs to neither.
    poses, wrenches, _, _, count = samples
    high = poses[count:] + 2e-3 * np.eye(6)[1]
    assert (domains.excess(high, np.full_like(wrenches[count:], 300.0)) > 1.05).all()


def test_a_surrogates_errors_widen_only_what_they_touch(samples):
    """Noise on predicted Mx makes room along the axes that see Mx, and leaves the pose's ranges."""
    poses, wrenches, domain, box, count = samples
    definitions = [{"domain": 2, "definition": box.describe()}]
    noise = np.zeros_like(wrenches)
    noise[:count, 0, MX] = np.random.default_rng(63).normal(0, 3, count)
    strict = _domains(samples)
    roomy = SampledDomains.around(poses, wrenches, domain, definitions, wrenches + noise)
    asked = wrenches + noise
    inside = [(d.excess(poses[:count], asked[:count]) <= 1).mean() for d in (strict, roomy)]
    # Six rows, each with 0.2 % beyond it.
    assert inside[0] < 0.95 and inside[1] > 0.98
    np.testing.assert_array_equal(roomy.matrix[0, 6:], strict.matrix[0, 6:])
    far = poses[:count] + np.array([0.1, 0, 0, 0, 0, 0])
    assert (roomy.excess(far, wrenches[:count]) > 1.5).all()
