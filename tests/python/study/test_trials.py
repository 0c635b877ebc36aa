# SPDX-License-Identifier: Apache-2.0
"""A study with a body and recorded trials: a small leg, from its motion to tables, and what makes a stage run again."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from leg_model import add_button, write_floor, write_leg
from stage_log import StageLog
from typer.testing import CliRunner

from condyle._core import io
from condyle.cli.app import app
from condyle.conventions import LOAD_COLUMNS, SIDES
from condyle.errors import CondyleError, InputDataError
from condyle.study import StudyRun, read_study

#: Coarse and short: the path is what is tested here, not the surrogate's accuracy.
BODY = """
[implant]
preset = "curved"
side_of_body = "right"
mesh_edge_mm = 2.0

[contact]
evaluation = "exact"

[body]
model = "leg.json"
surfaces = "surfaces.json"
femur = "femoral_component"
insert = "insert"
reserve_Nm = 9.0

[trials.stand]
motion = "motion.sto"
external_loads = "floor.xml"
start_s = 0.54
"""
LEARNING = """
[trials.late]
motion = "motion.sto"
external_loads = "floor.xml"
start_s = 0.62

[sampling]
seed = 5
curves = { kind = "activities", names = ["stand"] }
targets = { "2" = { train = 400, test = 150 }, "3" = { train = 0 }, "4" = { train = 150, test = 60 }, "5" = \
{ train = 120, test = 40 }, "6" = { train = 0 } }

[training]
neurons = 6
hidden_layers = 2
max_epochs = 8
threads = 1

[simulate]
contact = ["surrogate", "hybrid"]
"""
TRIALS, CONTACTS = ("stand", "late"), ("surrogate", "hybrid")
TIMES = 0.5 + 0.02 * np.arange(14)  # of the motion
FY = LOAD_COLUMNS.index("Fy")


def write_body(folder: Path, text: str, button: bool = False) -> Path:
    """The leg's files, where its surfaces are in a file of their own, and the study."""
    leg = write_leg(folder, "right", frames=len(TIMES), mesh_edge=2e-3)
    if button:
        shutil.copy(folder / "insert.stl", folder / "button.stl")
        add_button(leg, "button.stl")
    surfaces = {"contact_surfaces": leg.content["contact_surfaces"]}
    (folder / "surfaces.json").write_text(json.dumps(surfaces), encoding="utf-8")
    (folder / "knee.toml").write_text(text, encoding="utf-8")
    return folder


def run(folder: Path, until: str) -> StageLog:
    log = StageLog()
    StudyRun(read_study(folder / "knee.toml"), folder / "runs", threads=1, reporter=log).run(until)
    return log


def root(folder: Path) -> Path:
    return folder / "runs" / "knee"


def edit(file: Path, *replaced: tuple[str, str]) -> None:
    text = file.read_text(encoding="utf-8")
    for old, new in replaced:
        assert old in text
        text = text.replace(old, new)
    file.write_text(text, encoding="utf-8")


def columns(file: Path) -> dict[str, np.ndarray]:
    """Of an STO file, without time."""
    motion = io.read_motion(file, True)
    return dict(zip(motion.names, np.asarray(motion.data).T, strict=True))


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


# --- a whole run ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = write_body(tmp_path_factory.mktemp("whole"), BODY + LEARNING)
    assert run(folder, "report").ran == [
        "implant", "body", "reference", "sample", "train", "evaluate", "simulate", "report",
    ]  # fmt: skip
    return folder


@pytest.fixture(scope="module")
def tables(whole: Path) -> dict:
    return json.loads((root(whole) / "tables.json").read_text(encoding="utf-8"))


