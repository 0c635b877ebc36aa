# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.stats import qmc

from condyle.errors import InputDataError
from condyle.sampling.hammersley import hammersley, radical_inverse, seeded_shift

EPS = np.finfo(float).eps


def test_first_column_is_i_over_n() -> None:
    assert np.array_equal(hammersley(1237)[:, 0], np.arange(1237) / 1237)


def test_further_columns_are_the_halton_sequence() -> None:
    # Both sum at most 11 digits · base^-k: a rounding each, of a sum below 1.
    expected = qmc.Halton(d=5, scramble=False).random(1237)
    assert np.max(np.abs(hammersley(1237)[:, 1:] - expected)) <= 11 * EPS


def test_radical_inverse_mirrors_the_digits() -> None:
    # 1·25 + 3·5 + 2 = 42 is 132 in base 5; mirrored, 0.231 = 2/5 + 3/25 + 1/125.
    assert radical_inverse(np.array([42]), 5)[0] == pytest.approx(
        2 / 5 + 3 / 25 + 1 / 125, rel=4 * EPS
    )


def test_every_elementary_interval_of_a_base_holds_one_point() -> None:
    unit = hammersley(3**5)
    cells = np.floor(unit[:, 2] * 3**5 + 1e-9).astype(int)
    assert np.array_equal(np.sort(cells), np.arange(3**5))


def test_rows_on_demand_are_rows_of_the_whole() -> None:
    shift = seeded_shift(5, "rows")
    whole = hammersley(1000, shift=shift)
    pieces = [
        hammersley(1000, start=i, stop=min(i + 170, 1000), shift=shift) for i in range(0, 1000, 170)
    ]
    assert np.array_equal(np.concatenate(pieces), whole)


def test_a_shift_moves_every_point_modulo_one_and_stays_in_the_cube() -> None:
    shift = seeded_shift(7, "domain 2 round 2")
    moved = hammersley(500, shift=shift)
    assert np.all((moved >= 0) & (moved < 1))
    distance = np.mod(moved - hammersley(500) - shift + 0.5, 1.0) - 0.5
    assert np.max(np.abs(distance)) <= 2 * EPS


def test_shifts_differ_by_seed_and_label_and_axis_and_repeat() -> None:
    shift = seeded_shift(7, "domain 2 round 2")
    assert np.array_equal(shift, seeded_shift(7, "domain 2 round 2"))
    assert len(set(shift)) == 6
    assert not np.any(shift == seeded_shift(8, "domain 2 round 2"))
    assert not np.any(shift == seeded_shift(7, "domain 2 round 3"))


def test_discrepancy_is_far_below_that_of_random_points() -> None:
    random = np.random.default_rng(1).random((512, 6))
    assert qmc.discrepancy(hammersley(512)) < 0.25 * qmc.discrepancy(random)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"size": 0}, "Hammersley size is 0; at least 1 point is needed"),
        ({"size": 9, "dimensions": 9}, "dimensions is 9; it must be 1 to 8"),
        ({"size": 9, "start": 4, "stop": 12}, "rows 4 to 12 are not within the set of 9"),
        ({"size": 9, "shift": np.zeros(5)}, r"shift has shape \(5,\); \(6,\) is needed"),
    ],
)
def test_impossible_sets_are_refused(arguments: dict, message: str) -> None:
    with pytest.raises(InputDataError, match=message):
        hammersley(**arguments)
