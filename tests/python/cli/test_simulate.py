# SPDX-License-Identifier: Apache-2.0
"""``condyle simulate`` on a model and a trial: what it prints, what it writes, what it refuses."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import onnx
import pytest
from typer.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parents[1] / "fdk"))

from leg_model import FORCE_DEPENDENT, write_leg, write_table

from condyle._core import io
from condyle.cli import stages
from condyle.cli.app import app
from condyle.whole_files import content_hash

TINY = Path(__file__).parents[2] / "data" / "tiny_surrogate.onnx"  # of a left knee


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    return {
        side: write_leg(tmp_path_factory.mktemp(side), side, frames=5, mesh_edge=2e-3)
        for side in ("right", "left")
    }


@pytest.fixture
def simulate(legs, monkeypatch):
    """Runs the command beside a leg's files; its result."""

    def run(*arguments, side="right", leg=None):
        monkeypatch.chdir((leg or legs[side]).folder)
        return CliRunner().invoke(app, ["simulate", *map(str, arguments)])

    return run


def trial(out, *arguments, side="right", contact="exact"):
    """A run on the leg's own meshes, which are in Condyle's axes."""
    return (
        "leg.json", "motion.sto", "--loads", "floor.xml", "-o", out, "--meshes", "leg.json", "--side-of-body", side,
        "--contact", contact, *arguments,
    )  # fmt: skip


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def test_a_trial_from_motion_to_contact_forces(condyle, legs, tmp_path):
    """As a user would, in a process of its own."""
    out = tmp_path / "out"
    done = condyle(*("simulate", *trial(out, "--reserve", 9)), folder=legs["right"].folder)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[2].startswith(f"{out}: coordinates.sto, generalised_forces.sto, ")
    assert lines[:2] == [
        "5 time frames from 0.5 to 0.58 s; 5 force-dependent coordinates; contact: tibiofemoral exact",
        "5 of 5 time frames converged",
    ]
    peaks = summary_of(out)["peak_forces"]["tibiofemoral"]
    told = ", ".join(
        f"{part} {peaks[part]['value_N']:.1f} N at {peaks[part]['time']:g} s"
        for part in ("total", "medial", "lateral")
    )
    assert lines[3] == f"tibiofemoral Fy: peak {told}"
    assert 800.0 < peaks["total"]["value_N"] < 4000.0
    assert lines[4].startswith("largest residual 0.")
    assert lines[5].startswith("largest reserve ") and lines[5].endswith("(of 9 Nm)")
    assert "times real time (contact " in lines[6]
    # The clock is in the log alone.
    assert lines[6] in (out / "run.log").read_text(encoding="utf-8")
    summary = summary_of(out)
    assert set(summary["inputs"]) == {
        "model", "motion", "external_loads", "external_loads_table", "meshes_1", "femur_mesh", "insert_mesh",
    }  # fmt: skip
    assert summary["settings"]["muscles"]["reserve_moment"] == 9.0
    assert "run.log" not in summary["files"]


def test_the_same_bytes_again_and_on_more_threads(simulate, tmp_path):
    for out, threads in (("a", 1), ("b", 2)):
        options = ("--chunk", 2, "--threads", threads)
        assert simulate(*trial(tmp_path / out, *options)).exit_code == 0
    for file in (tmp_path / "a").iterdir():
        if file.name != "run.log":
            assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes(), file.name


def test_pressure_maps_at_the_times_asked_for(simulate, tmp_path):
    out = tmp_path / "out"
    done = simulate(*trial(out, "--map-at", 0.5, "--map-at", 0.561, "--map-vtp"))
    assert done.exit_code == 0, done.output
    assert (out / "tibiofemoral_pressure_map.png").read_bytes().startswith(b"\x89PNG")
    assert {f.name for f in out.glob("pressure_*")} == {"pressure_0.500", "pressure_0.560"}
    assert (out / "pressure_0.560" / "insert_medial.vtp").is_file()