def test_every_trial_is_simulated_with_every_contact_and_all_its_files_are_kept(whole):
    for trial in TRIALS:
        for contact in ("reference", *CONTACTS):
            folder = root(whole) / "simulations" / f"{trial}_{contact}"
            summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            assert summary["settings"]["muscles"]["reserve_moment"] == 9.0
            assert set(summary["inputs"]) == {
                "model", "surfaces", "motion", "external_loads", "external_loads_table",
            }  # fmt: skip
            # What every activity has is what the trial's own files say.
            rows = rows_of(folder.with_suffix(".csv"))
            assert {row["status"] for row in rows} == {"converged"}
            knee = columns(folder / "tibiofemoral_contact.sto")
            for name in ("y", "theta_x", "medial_Fy", "lateral_Mx"):
                np.testing.assert_array_equal([float(row[name]) for row in rows], knee[name])
            assert (folder / "muscle_forces.sto").stat().st_size > 0


def test_the_reference_is_what_the_command_for_one_trial_finds(whole, tmp_path, monkeypatch):
    monkeypatch.chdir(whole)
    arguments = (
        "simulate", "leg.json", "motion.sto", "--loads", "floor.xml", "--from", "0.54", "--reserve", "9", "--contact",
        "exact", "--meshes", "surfaces.json", "--side-of-body", "right", "-o", str(tmp_path / "one"),
    )  # fmt: skip
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    files = sorted((tmp_path / "one").glob("*.sto"))
    assert len(files) > 8
    for file in files:
        ours = root(whole) / "simulations" / "stand_reference" / file.name
        assert ours.read_bytes() == file.read_bytes(), file.name


def test_error_tables_are_of_the_trials_files(whole, tables):
    loads = {(r["contact"], r["activity"], r["quantity"]): r for r in tables["simulation_loads"]}
    assert len(loads) == len(CONTACTS) * len(TRIALS) * len(SIDES) * len(LOAD_COLUMNS)
    folder = root(whole) / "simulations"
    for (contact, trial, quantity), row in loads.items():
        known, found = (
            columns(folder / f"{trial}_{which}" / "tibiofemoral_contact.sto")[quantity]
            for which in ("reference", contact)
        )
        assert row["excluded"] == 0 and row["count"] == len(known)
        assert row["rmse"] == pytest.approx(np.sqrt(np.mean((found - known) ** 2)), rel=1e-12)
        assert row["max_error"] == pytest.approx(np.abs(found - known).max(), rel=1e-12)
    assert max(row["rmse"] for row in loads.values()) > 1.0  # a rough surrogate
    kinematics = tables["simulation_kinematics"]
    assert {(r["contact"], r["activity"]) for r in kinematics} == {
        (c, t) for c in CONTACTS for t in TRIALS
    }
    assert tables["unconverged"] == []


def test_times_say_what_took_them(whole, tables):
    rows = {(row["activity"], row["contact"]): row for row in tables["times"]}
    assert set(rows) == {(t, c) for t in TRIALS for c in CONTACTS}
    for (trial, contact), row in rows.items():
        assert row["time_frames"] == {"stand": 12, "late": 8}[trial]
        assert row["duration_s"] == pytest.approx(0.02 * (row["time_frames"] - 1))
        for phases, seconds in (
            (row["phases_s"], row["surrogate_s"]),
            (row["reference_phases_s"], row["reference_s"]),
        ):
            assert {"contact", "recruitment", "ligaments"} <= set(phases)
            assert 0.0 < sum(phases.values()) <= seconds
        # All that the hybrid was asked, where to begin included.
        called = row["reference_evaluations"]
        assert called == 0 if contact == "surrogate" else 0 < called <= row["evaluations"]
    text = (root(whole) / "tables.md").read_text(encoding="utf-8")
    assert "## Wall times by phase" in text
    assert "figures/stand_loads.png" in text and "figures/late_kinematics.png" in text
    for together in ("compressive_forces", "knee_kinematics", "stand_muscles", "late_muscles"):
        assert f"figures/{together}.png" in text


