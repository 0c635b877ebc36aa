# SPDX-License-Identifier: Apache-2.0
"""``condyle contact eval --volume boolean``."""

import numpy as np
import pandas as pd
import pytest

from condyle import implants

HALF = np.array([0.02, 0.011, 0.03])
TOUCH = 0.0073 + 0.011  # y where the femur's lowest face meets the blocks


def box(half, shift) -> implants.SurfaceMesh:
    vertices = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    faces = [[0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5], [0, 1, 5], [0, 5, 4]]
    faces += [[2, 6, 7], [2, 7, 3], [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6]]
    return implants.SurfaceMesh(vertices * half + shift, np.array(faces))


def crossed(a: implants.SurfaceMesh, b: implants.SurfaceMesh) -> implants.SurfaceMesh:
    """Both as one solid."""
    faces = np.concatenate([a.faces, b.faces + len(a.vertices)])
    return implants.SurfaceMesh(np.concatenate([a.vertices, b.vertices]), faces)


@pytest.fixture
def knee(tmp_path):
    """A right knee of boxes in files: a closed one, and the open tops of its blocks."""
    implants.write_stl(tmp_path / "femur.stl", box(HALF, np.zeros(3)))
    for side, z in (("medial", -0.021), ("lateral", 0.021)):
        block = box([0.006, 0.003, 0.006], np.array([0.003, 0.0043, z]))
        implants.write_stl(tmp_path / f"{side}.stl", block)
        up = np.isclose(block.vertices[block.faces][:, :, 1], 0.0073).all(axis=1)
        top = implants.SurfaceMesh(block.vertices, block.faces[up])
        implants.write_stl(tmp_path / f"{side}_top.stl", top)
    poses = f"x,y,z,theta_x,theta_y,theta_z\n0,{TOUCH - 0.7e-3},0,0,0,0\n0,0.05,0,0,0,0\n"
    (tmp_path / "poses.csv").write_text(poses)
    return tmp_path


@pytest.fixture
def evaluate(condyle, knee):
    def run(*options, part="{}.stl"):
        return condyle(
            "contact", "eval", "--femur", knee / "femur.stl", "--side-of-body", "right",
            "--insert-medial", knee / part.format("medial"),
            "--insert-lateral", knee / part.format("lateral"),
            "--units", "m", "--poses", knee / "poses.csv", "--out", knee / "out.csv", *options,
        )  # fmt: skip

    return run


def test_the_boolean_volume_stands_beside_the_laws(evaluate, knee):
    result = evaluate("--volume", "boolean")
    assert result.returncode == 0, result.stderr
    table = pd.read_csv(knee / "out.csv")
    assert list(table)[-3:] == ["medial_boolean_volume", "lateral_boolean_volume", "status"]
    for side in ("medial", "lateral"):
        # Single precision of the STL: 1e-9 of 0.7 mm.
        expected = [0.7e-3 * 0.012**2, 0.0]
        np.testing.assert_allclose(table[f"{side}_boolean_volume"], expected, rtol=1e-5)
    assert list(table["status"]) == ["ok", "ok"]
    assert "passes through itself" not in result.stdout


def test_without_the_option_the_table_is_as_ever(evaluate, knee):
    assert evaluate().returncode == 0
    assert not any("boolean" in name for name in pd.read_csv(knee / "out.csv"))


def test_open_surfaces_take_their_solids_from_other_files(evaluate, knee):
    result = evaluate("--volume", "boolean", part="{}_top.stl")
    assert result.returncode == 2
    assert "medial_top.stl: the surface is open (4 edges" in result.stderr
    assert "(--insert-solid-medial)" in result.stderr
    solids = ("--insert-solid-medial", knee / "medial.stl")
    solids += ("--insert-solid-lateral", knee / "lateral.stl")
    result = evaluate("--volume", "boolean", *solids, part="{}_top.stl")
    assert result.returncode == 0, result.stderr
    volume = pd.read_csv(knee / "out.csv")["medial_boolean_volume"]
    np.testing.assert_allclose(volume, [0.7e-3 * 0.012**2, 0.0], rtol=1e-5)
    result = evaluate(*solids)
    assert result.returncode == 2
    assert "--insert-solid-medial does not go with --volume law" in result.stderr


def test_a_solid_that_passes_through_itself_is_said(evaluate, knee):
    one = box([0.006, 0.003, 0.006], np.array([0.003, 0.0043, 0.021]))
    other = box([0.006, 0.003, 0.006], np.array([0.0081, 0.0042, 0.0232]))
    implants.write_stl(knee / "crossed.stl", crossed(one, other))
    result = evaluate("--volume", "boolean", "--insert-solid-lateral", knee / "crossed.stl")
    assert result.returncode == 0, result.stderr
    assert "crossed.stl: passes through itself at " in result.stdout
    status = list(pd.read_csv(knee / "out.csv")["status"])
    assert status[0].startswith("lateral boolean volume: ")
    assert status[1] == "ok"