def test_solver_options_arrive(simulate, tmp_path):
    options = {
        "force-tolerance": 0.37, "moment-tolerance": 0.021, "max-iterations": 33, "max-newton-step-mm": 1.7,
        "max-newton-step-deg": 1.3, "local-search": 5, "jacobian": "finite_differences", "perturbation": 3e-7,
        "max-substeps": 7,
    }  # fmt: skip
    arguments = [word for name, value in options.items() for word in (f"--{name}", value)]
    done = simulate(*trial(tmp_path / "out", *arguments, "--no-pressures"))
    assert done.exit_code == 0, done.output
    settings = summary_of(tmp_path / "out")["settings"]
    assert settings["newton"] == {
        "force_tolerance_N": 0.37, "moment_tolerance_Nm": 0.021, "max_iterations": 33,
        "max_newton_step_m": 1e-3 * 1.7, "max_newton_step_rad": np.radians(1.3), "max_line_search": 5,
        "jacobian": "finite_differences", "perturbation": 3e-7,
    }  # fmt: skip
    assert settings["solver"]["max_substeps"] == 7
    assert not (tmp_path / "out" / "tibiofemoral_pressures.sto").exists()


def test_fast_says_how_far_it_is_from_exact_and_keeps_its_field(simulate, tmp_path):
    cache = tmp_path / "cache"
    done = simulate(*trial(tmp_path / "fast", "--cache", cache, contact="fast"))
    assert done.exit_code == 0, done.output
    assert "tibiofemoral fast evaluation: 99th percentile error against exact" in done.output
    assert list(cache.glob("*.field"))
    assert simulate(*trial(tmp_path / "exact")).exit_code == 0
    fast, exact = (
        summary_of(tmp_path / kind)["peak_forces"]["tibiofemoral"]["total"]["value_N"]
        for kind in ("fast", "exact")
    )
    assert fast == pytest.approx(exact, rel=5e-3)


def test_time_frames_out_of_equilibrium_are_loud_and_kept(simulate, tmp_path):
    done = simulate(
        *trial(
            tmp_path / "out", "--max-iterations", 1, "--max-substeps", 1, "--force-tolerance", 1e-5
        )
    )
    assert done.exit_code == 1
    bad = summary_of(tmp_path / "out")["not_in_equilibrium"]
    assert (
        f"not in equilibrium: {len(bad)} of 5 time frames; the best that was found" in done.stderr
    )
    worst = bad[0]["worst_coordinate"]
    assert worst in FORCE_DEPENDENT
    assert f"  0.5 s: {bad[0]['message'].partition('; ')[2]}" in done.stderr.splitlines()
    assert f"remain on {worst} (" in done.stderr
    motion = io.read_motion(tmp_path / "out" / "coordinates.sto", False)
    assert np.asarray(motion.data).shape == (5, 7)


def test_muscles_that_cannot_carry_the_loads_are_named(simulate, legs, tmp_path):
    content = json.loads(legs["right"].model.read_text(encoding="utf-8"))
    for muscle in content["muscles"]:
        muscle["max_isometric_force"] *= 0.03
    (tmp_path / "weak.json").write_text(json.dumps(content), encoding="utf-8")
    arguments = list(trial(tmp_path / "out"))
    arguments[0] = tmp_path / "weak.json"
    done = simulate(*arguments)
    assert done.exit_code == 1
    assert "muscles cannot carry the loads: add reserve actuators" in done.stderr
    assert "flexion" in done.stderr
    assert summary_of(tmp_path / "out")["status"] == {"recruitment_failed": 5}


# --- surrogates -----------------------------------------------------------------------------------


