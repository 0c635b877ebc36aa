# SPDX-License-Identifier: Apache-2.0
"""``condyle implant check``: what a user is told about good, broken and mistaken implants."""

import json

import numpy as np
import pytest

from condyle import implants
from condyle.implants import SurfaceMesh


@pytest.fixture
def check(condyle, implant):
    def run(*more, **options):
        given = {
            "femur": implant / "femur.stl",
            "insert": implant / "insert.stl",
            "side-of-body": "right",
            "units": "m",
        } | {name.replace("_", "-"): value for name, value in options.items()}
        words = [x for k, v in given.items() if v is not None for x in (f"--{k}", v)]
        return condyle("implant", "check", *words, *more)

    return run


def one_line(result) -> str:
    assert result.returncode == 2, result.stdout
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    return lines[0]


def test_a_good_pair_is_seated_and_loaded(check):
    result = check("--json")
    assert result.returncode == 0, result.stderr
    found = json.loads(result.stdout)
    assert [part["part"] for part in found["parts"]] == ["femur", "insert"]
    trial = found["trial"]
    assert (trial["seat_status"], trial["load_status"]) == ("converged", "converged")
    # Rotations zero and symmetric: either side half of 1 kN, within the faces' 2 mm.
    assert sum(trial["Fy"]) == pytest.approx(1000.0, rel=2e-3)
    assert trial["Fy"][0] == pytest.approx(500.0, rel=0.05)
    assert trial["seat_mm"][1] == pytest.approx(41.0, abs=0.1)
    # Faces 2 mm wide are too coarse for pressures, and that is said with what to do.
    assert all(f["severity"] == "warning" for f in found["findings"])


def test_the_text_says_the_same(check):
    result = check()
    assert result.returncode == 0, result.stderr
    assert "seated pose: x 6." in result.stdout
    assert "first touch at x = z = 0" in result.stdout
    assert "peak pressure, MPa" in result.stdout


def test_a_wrong_unit_is_suspected(check):
    assert "Use --units m" in one_line(check(units="mm"))


def test_swapped_parts_and_sides(check, implant):
    message = one_line(check(femur=implant / "insert.stl", insert=implant / "femur.stl"))
    assert "insert.stl" in message
    assert "swapped" in message
    message = one_line(
        check(
            insert=None,
            insert_medial=implant / "insert_lateral.stl",
            insert_lateral=implant / "insert_medial.stl",
        )
    )
    assert "Check side_of_body" in message


def test_an_inverted_femur(check, tmp_path):
    femur = implants.generate(implants.preset("curved")).femur
    turned = SurfaceMesh(femur.vertices, np.ascontiguousarray(femur.faces[:, ::-1]))
    implants.write_stl(tmp_path / "turned.stl", turned)
    message = one_line(check(femur=tmp_path / "turned.stl"))
    assert "turned.stl" in message
    assert "everse its faces" in message


def test_options_that_do_not_go_together(condyle, implant):
    femur, insert = implant / "femur.stl", implant / "insert.stl"
    assert "name mesh files" in one_line(condyle("implant", "check"))
    assert "--side-of-body is missing" in one_line(
        condyle("implant", "check", "--femur", femur, "--insert", insert)
    )
    assert "one by one" in one_line(condyle("implant", "check", femur, "--insert", insert))


def test_files_one_by_one(condyle, implant):
    result = condyle("implant", "check", implant / "femur.stl", "--units", "m")
    assert result.returncode == 0, result.stderr
    assert "after repair" in result.stdout
    assert "nothing wrong found" in result.stdout
