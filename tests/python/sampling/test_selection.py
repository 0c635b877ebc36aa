# SPDX-License-Identifier: Apache-2.0
import hashlib

import numpy as np
import pytest

from condyle.sampling.selection import (
    DROPPED,
    TEST,
    TRAIN,
    assign_splits,
    candidate_ids,
    candidate_origin,
    keyed_hash,
)


def test_ids_tell_their_origin_and_increase() -> None:
    ids = np.concatenate([candidate_ids(d, r, 5, 9) for d in (2, 4) for r in (0, 1, 12)])
    assert np.all(np.diff(ids.astype(np.int64)) > 0)
    origins = [candidate_origin(int(i)) for i in ids]
    assert origins == [(d, r, i) for d in (2, 4) for r in (0, 1, 12) for i in range(5, 9)]


def test_hash_is_blake2b_of_the_eight_bytes_under_the_seed() -> None:
    (identifier,) = candidate_ids(4, 3, 77, 78)
    digest = hashlib.blake2b(
        int(identifier).to_bytes(8, "little"), digest_size=8, key=(2017).to_bytes(8, "little")
    ).digest()
    assert keyed_hash(np.array([identifier]), 2017)[0] == int.from_bytes(digest, "little")


def test_counts_are_met_exactly() -> None:
    splits = assign_splits(candidate_ids(2, 1, 0, 1000), seed=5, train=700, test=120)
    assert [int(np.sum(splits == code)) for code in (DROPPED, TRAIN, TEST)] == [180, 700, 120]


def test_outcome_of_a_candidate_does_not_depend_on_the_order() -> None:
    ids = candidate_ids(2, 1, 0, 1000)
    order = np.random.default_rng(4).permutation(len(ids))
    splits = assign_splits(ids, seed=5, train=700, test=120)
    assert np.array_equal(assign_splits(ids[order], seed=5, train=700, test=120), splits[order])


def test_split_is_spread_over_the_index_and_unlike_that_of_another_seed() -> None:
    ids = candidate_ids(2, 1, 0, 10_000)
    splits = assign_splits(ids, seed=5, train=8_500, test=1_500)
    # Of 1 000 consecutive candidates 150 ± 11 (hypergeometric SD) are for testing; 5 SD.
    for start in range(0, 10_000, 1_000):
        assert abs(np.sum(splits[start : start + 1_000] == TEST) - 150) < 55
    other = assign_splits(ids, seed=6, train=8_500, test=1_500)
    # Two independent draws of 15 % share 225 ± 14.
    assert abs(np.sum((splits == TEST) & (other == TEST)) - 225) < 70


def test_too_few_accepted_candidates_cannot_be_split() -> None:
    with pytest.raises(ValueError, match="10 accepted candidates cannot give 9 \\+ 2 samples"):
        assign_splits(candidate_ids(2, 1, 0, 10), seed=1, train=9, test=2)