@pytest.fixture
def surrogate(legs, tmp_path):
    """The closed-form surrogate of a left knee, with metadata of one's own."""

    def make(**metadata):
        model = onnx.load(TINY)
        for entry in model.metadata_props:
            name = entry.key.removeprefix("condyle.")
            if name in metadata:
                entry.value = metadata[name]
        onnx.save(model, tmp_path / "tiny.onnx")
        return tmp_path / "tiny.onnx"

    return make


def frames_file(leg, folder):
    """Where the surfaces are, without their meshes."""
    content = {"contact_surfaces": [dict(s) for s in leg.content["contact_surfaces"]]}
    for surface in content["contact_surfaces"]:
        del surface["mesh"]
    (folder / "frames.json").write_text(json.dumps(content), encoding="utf-8")
    return folder / "frames.json"


def test_a_surrogate_needs_no_meshes(simulate, surrogate, legs, tmp_path):
    """The side of the body is the surrogate's."""
    out = tmp_path / "out"
    frames = frames_file(legs["left"], tmp_path)
    run = ("leg.json", "motion.sto", "--loads", "floor.xml", "-o", out, "--meshes", frames)
    done = simulate(*run, "--surrogate", surrogate(), side="left")
    assert done.exit_code in (0, 1), done.output
    summary = summary_of(out)
    (contact,) = summary["contacts"]
    assert contact["contact"] == "surrogate" and contact["side_of_body"] == "left"
    assert contact["surrogate"]["sha256"] == content_hash(surrogate().read_bytes())
    assert contact["surrogate"]["meshes_compared"] is False
    assert "least trust" in done.stdout
    assert not (out / "tibiofemoral_pressures.sto").exists()
    done = simulate(*run, "--surrogate", surrogate(), "--pressures", side="left")
    assert done.exit_code == 2 or "surface has no mesh" in str(done.exception)


def test_with_meshes_the_reference_judges_the_surrogate(simulate, surrogate, legs, tmp_path):
    leg, out = legs["left"], tmp_path / "out"
    hashes = {
        f"{part}.stl": content_hash((leg.folder / f"{part}.stl").read_bytes())
        for part in ("femur", "insert_medial", "insert_lateral")
    }
    law = {"name": "linear_volume", "modulus_N_per_m3": 9.3e9}
    file = surrogate(implant=json.dumps(hashes), contact_law=json.dumps(law))
    done = simulate(*trial(out, "--surrogate", file, side="left", contact="surrogate"), side="left")
    assert "tibiofemoral Fy against the reference at the same poses: RMS medial" in done.stdout
    assert summary_of(out)["contacts"][0]["surrogate"]["meshes_compared"] is True
    reference = io.read_motion(out / "tibiofemoral_reference.sto", True)
    assert list(reference.names)[:2] == ["medial_Fx", "medial_Fy"]
    assert (out / "tibiofemoral_pressures.sto").exists()
    hybrid = simulate(*trial(out, "--surrogate", file, side="left", contact="hybrid"), side="left")
    calls = summary_of(out)["contacts"][0]["reference_calls"]
    # Far outside of what the closed form knows, the hybrid takes the reference.
    assert calls > 0
    assert f"tibiofemoral: {calls} evaluations were the reference's" in hybrid.stdout


# --- mistakes -------------------------------------------------------------------------------------


