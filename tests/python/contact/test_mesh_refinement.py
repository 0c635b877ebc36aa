# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from small_implant import box

from condyle.contact import mean_edge_length, refine_mesh
from condyle.contact.mesh_files import geometry
from condyle.errors import InputDataError


def test_a_refined_surface_is_the_same_surface_in_smaller_faces():
    coarse = box((0.011, 0.023, 0.031), (0.002, -0.003, 0.004))
    fine = refine_mesh(coarse, 0.020)
    splits = round(np.log(len(fine.faces) / len(coarse.faces)) / np.log(4))
    assert splits == 2
    assert mean_edge_length(fine) == pytest.approx(mean_edge_length(coarse) / 4, rel=1e-12)
    before, after = geometry.report_mesh(coarse), geometry.report_mesh(fine)
    assert after.closed
    assert after.inconsistent_edges == 0
    assert after.duplicate_vertices == 0
    assert after.volume == pytest.approx(before.volume, rel=1e-12)
    assert after.area == pytest.approx(before.area, rel=1e-12)
    assert len(refine_mesh(coarse, 1.0).faces) == len(coarse.faces)


def test_what_cannot_be_refined_is_said():
    with pytest.raises(InputDataError, match=r"edge_length is 0\.0: must be above 0 m"):
        refine_mesh(box((0.01, 0.01, 0.01), (0, 0, 0)), 0.0)
    with pytest.raises(InputDataError, match="at most 64"):
        refine_mesh(box((0.01, 0.01, 0.01), (0, 0, 0)), 1e-6)