def test_the_domains_are_drawn_around_the_trials_that_are_named(whole):
    from condyle.sampling import read_table

    curves = read_table(root(whole) / "tables" / "reference_curves.csv")
    assert curves.names == ("stand",)
    knee = columns(root(whole) / "simulations" / "stand_reference" / "tibiofemoral_contact.sto")
    assert curves.table(("theta_z",)).min() == pytest.approx(knee["theta_z"].min(), abs=1e-3)
    total = knee["medial_Fy"] + knee["lateral_Fy"]
    assert curves.table(("Fy",)).max() == pytest.approx(total.max(), rel=1e-2)


def test_a_second_run_does_nothing_and_another_contact_is_one_stage(whole, tmp_path):
    assert run(whole, "report").ran == []
    folder = shutil.copytree(whole, tmp_path / "copy")
    edit(folder / "knee.toml", ('contact = ["surrogate", "hybrid"]', 'contact = ["hybrid"]'))
    assert run(folder, "simulate").ran == ["simulate"]
    assert len(json.loads((root(folder) / "tables" / "times.json").read_text())) == len(TRIALS)


# --- what makes the trials run again --------------------------------------------------------------


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = write_body(tmp_path_factory.mktemp("simulated"), BODY + "end_s = 0.6\n")
    run(folder, "reference")
    return folder


def in_study(old: str, new: str):
    return lambda folder: edit(folder / "knee.toml", (old, new))


def bend_more(folder: Path) -> None:
    table = io.read_motion(folder / "motion.sto", False)
    data = np.ascontiguousarray(1.01 * np.asarray(table.data))
    more = io.make_motion("motion", list(table.names), np.asarray(table.times), data, False)
    io.write_motion(more, folder / "motion.sto")


def move_insert(folder: Path) -> None:
    content = json.loads((folder / "surfaces.json").read_text(encoding="utf-8"))
    content["contact_surfaces"][1]["frame"]["translation"][1] += 1e-3
    (folder / "surfaces.json").write_text(json.dumps(content), encoding="utf-8")


@pytest.mark.parametrize(
    ("change", "ran"),
    [
        (lambda folder: None, []),
        (bend_more, ["reference"]),
        (lambda folder: write_floor(folder, "right", TIMES, 655.0), ["reference"]),
        (lambda folder: edit(folder / "floor.xml", ("<torque_identifier>floor_m</torque_identifier>", "")),
         ["reference"]),
        (move_insert, ["reference"]),
        (in_study("start_s = 0.54", "start_s = 0.56"), ["reference"]),
        (in_study("end_s = 0.6", "end_s = 0.58"), ["reference"]),
        (in_study("end_s = 0.6", "end_s = 0.6\nnegligible_force_N = 21.0"), ["reference"]),
        (in_study("reserve_Nm = 9.0", "reserve_Nm = 11.0"), ["reference"]),
        (in_study("reserve_Nm = 9.0", "reserve_Nm = 9.0\ncriterion = 2.0"), ["reference"]),
        (in_study("reserve_Nm = 9.0", 'reserve_Nm = 9.0\nstrength = "constant"'), ["reference"]),
        (in_study('evaluation = "exact"', 'evaluation = "exact"\nlaw = {kind = "linear_volume", modulus = 9e9}'),
         ["reference"]),
        (lambda folder: edit(folder / "leg.json", ("2100.0", "1700.0")), ["body", "reference"]),
    ],
    ids=["moved", "motion", "loads table", "loads file", "surfaces", "start", "end", "threshold", "reserve",
         "criterion", "strength", "law", "model"],
)  # fmt: skip
def test_a_stage_runs_again_where_what_it_reads_has_changed(simulated, tmp_path, change, ran):
    """Files count by their content, not by where they are."""
    folder = shutil.copytree(simulated, tmp_path / "copy")
    change(folder)
    assert run(folder, "reference").ran == ran
    before, after = (
        columns(root(f) / "simulations" / "stand_reference" / "muscle_forces.sto")
        for f in (simulated, folder)
    )
    same = all(np.array_equal(before[name], after[name]) for name in before)
    # The floor's forces have a point of application: no threshold changes them.
    assert same == (not ran or "negligible" in (folder / "knee.toml").read_text())