@pytest.fixture
def refused(legs, monkeypatch, capsys):
    """Runs the command as a user would; its one line on standard error."""
    from condyle.cli import app as root

    def run(*arguments, folder=None):
        monkeypatch.chdir(folder or legs["right"].folder)
        monkeypatch.setattr("sys.argv", ["condyle", "simulate", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            root.main()
        said = capsys.readouterr().err.strip()
        assert ended.value.code == 2, said
        assert len(said.splitlines()) == 1
        return said

    return run


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["leg.json"], "leg.json: a model needs a MOTION.sto and -o FOLDER (a study is a .toml)"),
        (["leg.json", "motion.sto"], "leg.json: a model needs a MOTION.sto and -o FOLDER"),
        (["leg.json", "motion.sto", "-o", "x", "--runs", "y"], "--runs goes with a study; results of a trial go to -o"),
        (["study.toml", "motion.sto"], "MOTION.sto does not go with a study: it is of a model and a trial"),
        (["study.toml", "--reserve", "20"], "--reserve does not go with a study"),
        (["study.toml", "--from", "0.5"], "--from does not go with a study"),
        (["study.toml", "-o", "x"], "--output does not go with a study"),
        (["none.json", "motion.sto", "-o", "x"], "none.json: cannot be opened for reading"),
        (["leg.json", "none.sto", "-o", "x"], "none.sto"),
        (["leg.json", "motion.sto", "-o", "x"], "--side-of-body left or right is needed: no surrogate says which"),
        ([*trial("x", "--femur", "femoral")], "model 'right leg' has no contact surface 'femoral': must be one of "
         "femoral_component, insert"),
        ([*trial("x", "--patella", "button")], "has no contact surface 'button'"),
        ([*trial("x", contact="hybrid")], "contact 'hybrid' needs a surrogate file"),
        ([*trial("x", "--surrogate", TINY)], f"{TINY}: does not go with contact 'exact': must be surrogate or hybrid"),
        ([*trial("x", "--surrogate", TINY, contact="surrogate")],
         f"{TINY}: metadata condyle.side_of_body is 'left': must be 'right' as the knee"),
        ([*trial("x", "--surrogate", TINY.with_name("tiny_surrogate_wrench.onnx"), side="left", contact="surrogate")],
         "tiny_surrogate_wrench.onnx: holds wrenches only: a simulation needs stiffness and trust too"),
        ([*trial("x", "--surrogate", "none.onnx", contact="surrogate")], "none.onnx"),
        ([*trial("x", "--modulus", "1e9", "--law", "power")], "--modulus does not go with --law power"),
        ([*trial("x", "--force-tolerance", "-1")], "force_tolerance is -1.000000: must be finite and above 0"),
        ([*trial("x", "--max-iterations", "0")], "max_iterations is 0: must be"),
        ([*trial("x", "--criterion", "cubic")], "--criterion cubic: must be a power"),
        ([*trial("x", "--plausible-depth-mm", "0")], "plausible_depth"),
        ([*trial("x", "--from", "7")], "no time frame from 7 s"),
        ([*trial("x", "--map-at", "7")], "no time frame at 7 s; the trial has 0.5 to 0.58 s"),
        ([*trial("x", "--map-at", "0.5", "--no-pressures")], "--map-at needs the meshes of the knee"),
        (["leg.json", "motion.sto", "-o", "x", "--side-of-body", "right"],
         "surface 'femoral_component' (femur.stl) needs body and placement of a mesh in Condyle's axes"),
    ],
)  # fmt: skip
def test_mistakes_end_in_one_line(refused, legs, arguments, words):
    assert words in refused(*arguments)
    assert not (legs["right"].folder / "x").exists()


def test_a_column_that_is_no_coordinate_is_named(refused, legs, tmp_path):
    times = np.linspace(0.5, 0.6, 6)
    data = np.stack([0.2 + 0 * times, 0.4 + 0 * times, 0.042 + 0 * times], axis=1)
    write_table(tmp_path / "pose.sto", ["hip", "flexion", "rotatoin"], times, data)
    arguments = list(trial("x"))
    arguments[1] = tmp_path / "pose.sto"
    said = refused(*arguments)
    assert (
        "pose.sto: column 'rotatoin' is no coordinate of model 'right leg'; did you mean 'rotation'?"
        in said
    )


def test_a_model_without_secondary_coordinates_is_told_so(refused, legs, tmp_path):
    content = json.loads(legs["right"].model.read_text(encoding="utf-8"))
    for coordinate in content["coordinates"]:
        coordinate.pop("role", None)
    (tmp_path / "stiff.json").write_text(json.dumps(content), encoding="utf-8")
    arguments = list(trial("x"))
    arguments[0] = tmp_path / "stiff.json"
    assert (
        "stiff.json: model 'right leg' has no force-dependent coordinate: nothing to solve for; give the knee's "
        "secondary coordinates the role force_dependent (condyle opensim import --force-dependent)"
    ) in refused(*arguments)


