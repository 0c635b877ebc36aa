# SPDX-License-Identifier: Apache-2.0
import numpy as np

from condyle.sampling.domain_global import GlobalDomain
from condyle.sampling.equilibrium_protocol import PRESCRIBED_COLUMNS
from condyle.sampling.thickening import thickened


def test_each_named_variable_is_moved_both_ways_alone():
    values = np.random.default_rng(4).normal(size=(9, 3))
    result = thickened(values, ("x", "Fy", "z"), {"z": 0.25, "x": 0.5, "theta_y": 9.0, "Fy": 0.0})
    assert result.shape == (9 * 5, 3)
    assert np.array_equal(result[:9], values)
    moves = (result.reshape(5, 9, 3) - values).round(12)
    assert {tuple(move) for copy in moves for move in copy} == {
        (0.0, 0.0, 0.0), (-0.5, 0.0, 0.0), (0.5, 0.0, 0.0), (0.0, 0.0, -0.25), (0.0, 0.0, 0.25),
    }  # fmt: skip


def test_no_margin_changes_nothing():
    values = np.random.default_rng(5).normal(size=(7, 2))
    assert np.array_equal(thickened(values, ("x", "z"), {}), values)


def test_a_domain_holds_the_curves_moved_by_their_margins(curves):
    margins = {"x": 1.5e-3, "z": 2e-3, "theta_y": 0.03}
    box = GlobalDomain.around(curves, widening=1.5, margins=margins).box
    table = curves.table(PRESCRIBED_COLUMNS)
    for name, margin in margins.items():
        column = PRESCRIBED_COLUMNS.index(name)
        for sign in (-1.0, 1.0):
            moved = table.copy()
            moved[:, column] += sign * margin
            assert box.contains(moved).all(), name
