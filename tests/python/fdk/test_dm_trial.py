# SPDX-License-Identifier: Apache-2.0
"""A real subject: from .osim, motion capture and force plates to contact forces of both joints of the knee."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from condyle._core import io
from condyle.cli.app import app

START, END = 2.6, 2.66  # mid-stance, around the peak of the patella's force
BODY_WEIGHT = 69.98 * 9.80665
SURFACES = {  # of the README of the data: placements of implants in anatomical axes
    "femur_implant": "femur_contact.stl",
    "tibia_implant": "insert_contact.stl",
    "patella_implant": "patella_contact.stl",
}


@pytest.fixture(scope="module")
def data():
    root = Path(os.environ.get("CONDYLE_DATA", Path(__file__).parents[4] / "shared" / "data"))
    if not (root / "subjects" / "dm" / "model" / "DM.osim").is_file():
        pytest.skip(f"the subject DM is not at {root} (set CONDYLE_DATA)")
    return root


@pytest.fixture(scope="module")
def trial(data, tmp_path_factory):
    """Arguments of ``condyle simulate`` but for what evaluates contact: files made as a user makes them."""
    pytest.importorskip("opensim", reason="the package opensim is not installed")
    from condyle.opensim import import_model, path_snapshots, write_model, write_snapshots

    folder, dm = tmp_path_factory.mktemp("dm"), data / "subjects" / "dm"
    osim, walk = dm / "model" / "DM.osim", dm / "trials" / "DM_ngait_og1"
    roles = ["knee_[art]*_r", "pf_*_r"]
    write_model(folder / "dm.json", import_model(osim, force_dependent=roles))
    # Paths of the stretch alone; rates are those of the whole motion.
    motion = io.read_motion(walk / "coordinates.sto", False)
    times = np.asarray(motion.times)
    rows = (times > START - 1e-4) & (times < END + 1e-4)
    part = np.ascontiguousarray(np.asarray(motion.data)[rows])
    cut = io.make_motion("cut", list(motion.names), times[rows], part, False)
    io.write_motion(cut, folder / "cut.sto")
    write_snapshots(folder / "paths.json", path_snapshots(osim, folder / "cut.sto"))
    placed = json.loads((Path(__file__).parents[3] / "docs/examples/dm_surfaces.json").read_text())
    for surface in placed["contact_surfaces"]:
        surface["mesh"] = str(data / "implants" / "dm" / SURFACES[surface["name"]])
    (folder / "surfaces.json").write_text(json.dumps(placed))
    return (
        "simulate", folder / "dm.json", walk / "coordinates.sto", "--loads", walk / "external_loads.xml",
        "--paths", folder / "paths.json", "--from", START, "--to", END, "--reserve", 20, "--negligible-force", 20,
        "--meshes", folder / "surfaces.json", "--side-of-body", "right",
    )  # fmt: skip


def table(file):
    motion = io.read_motion(file, True)
    return dict(zip(motion.names, np.asarray(motion.data).T, strict=True))


@pytest.mark.slow
def test_stance_from_markers_to_contact_forces(trial, tmp_path):
    out = tmp_path / "out"
    run = [*map(str, trial), "--contact", "exact", "-o", str(out)]
    done = CliRunner().invoke(app, run)
    assert done.exit_code == 0, done.output
    assert "8 of 8 time frames converged" in done.stdout
    assert "contact: tibiofemoral exact, patellofemoral exact" in done.stdout
    knee, patella = (
        table(out / "tibiofemoral_contact.sto"),
        table(out / "patellofemoral_contact.sto"),
    )
    # Instrumented knees carry 1.5-3 body weights in level walking at slow to normal speed.
    assert 1.2 * BODY_WEIGHT < knee["total_Fy"].max() < 3.0 * BODY_WEIGHT
    assert knee["medial_Fy"].min() > 100 and knee["lateral_Fy"].min() > 100
    # The quadriceps press the patella against the trochlea: F in T, so the femur is pushed back.
    assert "medial_Fx" not in patella
    assert 100 < np.hypot(patella["total_Fx"], patella["total_Fy"]).max() < 1500
    assert (patella["total_Fx"] < 0).all()
    residuals = table(out / "residuals.sto")
    for name in ("knee_add_r_moment", "knee_rot_r_moment", "pf_tilt_r_moment"):
        assert np.abs(residuals[name]).max() <= 5e-4
    for name in ("knee_tx_r_force", "knee_ty_r_force", "pf_tx_r_force", "pf_tz_r_force"):
        assert np.abs(residuals[name]).max() <= 0.01
    pressures = table(out / "tibiofemoral_pressures.sto")
    # A right knee: z points laterally. Centres are on the insert (±39.6 mm wide, 47 mm deep).
    assert (pressures["medial_cop_z"] < -0.005).all() and (pressures["lateral_cop_z"] > 0.005).all()
    assert np.abs(pressures["lateral_cop_x"]).max() < 0.027
    np.testing.assert_allclose(
        pressures["medial_peak_pressure"], 9.3e9 * pressures["medial_max_depth"], rtol=1e-9
    )
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["peak_forces"]["patellofemoral"]["load"] == "|F|"
    assert summary["inputs"]["patella_mesh"]["name"] == "patella_contact.stl"


@pytest.mark.slow
def test_without_the_patella_s_contact_nothing_holds_it(trial, tmp_path):
    """Its six coordinates are force-dependent: what is missing is loud, and named by coordinate."""
    out = tmp_path / "out"
    run = [*map(str, trial), "--contact", "exact", "--patella", "none", "--no-pressures"]
    run += ["--max-iterations", "4", "--max-substeps", "1"]
    done = CliRunner().invoke(app, [*run, "--to", str(START + 0.01), "-o", str(out)])
    assert done.exit_code == 1
    bad = json.loads((out / "summary.json").read_text(encoding="utf-8"))["not_in_equilibrium"]
    assert bad and all(frame["message"] for frame in bad)
    assert not (out / "patellofemoral_contact.sto").exists()
