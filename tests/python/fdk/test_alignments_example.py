# SPDX-License-Identifier: Apache-2.0
"""docs/examples/alignments.py runs, on a leg of our own and on a real subject, and prints what simulations say."""

import json
import os
import re
import runpy
import textwrap
from pathlib import Path

import numpy as np
import pytest
from leg_model import write_leg

from condyle._core import io
from condyle.fdk import Alignment, simulate_alignments, tibiofemoral_contact
from condyle.model import (
    MuscleSettings,
    MusculoskeletalModel,
    joint_surfaces,
    read_trial,
    surface_files,
)

ROOT = Path(__file__).parents[3]
DATA = Path(os.environ.get("CONDYLE_DATA", ROOT.parent / "shared" / "data"))


@pytest.fixture
def example():
    return runpy.run_path(str(ROOT / "docs" / "examples" / "alignments.py"))


def rows(text):
    """Of the table: {(varus, slope): [(medial, lateral) by rotation]}."""
    title, head, *lines = text.splitlines()
    assert title == "Peak medial / lateral Fy [N] by the tibial component's external rotation [°]"
    assert head.split() == ["varus", "slope", "-5", "0", "5"]
    found = {}
    for line in lines:
        varus, slope, *cells = line.replace(" / ", "/").split()
        pairs = [tuple(float(value) for value in cell.split("/")) for cell in cells]
        found[float(varus), float(slope)] = pairs
    return found


def test_a_leg_of_our_own_is_run_as_printed(example, tmp_path, capsys):
    leg = write_leg(tmp_path, "left", frames=3, mesh_edge=2.2e-3)
    given = [leg.model, leg.motion, "--loads", leg.loads, "--meshes", leg.model, "--reserve", "7.3",
             "--side-of-body", "left", "--cache", tmp_path / "cache"]  # fmt: skip
    assert example["main"]([str(word) for word in given]) == 0
    table = rows(capsys.readouterr().out)
    assert len(table) == 9 and all(len(cells) == 3 for cells in table.values())
    model = MusculoskeletalModel.read(leg.model)
    trial = read_trial(model, leg.motion, external_loads=leg.loads)
    contact = tibiofemoral_contact(
        surface_files(model, [leg.model]), joint_surfaces(model), "left", pressures=False
    ).contact
    one = Alignment(
        tibial_varus_deg=3, tibial_posterior_slope_deg=-3, tibial_external_rotation_deg=5
    )
    (found,) = simulate_alignments(
        model, trial, [contact], [one], MuscleSettings(reserve_moment=7.3)
    )
    expected = found.simulation.wrenches[:, 0, :, 1].max(axis=0)
    np.testing.assert_allclose(table[3.0, -3.0][2], expected, rtol=0, atol=0.51)


def test_time_frames_out_of_equilibrium_are_loud(example, tmp_path, capsys, monkeypatch):
    leg = write_leg(tmp_path, "right", frames=3, reaction=9.0e4, mesh_edge=2.2e-3)
    given = [leg.model, leg.motion, "--loads", leg.loads, "--meshes", leg.model,
             "--side-of-body", "right", "--cache", tmp_path / "cache"]  # fmt: skip
    monkeypatch.setitem(example["simulate"].__globals__, "VARUS_DEG", (0.0,))
    monkeypatch.setitem(example["simulate"].__globals__, "SLOPE_DEG", (0.0,))
    assert example["main"]([str(word) for word in given]) == 1
    told = capsys.readouterr()
    assert told.out.splitlines()[-1].split()[2:] == ["none"] * 3
    assert "tibial external rotation 5°: 0 of 3 time frames converged" in told.err


def test_the_documentation_s_example_runs(tmp_path, capsys):
    leg = write_leg(tmp_path, "right", frames=3, mesh_edge=2.2e-3)
    model = MusculoskeletalModel.read(leg.model)
    surfaces = surface_files(model, [leg.model])
    names = {
        "model": model,
        "trial": read_trial(model, leg.motion, external_loads=leg.loads),
        "knee": tibiofemoral_contact(surfaces, joint_surfaces(model), "right", "exact"),
        "MuscleSettings": MuscleSettings,
    }
    text = (ROOT / "docs" / "simulation.md").read_text(encoding="utf-8")
    (example,) = re.findall(
        r"\n(    from condyle\.fdk import alignment_grid.*?)\n\n\(`model`", text, re.DOTALL
    )
    exec(compile(textwrap.dedent(example), "simulation.md", "exec"), names)
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 27
    assert said[13].startswith("as placed 3 of 3 time frames converged")


@pytest.mark.slow
def test_a_real_subject_s_mid_stance_under_27_alignments(example, tmp_path, capsys):
    osim = DATA / "subjects" / "dm" / "model" / "DM.osim"
    if not osim.is_file():
        pytest.skip(f"the subject DM is not at {DATA} (set CONDYLE_DATA)")
    pytest.importorskip("opensim", reason="the package opensim is not installed")
    from condyle.opensim import import_model, path_snapshots, write_model, write_snapshots

    walk = DATA / "subjects" / "dm" / "trials" / "DM_ngait_og1"
    roles = ["knee_[art]*_r", "pf_*_r"]
    write_model(tmp_path / "dm.json", import_model(osim, force_dependent=roles))
    motion = io.read_motion(walk / "coordinates.sto", False)
    times = np.asarray(motion.times)
    rows_kept = (times > 2.62) & (times < 2.64)
    part = np.ascontiguousarray(np.asarray(motion.data)[rows_kept])
    io.write_motion(
        io.make_motion("cut", list(motion.names), times[rows_kept], part, False),
        tmp_path / "cut.sto",
    )
    write_snapshots(tmp_path / "paths.json", path_snapshots(osim, tmp_path / "cut.sto"))
    placed = json.loads((ROOT / "docs/examples/dm_surfaces.json").read_text(encoding="utf-8"))
    for surface in placed["contact_surfaces"]:
        surface["mesh"] = str(DATA / "implants" / "dm" / Path(surface["mesh"]).name)
    (tmp_path / "surfaces.json").write_text(json.dumps(placed), encoding="utf-8")
    given = [
        tmp_path / "dm.json", walk / "coordinates.sto", "--loads", walk / "external_loads.xml", "--paths",
        tmp_path / "paths.json", "--from", 2.62, "--to", 2.64, "--reserve", 20, "--negligible-force", 20,
        "--meshes", tmp_path / "surfaces.json", "--side-of-body", "right", "--cache", tmp_path / "cache",
    ]  # fmt: skip
    assert example["main"]([str(word) for word in given]) == 0
    table = rows(capsys.readouterr().out)
    # The tray's medial side lower, the femur follows it: medial load goes over to the lateral side.
    medial, lateral = (np.array([table[v, 0.0][1][s] for v in (-3.0, 0.0, 3.0)]) for s in (0, 1))
    assert (np.diff(medial) < -50).all() and (np.diff(lateral) > 50).all()
    assert 500 < medial[1] < 1500
