# SPDX-License-Identifier: Apache-2.0
"""Error bounds cover what they say; trust knows the inside of the domain from the outside."""

import json

import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.training import TrustModel

FY = 1


def test_bounds_cover_fresh_samples(contact, trained):
    poses = contact.sample(3000, 41)
    truth, predicted = contact.wrench(poses), trained.surrogate.wrench(poses)
    inside = np.abs(predicted - truth) <= trained.trust.error(predicted)
    for side in range(2):
        loaded = truth[:, side, FY] > 0
        coverage = inside[loaded, side].mean(axis=0)
        # The conformal half holds m rows: coverage is Beta(0.95 m, 0.05 m) distributed, and
        # estimated on n rows; 3.5 standard deviations over 12 cells.
        m, n = trained.trust.n_held_out[side] / 2, loaded.sum()
        limit = 3.5 * np.sqrt(0.95 * 0.05 * (1 / m + 1 / n))
        assert (np.abs(coverage - 0.95) < limit).all(), (coverage, limit)


def test_a_lightly_loaded_side_has_the_smaller_bound(trained):
    wrench = np.zeros((3, 2, 6))
    wrench[1, :, FY], wrench[2, :, FY] = 100.0, 3000.0
    error = trained.trust.error(wrench)
    assert (error > 0).all()
    assert (np.diff(error, axis=0) >= 0).all()
    assert (error[2, :, FY] > 1.5 * error[0, :, FY]).all()


def test_bounds_are_exchangeable_with_any_residuals():
    """The guarantee does not need the linear shape to be right: residuals that defy it."""
    generator = np.random.default_rng(51)
    n = 4000
    poses = generator.normal(size=(n, 6)) * [1e-3, 2e-3, 1e-3, 0.02, 0.05, 0.4]
    truth = np.abs(generator.normal(size=(n, 2, 6))) * 1000 + 1
    heavy = generator.standard_t(3, size=(n, 2, 6)) * (1 + np.sin(truth[:, :, [FY]] / 50) ** 2)
    predictions = {tuple(pose): wrench for pose, wrench in zip(poses, truth + heavy, strict=True)}

    class Table:
        def wrench(self, poses):
            return np.array([predictions[tuple(pose)] for pose in np.asarray(poses)])

    half = n // 2
    model = TrustModel.calibrate(
        Table(), poses[:half], truth[:half], poses[:half], truth[:half], level=0.9
    )
    predicted = Table().wrench(poses[half:])
    coverage = (np.abs(predicted - truth[half:]) <= model.error(predicted)).mean(axis=0)
    limit = 3.5 * np.sqrt(0.9 * 0.1 * (1 / (half / 2) + 1 / half))
    assert (np.abs(coverage - 0.9) < limit).all(), coverage


def test_trust_is_one_inside_half_at_the_edge_zero_beyond_the_ramp(trained):
    model = trained.trust
    poses = trained.test.poses[:200]
    wrenches = trained.surrogate.wrench(poses)
    excess = model.domains.excess(poses, wrenches)
    expected = np.clip(0.5 - (excess - model.edge) / (2 * model.ramp), 0, 1)
    np.testing.assert_allclose(model.trust(poses, wrenches), expected, atol=1e-12)
    # Along a line that leaves the domain trust falls from one to zero and does not come back.
    out = poses[:1] + np.linspace(0, 1, 400)[:, None] * np.array([[0.05, 0, 0, 0, 0, 0]])
    trust = model.trust(out, np.repeat(wrenches[:1], len(out), axis=0))
    assert trust[0] == 1.0 and trust[-1] == 0.0
    assert (np.diff(trust) <= 1e-12).all()


def test_samples_are_trusted_and_only_few_unseen_ones_are_not(trained):
    for samples in (trained.train, trained.test):
        trust = trained.trust.trust(samples.poses, trained.surrogate.wrench(samples.poses))
        assert (trust < 0.5).mean() < 0.02
        assert np.median(trust) == 1.0


@pytest.mark.parametrize(("deeper_mm", "flagged"), [(2.5, 0.9), (3.5, 0.995)])
def test_poses_deeper_than_any_sample_are_not_trusted(trained, deeper_mm, flagged):
    # The samples are −0.4 to 1.3 mm deep.
    deep = trained.test.poses - np.array([0, 1e-3 * deeper_mm, 0, 0, 0, 0])
    assert (trained.trust.trust(deep, trained.surrogate.wrench(deep)) < 0.5).mean() > flagged


def test_tables_are_json_and_name_sides_and_loads(trained):
    table = json.loads(json.dumps(trained.trust.error_table(), allow_nan=False))
    entry = table["lateral"]["loads"]["Mz"]
    assert entry["offset"] == trained.trust.error_offset[1, 5]
    assert entry["rmse"] < entry["max"]
    bounds = json.loads(json.dumps(trained.trust.domain_bounds(), allow_nan=False))
    assert bounds["pose_min"]["theta_z"] == trained.train.poses[:, 5].min()
    assert bounds["max_Fy"]["medial"] == trained.train.wrenches[:, 0, FY].max()


def test_a_coordinate_that_never_moved_does_not_break_the_box(trained):
    poses = trained.train.poses.copy()
    poses[:, 2] = 0.0013
    held_out = trained.held_out
    model = TrustModel.calibrate(
        trained.surrogate, poses, trained.train.wrenches, held_out.poses, held_out.wrenches
    )
    # A coordinate without spread has rounding of eps·(other scores) at most: well inside.
    assert np.median(model.trust(poses, trained.train.wrenches)) == 1.0
    moved = poses + np.array([0, 0, 1e-3, 0, 0, 0])
    assert (model.trust(moved, trained.train.wrenches) == 0).all()


def test_too_few_held_out_rows_are_refused(trained):
    train, held_out = trained.train, trained.held_out
    rows = np.flatnonzero(held_out.wrenches[:, 1, FY] > 0)[:20]
    with pytest.raises(InputDataError, match=r"the .* side is loaded in \d+ rows; at least 50"):
        TrustModel.calibrate(
            trained.surrogate,
            train.poses,
            train.wrenches,
            held_out.poses[rows],
            held_out.wrenches[rows],
        )
    with pytest.raises(InputDataError, match=r"level is 1\.5"):
        TrustModel.calibrate(
            trained.surrogate,
            train.poses,
            train.wrenches,
            held_out.poses,
            held_out.wrenches,
            level=1.5,
        )
