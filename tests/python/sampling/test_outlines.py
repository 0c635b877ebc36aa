# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest
from spring_contact import SpringSolver, spring_curves

from condyle.sampling import DomainTarget, SamplingPlan, domain_outlines, read_candidates, sample
from condyle.sampling.equilibrium_protocol import GIVEN_COLUMNS
from condyle.sampling.manifest import read_manifest

ALL_SIX = tuple(DomainTarget(d, 60, 0 if d == 1 else 10) for d in range(1, 7))


@pytest.fixture(scope="module")
def directory(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("six")
    plan = SamplingPlan(ALL_SIX, seed=9, pilot=32, chunk_rows=100, envelope_points=5)
    sample(plan, spring_curves(), SpringSolver(), folder, {"side_of_body": "right"})
    return folder


def test_the_outlines_hold_every_candidate(directory):
    outlines = domain_outlines(read_manifest(directory), spring_curves())
    assert set(outlines) == {1, 2, 3, 4, 6}
    for number, outline in outlines.items():
        candidates = read_candidates(directory, number)
        values = np.hstack([candidates.prescribed, candidates.sensitive])
        boxes = outline.boxes
        given = ~np.isnan(values).any(axis=0)
        # What the domain prescribes is what the outline knows, and nothing else.
        assert np.array_equal(given, ~np.isnan(boxes).any(axis=(0, 1))), number
        low, high = boxes.min(axis=1)[:, given], boxes.max(axis=1)[:, given]
        # Sums of a few products of order of the box: a few roundings of its size.
        slack = 1e-13 * np.abs(boxes[..., given]).max(axis=(0, 1))
        inside = (values[:, None, given] >= low - slack) & (values[:, None, given] <= high + slack)
        assert inside.all(axis=2).any(axis=1).all(), number


def test_a_box_of_scores_is_tighter_than_its_bounds(directory):
    """Its corners are the parallelotope's own, not those of the upright box around them."""
    boxes = domain_outlines(read_manifest(directory))[2].boxes[0]
    upright = np.array([boxes.min(axis=0), boxes.max(axis=0)])
    drawn = [GIVEN_COLUMNS.index(name) for name in ("x", "Fy", "z", "Mx", "theta_y", "theta_z")]
    assert len(boxes) == 64
    assert not any((boxes[:, drawn] == corner[drawn]).all(axis=1).any() for corner in upright)


def test_without_curves_the_envelopes_are_left_out(directory):
    assert set(domain_outlines(read_manifest(directory))) == {2, 3, 4, 6}