def test_the_patella_touches_the_studys_femur_and_its_mesh_counts(tmp_path):
    text = BODY.replace('insert = "insert"', 'insert = "insert"\npatella = "button"')
    folder = write_body(tmp_path, text + "end_s = 0.56\n", button=True)
    run(folder, "reference")
    simulation = root(folder) / "simulations" / "stand_reference"
    assert np.abs(columns(simulation / "patellofemoral_contact.sto")["total_Fy"]).max() > 20
    summary = json.loads((simulation / "summary.json").read_text(encoding="utf-8"))
    assert summary["inputs"]["patella_mesh"]["name"] == "button.stl"
    assert run(folder, "reference").ran == []
    # Another solid's name is another file, but the same button.
    data = bytearray((folder / "button.stl").read_bytes())
    data[:6] = b"button"
    (folder / "button.stl").write_bytes(data)
    assert run(folder, "reference").ran == ["reference"]


# --- time frames that cannot converge -------------------------------------------------------------


def overload(folder: Path, *frames: int) -> None:
    """A floor that pushes with 5 kN at these time frames: more than these muscles can carry."""
    up = np.full(len(TIMES), 650.0)
    up[list(frames)] = 5000.0
    write_floor(folder, "right", TIMES, up)


def test_a_time_frame_without_equilibrium_is_kept_said_and_left_out(tmp_path):
    text = (BODY + LEARNING).replace("reserve_Nm = 9.0", "reserve_Nm = 0.0")
    late = text[text.index("[trials.late]") : text.index("[sampling]")]
    folder = write_body(tmp_path, text.replace(late, ""))
    overload(folder, 9)
    arguments = ["simulate", str(folder / "knee.toml"), "--runs", str(folder / "runs"), "--threads", "1"]  # fmt: skip
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 1, done.output
    said = done.stderr.splitlines()
    assert len(said) == 3
    for line, contact in zip(said, ("reference", *CONTACTS), strict=True):
        assert line.startswith(f"stand ({contact}), 0.68 s: ")
        assert "muscles cannot carry the loads" in line and "Not met: flexion by" in line
    simulations, tables = root(folder) / "simulations", root(folder) / "tables"
    # Kept: the best attempt, in all files.
    rows = rows_of(simulations / "stand_surrogate.csv")
    assert len(rows) == 12
    status = [row["status"] for row in rows]
    assert [i for i, name in enumerate(status) if name != "converged"] == [7]
    assert status[7] == "recruitment_failed"
    assert len(columns(simulations / "stand_surrogate" / "coordinates.sto")["ty"]) == 12
    # Said.
    unconverged = json.loads((tables / "unconverged.json").read_text(encoding="utf-8"))
    assert [(r["activity"], r["contact"], r["status"]) for r in unconverged] == [
        ("stand", contact, "recruitment_failed") for contact in ("reference", *CONTACTS)
    ]
    assert all(r["time_s"] == pytest.approx(0.68) for r in unconverged)
    # Left out of the errors, and of what is sampled around.
    known, found = (
        columns(simulations / f"stand_{which}" / "tibiofemoral_contact.sto")["medial_Fy"]
        for which in ("reference", "surrogate")
    )
    difference = np.delete(found - known, 7)
    loads = json.loads((tables / "simulation_loads.json").read_text(encoding="utf-8"))
    (row,) = (r for r in loads if (r["contact"], r["quantity"]) == ("surrogate", "medial_Fy"))
    assert (row["count"], row["excluded"]) == (11, 1)
    assert row["rmse"] == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-12)
    curve_times = [float(r["time"]) for r in rows_of(tables / "reference_curves.csv")]
    assert len(curve_times) == 11 and not np.isclose(curve_times, 0.68).any()
    # The exit code is that of the results, whether they are new or not.
    again = CliRunner().invoke(app, arguments)
    assert again.exit_code == 1 and again.stderr == done.stderr
    assert "simulate   unchanged" in again.stdout
    reported = CliRunner().invoke(app, ["report", *arguments[1:]])
    assert reported.exit_code == 1
    assert "0.68" in (root(folder) / "tables.md").read_text(encoding="utf-8")


