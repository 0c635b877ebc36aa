# SPDX-License-Identifier: Apache-2.0
"""A user's mistakes: each ends in one line that names file, field and value, exit code 2, and nothing is lost."""

import re
import struct

import numpy as np
import pytest

from condyle import implants


@pytest.fixture
def evaluate(condyle, implant, poses, tmp_path):
    """Runs ``condyle contact eval`` with some options replaced; checks the form of its complaint."""

    def run(**options):
        given = {
            "femur": implant / "femur.stl",
            "insert": implant / "insert.stl",
            "side-of-body": "right",
            "units": "m",
            "poses": poses,
            "out": tmp_path / "loads.csv",
        } | {name.replace("_", "-"): value for name, value in options.items()}
        (tmp_path / "loads.csv").write_text("kept\n")
        result = condyle("contact", "eval", *(x for k, v in given.items() for x in (f"--{k}", v)))
        assert result.returncode == 2, result.stdout
        lines = result.stderr.strip().splitlines()
        assert len(lines) == 1, result.stderr
        assert (tmp_path / "loads.csv").read_text() == "kept\n"
        return lines[0]

    return run


def test_wrong_units(evaluate, implant):
    message = evaluate(units="mm")
    assert re.search(r"femur\.stl: .* mm", message)
    assert "--units m" in message


def test_an_empty_file(evaluate, tmp_path):
    (tmp_path / "empty.stl").write_bytes(b"")
    assert re.search(r"empty\.stl: .*empty", evaluate(femur=tmp_path / "empty.stl"))


def test_an_stl_without_triangles(evaluate, tmp_path):
    (tmp_path / "none.stl").write_bytes(b" " * 80 + struct.pack("<I", 0))
    assert re.search(r"none\.stl: .*(no faces|no triangles)", evaluate(femur=tmp_path / "none.stl"))


def test_a_text_named_stl(evaluate, tmp_path):
    (tmp_path / "letter.stl").write_text("Dear colleague,\nplease find the implant attached.\n" * 5)
    assert re.search(r"letter\.stl: .*STL", evaluate(femur=tmp_path / "letter.stl"))


def test_inverted_normals(evaluate, implant, tmp_path):
    insert = implants.generate(implants.preset("curved")).insert
    inside_out = implants.SurfaceMesh(insert.vertices, insert.faces[:, ::-1].copy())
    implants.write_stl(tmp_path / "inside_out.stl", inside_out)
    message = evaluate(insert=tmp_path / "inside_out.stl")
    assert "inside_out.stl" in message
    assert "normals" in message


def test_swapped_parts(evaluate, implant):
    message = evaluate(femur=implant / "insert.stl", insert=implant / "femur.stl")
    assert "femur" in message
    assert "insert" in message


def test_a_missing_column(evaluate, tmp_path):
    (tmp_path / "p.csv").write_text("x,y,z,theta_x,theta_z\n0,0.05,0,0,0\n")
    assert re.search(r"p\.csv: .*'theta_y'", evaluate(poses=tmp_path / "p.csv"))


def test_a_pose_that_is_no_number(evaluate, tmp_path):
    (tmp_path / "p.csv").write_text(
        "x,y,z,theta_x,theta_y,theta_z\n0,0.05,0,0,0,0\n0,nan,0,0,0,0\n"
    )
    assert re.search(r"p\.csv.* 3.*\by\b.*nan", evaluate(poses=tmp_path / "p.csv"))


def test_a_missing_file(evaluate, tmp_path):
    assert "no_such.stl" in evaluate(femur=tmp_path / "no_such.stl")


def test_an_unknown_key_in_a_study(condyle, tmp_path):
    (tmp_path / "knee.toml").write_text("[contact]\nmodulus = 3.0\n")
    result = condyle("run", "knee.toml", folder=tmp_path)
    assert result.returncode == 2
    assert result.stderr.strip() == (
        "condyle: knee.toml: contact.modulus: unknown key (value 3.0); "
        "known: evaluation, field_spacing_mm, integration, law, plausible_depth_mm, pressure_law"
    )
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"thickness_mm": 7}, "--thickness-mm does not go with --law linear_volume"),
        ({"law": "table", "modulus": 3e9}, "--modulus does not go with --law table"),
        ({"law": "thin_layer_linear", "poissons_ratio": 0.46}, "--law thin_layer_linear needs --youngs-modulus-mpa"),
        ({"law": "power", "coefficient": 1e13}, "--law power needs --exponent"),
        ({"law": "table"}, "--law table needs --law-table"),
        ({"modulus": -3.0}, "contact law linear_volume: modulus is -3 N/m^3: must be finite and greater than 0"),
        ({"law": "power", "coefficient": 1e13, "exponent": 0.5}, "contact law power: exponent is 0.5: must be"),
    ],
)  # fmt: skip
def test_options_of_another_law_or_missing_ones(evaluate, options, said):
    assert evaluate(**options).startswith(f"condyle: {said}")


def test_a_good_table_has_the_columns_and_zero_in_the_air(condyle, implant, poses, tmp_path):
    out = tmp_path / "loads.csv"
    result = condyle(
        "contact", "eval", "--femur", implant / "femur.stl", "--insert", implant / "insert.stl",
        "--side-of-body", "right", "--units", "m", "--poses", poses, "--out", out,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    header, loaded, raised = (line.split(",") for line in out.read_text().splitlines())
    details = ["Fx", "Fy", "Fz", "Mx", "My", "Mz", "volume", "area", "max_depth"]
    assert header == [
        *("x", "y", "z", "theta_x", "theta_y", "theta_z"),
        *(f"{side}_{d}" for side in ("medial", "lateral") for d in details),
        "status",
    ]
    values = dict(zip(header, loaded, strict=True))
    # The implant is symmetric, so both sides carry the same load.
    assert float(values["medial_Fy"]) > 100.0
    assert float(values["medial_Fy"]) == pytest.approx(float(values["lateral_Fy"]), rel=1e-6)
    assert np.all(np.array(raised[6:-1], dtype=float) == 0.0)
    assert (values["status"], raised[-1]) == ("ok", "ok")
