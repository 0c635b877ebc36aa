# SPDX-License-Identifier: Apache-2.0
"""A study whose body is an .osim and whose trial is markers: what OpenSim makes of them, and when it does so again."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("opensim", reason="the package opensim is not installed")

from osim_models import leg
from recordings import marker_positions, slow_swing, write_trc
from stage_log import StageLog

from condyle._core import io
from condyle.opensim.library import opensim_library
from condyle.study import StudyRun, read_study

STUDY = """
[implant]
preset = "curved"
mesh_edge_mm = 3.0
[body]
model = "leg.osim"
surfaces = "surfaces.json"
femur = "condyles"
insert = "tray"
force_dependent = ["knee_sh*"]
reserve_Nm = 9.0
[trials.swing]
markers = "swing.trc"
filter_hz = 0.0
start_s = 0.1
end_s = 0.2
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("osim")
    leg(opensim_library(), folder / "leg.osim")
    times, q = slow_swing()
    names, positions = marker_positions(folder / "leg.osim", times, q)
    write_trc(folder / "swing.trc", names, times, positions)
    (folder / "surfaces.json").write_text('{"contact_surfaces": []}', encoding="utf-8")
    (folder / "knee.toml").write_text(STUDY, encoding="utf-8")
    assert run(folder).ran == ["implant", "body"]
    return folder


def run(folder: Path) -> StageLog:
    log = StageLog()
    study = read_study(folder / "knee.toml")
    StudyRun(study, folder / "runs", threads=1, reporter=log).run("body")
    return log


def test_model_coordinates_and_paths_come_from_opensim(made):
    body = made / "runs" / "knee" / "body"
    model = json.loads((body / "model.json").read_text(encoding="utf-8"))
    roles = {c["name"]: c.get("role") for c in model["coordinates"]}
    assert roles["knee_shift"] == "force_dependent" and roles["hip_flex"] != "force_dependent"
    found = io.read_motion(body / "swing" / "coordinates.sto", False)
    times, q = slow_swing()
    np.testing.assert_allclose(found.times, times, rtol=0, atol=1e-9)
    for name in ("hip_flex", "knee_flex"):
        column = np.asarray(found.data)[:, list(found.names).index(name)]
        np.testing.assert_allclose(column, q[name], rtol=0, atol=1e-3, err_msg=name)
    paths = json.loads((body / "swing" / "paths.json").read_text(encoding="utf-8"))
    assert "around" in paths["paths"]  # its ellipsoid is no surface of a model file


def change(old: str, new: str):
    def apply(folder: Path) -> None:
        text = (folder / "knee.toml").read_text(encoding="utf-8")
        assert old in text
        (folder / "knee.toml").write_text(text.replace(old, new), encoding="utf-8")

    return apply


def move_a_marker(folder: Path) -> None:
    times, q = slow_swing()
    names, positions = marker_positions(folder / "leg.osim", times, q)
    positions[:, 5] += 0.002
    write_trc(folder / "swing.trc", names, times, positions)


@pytest.mark.parametrize(
    ("apply", "ran"),
    [
        (change("reserve_Nm = 9.0", "reserve_Nm = 7.0\ncriterion = 2.0"), []),
        (change('femur = "condyles"', 'femur = "component"'), []),
        (change("end_s = 0.2", "end_s = 0.2\nnegligible_force_N = 5.0"), []),
        (change("filter_hz = 0.0", "filter_hz = 6.0"), ["body"]),
        (change("start_s = 0.1", "start_s = 0.12"), ["body"]),
        (change("force_dependent = [", 'force_dependent = ["knee_rot", '), ["body"]),
        (move_a_marker, ["body"]),
    ],
    ids=["muscles", "surface", "threshold", "filter", "window", "roles", "markers"],
)
def test_inverse_kinematics_runs_again_for_what_it_reads_alone(made, tmp_path, apply, ran):
    folder = shutil.copytree(made, tmp_path / "copy")
    apply(folder)
    assert run(folder).ran == ran
