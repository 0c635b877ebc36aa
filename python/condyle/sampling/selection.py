# SPDX-License-Identifier: Apache-2.0
"""Which accepted candidates are kept, and for what: by a keyed hash of their id.

Never by its index: a Hammersley set is ordered by its first coordinate, so "the first n" of it or
"every seventh" is a different region; the hash knows nothing of the order. Whoever derives a sample
from a candidate (a raised copy of it) hashes the source's id, and so stays in the source's split.
"""

from __future__ import annotations

import hashlib
from typing import Final

import numpy as np
from numpy.typing import NDArray

DROPPED: Final = 0
TRAIN: Final = 1
TEST: Final = 2
#: Split code → name in files.
SPLIT_NAMES: Final = ("dropped", "train", "test")

_INDEX_BITS = 40
_ROUND_BITS = 16


def candidate_ids(domain: int, round_number: int, start: int, stop: int) -> NDArray[np.uint64]:
    """Ids (stop − start,) of a round's candidates: domain · 2⁵⁶ + round · 2⁴⁰ + index."""
    base = domain << (_ROUND_BITS + _INDEX_BITS) | round_number << _INDEX_BITS
    return np.arange(base + start, base + stop, dtype=np.uint64)


def candidate_origin(candidate: int) -> tuple[int, int, int]:
    """(domain, round, index) of an id."""
    index = candidate & ((1 << _INDEX_BITS) - 1)
    round_number = candidate >> _INDEX_BITS & ((1 << _ROUND_BITS) - 1)
    return candidate >> (_ROUND_BITS + _INDEX_BITS), round_number, index


def keyed_hash(ids: NDArray[np.uint64], seed: int) -> NDArray[np.uint64]:
    """BLAKE2b-64 of each id (n,), keyed by the seed."""
    key = seed.to_bytes(8, "little")
    words = bytearray()
    for identifier in ids.astype("<u8"):
        words += hashlib.blake2b(identifier.tobytes(), digest_size=8, key=key).digest()
    return np.frombuffer(bytes(words), dtype="<u8").astype(np.uint64)


def assign_splits(ids: NDArray[np.uint64], *, seed: int, train: int, test: int) -> NDArray[np.int8]:
    """DROPPED, TRAIN or TEST for each accepted candidate (n,).

    The ``test`` smallest hashes are for testing, the next ``train`` for training, the rest is
    dropped. The outcome of a candidate depends on the set of ids and not on their order.

    Args:
        ids: (n,) accepted candidates, n ≥ train + test.
        seed: The plan's.
        train: Samples for training.
        test: Samples for testing.
    """
    if len(ids) < train + test:
        raise ValueError(f"{len(ids)} accepted candidates cannot give {train} + {test} samples")
    order = np.lexsort((ids, keyed_hash(ids, seed)))
    splits = np.full(len(ids), DROPPED, dtype=np.int8)
    splits[order[:test]] = TEST
    splits[order[test : test + train]] = TRAIN
    return splits
