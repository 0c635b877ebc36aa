# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from sklearn.decomposition import PCA
from sklearn.preprocessing import StandardScaler

from condyle.errors import InputDataError
from condyle.sampling.principal_axes import PrincipalAxes, PrincipalBox

NAMES = ("x", "Fy", "z", "Mx", "theta_y", "theta_z")
#: Correlated data of very different units; the variances of the scores are well apart.
SPREAD = np.array([3e-3, 640.0, 4e-4, 7.0, 0.05, 0.6])


def data(count: int = 400) -> np.ndarray:
    rng = np.random.default_rng(11)
    mixing = rng.normal(size=(6, 6)) * np.array([2.0, 1.3, 0.8, 0.5, 0.3, 0.2])[:, None]
    return (
        np.array([0.002, 900.0, -1e-3, 1.5, 0.03, -0.7])
        + rng.normal(size=(count, 6)) @ mixing * SPREAD
    )


def test_axes_and_scores_are_those_of_scikit_learn() -> None:
    values = data()
    scaler = StandardScaler().fit(values)
    pca = PCA(svd_solver="full").fit(scaler.transform(values))
    signs = np.sign(pca.components_[np.arange(6), np.argmax(np.abs(pca.components_), axis=1)])[
        :, None
    ]
    axes = PrincipalAxes.fit(values, NAMES)
    np.testing.assert_allclose(axes.mean, scaler.mean_, rtol=1e-12)
    np.testing.assert_allclose(axes.scale, scaler.scale_, rtol=1e-12)
    # The correlation matrix squares the condition number (about 50 here) of scikit-learn's SVD.
    np.testing.assert_allclose(axes.axes, pca.components_ * signs, atol=1e-11)
    expected = pca.transform(scaler.transform(values)) * signs.T
    np.testing.assert_allclose(axes.scores(values), expected, atol=1e-10)


def test_axes_are_orthonormal_and_values_come_back() -> None:
    values = data()
    axes = PrincipalAxes.fit(values, NAMES)
    np.testing.assert_allclose(axes.axes @ axes.axes.T, np.eye(6), atol=1e-13)
    back = axes.values(axes.scores(values))
    np.testing.assert_allclose(back / SPREAD, values / SPREAD, atol=1e-12)


def test_sign_of_an_axis_does_not_depend_on_the_order_of_the_rows() -> None:
    values = data()
    forward, backward = PrincipalAxes.fit(values, NAMES), PrincipalAxes.fit(values[::-1], NAMES)
    np.testing.assert_allclose(forward.axes, backward.axes, atol=1e-11)


def test_box_contains_its_data_and_is_longer_by_the_widening() -> None:
    values = data()
    tight, wide = (PrincipalBox.around(values, NAMES, widening) for widening in (1.0, 1.5))
    assert np.all(wide.contains(values))
    np.testing.assert_allclose(wide.high - wide.low, 1.5 * (tight.high - tight.low), rtol=1e-12)
    np.testing.assert_allclose(wide.high + wide.low, tight.high + tight.low, atol=1e-12)
    # The tight box touches its data on all twelve faces.
    scores = tight.axes.scores(values)
    np.testing.assert_allclose(scores.min(axis=0), tight.low, atol=1e-12)
    np.testing.assert_allclose(scores.max(axis=0), tight.high, atol=1e-12)


def test_cube_maps_onto_the_box() -> None:
    box = PrincipalBox.around(data(), NAMES, 1.5)
    unit = np.random.default_rng(3).random((200, 6))
    scores = box.axes.scores(box.values(unit))
    np.testing.assert_allclose((scores - box.low) / (box.high - box.low), unit, atol=1e-12)
    assert np.all(box.contains(box.values(unit)))
    assert not np.any(box.contains(box.values(unit + 1.01)))


def test_corners_span_the_box_in_every_variable() -> None:
    box = PrincipalBox.around(data(), NAMES, 1.5)
    inside = box.values(np.random.default_rng(4).random((5000, 6)))
    corners = box.corners()
    assert corners.shape == (64, 6)
    assert np.all(inside.min(axis=0) > corners.min(axis=0))
    assert np.all(inside.max(axis=0) < corners.max(axis=0))


def test_constant_variable_is_named() -> None:
    values = data()
    values[:, 2] = 0.004
    with pytest.raises(
        InputDataError, match=r"z is constant \(0\.004\); its range cannot be sampled"
    ):
        PrincipalAxes.fit(values, NAMES)


def test_dependent_variables_are_refused() -> None:
    values = data()
    values[:, 3] = 0.02 * values[:, 1] - 3.0
    with pytest.raises(InputDataError, match="vary in 5 independent directions only; 6 are needed"):
        PrincipalAxes.fit(values, NAMES)


def test_too_few_rows_are_refused() -> None:
    with pytest.raises(InputDataError, match="6 variables need more than 6 time frames"):
        PrincipalAxes.fit(data(6), NAMES)