def test_where_hardly_a_time_frame_converges_the_study_ends(tmp_path):
    folder = write_body(tmp_path, BODY.replace("reserve_Nm = 9.0", "reserve_Nm = 0.0"))
    overload(folder, 5, 9)
    with pytest.raises(CondyleError, match=r"^trial 'stand' \(reference\): 10 of 12 time frames"):
        run(folder, "reference")
    assert not (root(folder) / "stages" / "reference.json").exists()


# --- mistakes that show when files are read -------------------------------------------------------


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_body(tmp_path_factory.mktemp("files"), BODY)


def surfaces_with(**changes):
    """Writes the surface file with changes to the femur's entry; None leaves a key out."""

    def write(folder: Path) -> None:
        content = json.loads((folder / "surfaces.json").read_text(encoding="utf-8"))
        first = content["contact_surfaces"][0] | changes
        content["contact_surfaces"][0] = {k: v for k, v in first.items() if v is not None}
        (folder / "surfaces.json").write_text(json.dumps(content), encoding="utf-8")

    return write


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (in_study('"motion.sto"', '"none.sto"'), "trials.stand.motion: FOLDER/none.sto: no such file"),
        (in_study('"floor.xml"', '"none.xml"'), "trials.stand.external_loads: FOLDER/none.xml: no such file"),
        (in_study('"surfaces.json"', '"none.json"'), "body.surfaces: FOLDER/none.json: no such file"),
        (in_study('"leg.json"', '"none.json"'), "body.model: FOLDER/none.json: no such file"),
        (in_study('"leg.json"', '"floor.xml"'), "FOLDER/floor.xml: line 1, column 1: "),
        (in_study('"femoral_component"', '"femoral"'), "has no contact surface 'femoral': must be one of femoral_"),
        (in_study("start_s = 0.54", "start_s = 9.0"), "FOLDER/motion.sto: no time frame from 9 s; it has 0.5 to "),
        (surfaces_with(mesh="insert.stl"),
         "FOLDER/surfaces.json: the mesh of surface 'femoral_component' must be the study's femoral component "
         "(implant.femur): FOLDER/insert.stl is another one"),
        (in_study("mesh_edge_mm = 2.0", "mesh_edge_mm = 2.0\nsize = 1.1"), "FOLDER/femur.stl is another one"),
        (surfaces_with(name="femur"), "model 'right leg' has no contact surface 'femur'"),
        (lambda folder: (folder / "surfaces.json").write_text('{"contact_surfaces": []}'),
         "surface 'femoral_component'"),
    ],
)  # fmt: skip
def test_files_that_do_not_fit_are_named(files, tmp_path, change, said):
    folder = shutil.copytree(files, tmp_path / "copy")
    change(folder)
    with pytest.raises(ValueError) as caught:
        run(folder, "reference")
    message = str(caught.value)
    assert said.replace("FOLDER", str(folder)) in message
    assert "\n" not in message
    assert not (root(folder) / "simulations" / "stand_reference.csv").exists()


def test_where_the_femurs_mesh_is_not_named_its_frame_is_enough(files, tmp_path):
    folder = shutil.copytree(files, tmp_path / "copy")
    surfaces_with(mesh=None)(folder)
    in_study("start_s = 0.54", "start_s = 0.54\nend_s = 0.56")(folder)
    assert run(folder, "reference").ran[-1] == "reference"
    # The patella, though, needs the mesh that it meets.
    shutil.copy(folder / "insert.stl", folder / "button.stl")
    in_study('insert = "insert"', 'insert = "insert"\npatella = "insert_too"')(folder)
    for file in ("leg.json", "surfaces.json"):
        content = json.loads((folder / file).read_text(encoding="utf-8"))
        content["contact_surfaces"].append(content["contact_surfaces"][1] | {"name": "insert_too"})
        (folder / file).write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputDataError, match=r"\(implant\.femur\): none is named$"):
        run(folder, "reference")
