# SPDX-License-Identifier: Apache-2.0
"""Contact laws on the command line."""

import numpy as np
import pytest

from condyle.contact import (
    MeshContact,
    PowerLaw,
    ThinLayerLinearLaw,
    ThinLayerLogarithmicLaw,
    read_poses,
    read_table_law,
)

LAYER = ("--youngs-modulus-mpa", 463, "--poissons-ratio", 0.46, "--thickness-mm", 7.3)
_LAYER = {"youngs_modulus": 463e6, "poissons_ratio": 0.46, "thickness": 7.3e-3}


def test_the_table_is_of_the_law_that_the_options_name(condyle, implant, poses, tmp_path):
    (tmp_path / "law.csv").write_text("depth_mm,pressure_MPa\n0,0\n0.2,3\n1.1,31\n")
    out = tmp_path / "loads.csv"
    for options, law in (
        (("--law", "thin_layer_logarithmic", *LAYER), ThinLayerLogarithmicLaw(**_LAYER)),
        (("--law", "thin_layer_linear", *LAYER), ThinLayerLinearLaw(**_LAYER)),
        (
            ("--law", "power", "--coefficient", 2.3e13, "--exponent", 2.35),
            PowerLaw(coefficient=2.3e13, exponent=2.35),
        ),
        (("--law", "table", "--law-table", "law.csv"), read_table_law(tmp_path / "law.csv")),
    ):
        files = ("--femur", implant / "femur.stl", "--insert", implant / "insert.stl")
        knee = ("--side-of-body", "right", "--units", "m")
        answer = condyle(
            "contact", "eval", *files, *knee, "--poses", poses, "--out", out, *options,
            folder=tmp_path,
        )  # fmt: skip
        assert answer.returncode == 0, answer.stderr
        header, loaded, _ = (line.split(",") for line in out.read_text().splitlines())
        values = dict(zip(header, loaded, strict=True))
        model = MeshContact.from_files(
            femur=implant / "femur.stl",
            insert=implant / "insert.stl",
            units="m",
            side_of_body="right",
            law=law,
        )
        wrench = model.evaluate_details(np.asarray(read_poses(poses)), 1).wrench
        assert float(values["medial_Fy"]) == wrench[0, 0, 1] > 10.0


def test_modulus_and_material_convert_both_ways(condyle):
    layer = ("--poissons-ratio", 0.46, "--thickness-mm", 10)
    # M/E = 0.54/(1.46·0.08) = 4.623288; six digits are printed.
    answer = condyle("contact", "modulus", "--youngs-modulus-mpa", 463, *layer)
    assert (answer.returncode, answer.stdout) == (0, "pressure modulus 2.14058e+11 N/m³\n")
    answer = condyle("contact", "modulus", "--modulus", 9.3e9, *layer)
    assert (answer.returncode, answer.stdout) == (0, "Young's modulus 20.1156 MPa\n")


@pytest.mark.parametrize("given", [(), ("--modulus", 9.3e9, "--youngs-modulus-mpa", 463)])
def test_the_converter_takes_one_of_the_two(condyle, given):
    answer = condyle("contact", "modulus", "--poissons-ratio", 0.46, "--thickness-mm", 10, *given)
    assert answer.returncode == 2
    assert answer.stderr == "condyle: give either --youngs-modulus-mpa or --modulus\n"


def test_the_converter_refuses_what_is_out_of_range(condyle):
    answer = condyle(
        "contact", "modulus", "--modulus", 9.3e9, "--poissons-ratio", 0.5, "--thickness-mm", 10
    )
    assert answer.returncode == 2
    said = "poissons_ratio is 0.5: must be between -1 and 0.5, both excluded"
    assert answer.stderr == f"condyle: {said}\n"