def test_a_surrogate_of_other_meshes_is_refused(refused, surrogate, legs):
    file = surrogate(implant=json.dumps({"femur.stl": "5" * 64}))
    said = refused(
        *trial("x", "--surrogate", file, side="left", contact="surrogate"),
        folder=legs["left"].folder,
    )
    assert (
        f"{file}: metadata condyle.implant: femur.stl is {'5' * 12}…; the femur of femur.stl is "
        in said
    )


def test_a_surrogate_s_side_that_the_bodies_contradict_is_asked_about(
    refused, surrogate, legs, tmp_path
):
    """A left surrogate on thigh_r, and nobody says which knee it is."""
    text = legs["left"].model.read_text(encoding="utf-8")
    text = text.replace('"thigh"', '"thigh_r"').replace('"shank"', '"shank_r"')
    (tmp_path / "leg.json").write_text(text, encoding="utf-8")
    for part in ("femur", "insert", "insert_medial", "insert_lateral"):
        (tmp_path / f"{part}.stl").symlink_to(legs["left"].folder / f"{part}.stl")
    run = ("leg.json", legs["left"].motion, "-o", "x", "--meshes", "leg.json")
    said = refused(*run, "--surrogate", surrogate(), folder=tmp_path)
    assert (
        "metadata condyle.side_of_body is 'left'; surface 'femoral_component' is on body 'thigh_r': if that is a "
        "left knee, say --side-of-body left"
    ) in said


def test_a_study_goes_to_its_stage(monkeypatch, tmp_path):
    """With the options that it had before."""
    called = []
    monkeypatch.setattr(stages, "run_study", lambda *arguments: called.append(arguments))
    study = tmp_path / "study.toml"
    for options in ([], ["--runs", "there", "--threads", "3"]):
        assert CliRunner().invoke(app, ["simulate", str(study), *options]).exit_code == 0
    assert called == [
        (study, "simulate", Path("runs"), 0),
        (study, "simulate", Path("there"), 3),
    ]


def test_the_defaults_that_help_names_are_the_core_s():
    from condyle.cli import solver_options
    from condyle.fdk import TrialSimulationSettings

    newton = TrialSimulationSettings().solver.newton
    core = {
        solver_options.ForceTolerance: newton.force_tolerance,
        solver_options.MomentTolerance: newton.moment_tolerance,
        solver_options.MaxIterations: newton.max_iterations,
        solver_options.MaxNewtonStepMm: 1e3 * newton.max_newton_step_m,
        solver_options.MaxNewtonStepDeg: np.degrees(newton.max_newton_step_rad),
        solver_options.LocalSearch: newton.max_line_search,
        solver_options.Perturbation: newton.perturbation,
        solver_options.MaxSubsteps: TrialSimulationSettings().solver.max_substeps,
    }
    for option, value in core.items():
        (information,) = option.__metadata__
        said = re.search(r"\[default: (\S+)\]", information.help)
        assert float(said[1]) == pytest.approx(value, rel=2e-3), information.help


def test_the_options_that_the_documentation_names_exist():
    text = (Path(__file__).parents[3] / "docs" / "simulation.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"(condyle simulate dm\.json .*?)\n\n", text, re.DOTALL)
    prose = text[text.index("**Which surfaces touch.**") : text.index("## Without Python")]
    known = CliRunner(env={"COLUMNS": "250"}).invoke(app, ["simulate", "--help"]).output
    named = set(re.findall(r"--[a-z][a-z-]+", command + prose))
    assert len(named) > 25
    assert not [option for option in sorted(named) if f"{option} " not in known]
