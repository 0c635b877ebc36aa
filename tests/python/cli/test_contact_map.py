# SPDX-License-Identifier: Apache-2.0
"""``condyle contact map``: pictures and VTP files of one pose."""

import pytest


@pytest.fixture
def draw(condyle, implant, tmp_path):
    def run(*options):
        return condyle(
            "contact", "map", "--femur", implant / "femur.stl", "--insert", implant / "insert.stl",
            "--side-of-body", "right", "--units", "m", *options, folder=tmp_path,
        )  # fmt: skip

    return run


def test_a_picture_and_files_at_a_pose(draw, tmp_path):
    pytest.importorskip("vtkmodules")
    result = draw("--pose", "0.0068 0.0405 0 0 0 0", "--vtp", "out", "--figure", "map.png")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    assert 'Name="pressure"' in (tmp_path / "out" / "insert_medial.vtp").read_text()
    assert len(result.stdout.splitlines()) == 4


@pytest.mark.parametrize("way", [("--force", "800", "--flexion-deg", "20"), ("--depth-mm", "0.3")])
def test_poses_need_not_be_known(draw, tmp_path, way):
    result = draw(*way, "--figure", "map.png")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "map.png").exists()


def test_a_row_of_a_table(draw, poses, tmp_path):
    assert draw("--poses", poses, "--row", "2", "--figure", "m.png").returncode == 0
    result = draw("--poses", poses, "--row", "3", "--figure", "m.png")
    assert result.returncode == 2
    assert "--row is 3" in result.stderr
    assert "has 2 rows" in result.stderr


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--pose", "0 0.04 0 0 0 0"], "name --vtp, --figure, or both"),
        (["--figure", "m.png"], "give one of --pose"),
        (["--figure", "m.png", "--depth-mm", "0.1", "--force", "10"], "(2 given)"),
        (["--figure", "m.png", "--pose", "0 0.04 0"], "six finite numbers"),
        (["--figure", "m.png", "--pose", "0 y 0 0 0 0"], "could not convert"),
    ],
)
def test_mistakes_are_one_line(draw, options, text):
    result = draw(*options)
    assert result.returncode == 2
    assert text in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
