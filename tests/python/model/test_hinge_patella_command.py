# SPDX-License-Identifier: Apache-2.0
"""``condyle model hinge-patella``: what it writes, what it prints, and mistakes in one line."""

import json
import re

import pytest
from patella_model import write_knee
from typer.testing import CliRunner

from condyle.cli.app import app
from condyle.model import MusculoskeletalModel, hinge_patella, joint_surfaces, surface_files


@pytest.fixture(scope="module")
def knee(tmp_path_factory):
    return write_knee(tmp_path_factory.mktemp("knee"))


def run(*arguments):
    return CliRunner().invoke(app, ["model", "hinge-patella", *map(str, arguments)])


def test_the_hinge_is_written_and_said(knee, tmp_path):
    out = tmp_path / "made" / "hinged.json"
    done = run(knee, "--meshes", knee, "-o", out, "--stiffness", "9.5e5")
    assert done.exit_code == 0, done.output
    model = MusculoskeletalModel.read(knee)
    expected = hinge_patella(
        model, surface_files(model, [knee]), joint_surfaces(model), stiffness=9.5e5
    )
    assert out.read_text(encoding="utf-8") == expected.text()
    assert MusculoskeletalModel.read(out).force_dependent == ("p_flex",)
    fit, seat = expected.trochlea.cylinder, expected.seat
    said = done.stdout
    assert f"{out}: button on a hinge of femur, p_flex turns about it" in said
    assert (
        f"cylinder fitted to {fit.points} faces of the trochlea over {57.29578 * fit.arc:.1f}°: radius "
        f"{1e3 * fit.radius:.2f} mm, RMS {1e3 * fit.rms:.3f} mm"
    ) in said
    assert re.search(
        r"its axis, in the mesh's frame: \(-?0\.0000, -?0\.0000, 1\.0000\) through \(-7\.4", said
    )
    assert (
        f"{1e3 * seat.along:.2f} mm along the axis and {1e3 * seat.inwards:.2f} mm towards it"
        in said
    )
    assert f"0.00 mm in the trochlea and {1e3 * seat.gap:.2f} mm off it" in said
    assert (
        "patellar ligament patellar_ligament: 950000 N/m, slack length 58.93 mm, in the place of 3"
        in said
    )
    assert "follow p_flex and move nothing: p_rot, p_tilt, p_tx, p_ty, p_tz" in said
    assert "contact left out: trochlea" in said
    assert "the patella's mass is on the femur" in said


def test_the_same_inputs_give_the_same_bytes(knee, tmp_path):
    for name in ("a.json", "b.json"):
        assert run(knee, "--meshes", knee, "-o", tmp_path / name).exit_code == 0
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_names_say_which_surfaces(knee, tmp_path):
    content = json.loads(knee.read_text(encoding="utf-8"))
    content["contact_pairs"] = []
    bare = knee.parent / "bare.json"
    bare.write_text(json.dumps(content), encoding="utf-8")
    out = tmp_path / "out.json"
    done = run(bare, "--meshes", bare, "-o", out)
    assert done.exit_code != 0 and not out.exists()
    assert "has no contact pair that says which surface that is" in str(done.exception)
    names = ("--femur", "femur", "--insert", "insert", "--patella", "button")
    assert run(bare, "--meshes", bare, "-o", out, *names).exit_code == 0
    assert "contact left out" not in run(bare, "--meshes", bare, "-o", out, *names).stdout


def test_a_mistake_writes_nothing(knee, tmp_path):
    out = tmp_path / "out.json"
    done = run(knee, "--meshes", knee, "-o", out, "--patella", "none")
    assert done.exit_code != 0
    assert "no surface of a patella is named" in str(done.exception)
    done = run(knee, "--meshes", knee, "-o", out, "--stiffness", "-1")
    assert "stiffness -1 N/m: must be above 0" in str(done.exception)
    assert not out.exists()
