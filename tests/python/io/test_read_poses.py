# SPDX-License-Identifier: Apache-2.0
"""Tables of poses, as the Python package reads them."""

from pathlib import Path

import numpy as np
import pytest

from condyle.contact import read_poses


def test_poses_come_by_column_name(tmp_path: Path) -> None:
    file = tmp_path / "poses.csv"
    file.write_text("# m, rad\ntheta_z,x,y,z,theta_x,theta_y\n-0.6,0.01,0.02,0.03,0.4,0.5\n")
    poses = read_poses(file)
    assert poses.dtype == np.float64
    np.testing.assert_array_equal(poses, [[0.01, 0.02, 0.03, 0.4, 0.5, -0.6]])


def test_a_pose_that_cannot_be_is_named_by_file_line_and_column(tmp_path: Path) -> None:
    file = tmp_path / "poses.csv"
    file.write_text("x,y,z,theta_x,theta_y,theta_z\n0,0.04,0,0,0,0\n0,0.04,0,0,nan,0\n")
    with pytest.raises(ValueError) as caught:
        read_poses(file)
    assert str(caught.value) == f"{file}, line 3, column 'theta_y': nan is not finite"
