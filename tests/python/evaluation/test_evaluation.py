# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from condyle.evaluation import (
    error_statistics,
    kinematics_error_table,
    sample_error_table,
    simulation_load_error_table,
)


def test_statistics_match_their_definitions_and_sklearn():
    metrics = pytest.importorskip("sklearn.metrics")
    rng = np.random.default_rng(5)
    targets = rng.normal(130.0, 40.0, 300)
    predictions = targets + rng.normal(1.5, 7.0, 300)
    result = error_statistics(targets, predictions)
    assert result.count == 300
    assert result.rmse == pytest.approx(metrics.root_mean_squared_error(targets, predictions))
    assert result.r2 == pytest.approx(metrics.r2_score(targets, predictions))
    assert result.max_error == pytest.approx(metrics.max_error(targets, predictions))


def test_constant_targets_have_no_r2():
    assert error_statistics(np.full(4, 2.5), np.full(4, 2.0)).r2 is None


def test_shapes_must_match():
    with pytest.raises(ValueError, match=r"targets \(3,\) and predictions \(4,\) must match"):
        error_statistics(np.zeros(3), np.zeros(4))


def test_a_side_in_the_air_does_not_count_towards_r2_but_does_towards_rmse():
    rng = np.random.default_rng(6)
    reference = rng.uniform(10.0, 900.0, (50, 2, 6))
    reference[:20, 1] = 0.0  # lateral lifted off
    surrogate = reference + 3.0
    domains = np.repeat([2, 4], 25)
    rows = {
        (r["domain"], r["side"], r["load"]): r
        for r in sample_error_table(domains, reference, surrogate)
    }
    assert len(rows) == 3 * 2 * 6
    lateral = rows["2", "lateral", "Fy"]
    assert (lateral["count"], lateral["loaded_count"]) == (25, 5)
    assert lateral["rmse"] == pytest.approx(3.0)
    assert rows["all", "medial", "Mx"]["count"] == 50
    loaded = reference[20:25, 1, 1]
    assert lateral["loaded_r2"] == pytest.approx(
        1 - 5 * 9.0 / np.sum((loaded - loaded.mean()) ** 2)
    )


def test_simulation_errors_are_in_the_units_shown():
    reference = np.zeros((10, 6))
    surrogate = np.zeros((10, 6))
    surrogate[:, 1] = np.radians(0.25)
    surrogate[:, 3] = 0.4e-3
    rows = {r["quantity"]: r for r in kinematics_error_table("gait", reference, surrogate)}
    assert rows["adduction"]["rmse"] == pytest.approx(0.25)
    assert rows["adduction"]["unit"] == "deg"
    assert rows["anterior_tibial_translation"]["max_error"] == pytest.approx(0.4)
    loads = simulation_load_error_table("gait", np.zeros((10, 2, 6)), np.full((10, 2, 6), 2.0))
    assert [r["quantity"] for r in loads][:2] == ["medial_Fx", "medial_Fy"]
    assert all(r["rmse"] == pytest.approx(2.0) for r in loads)
