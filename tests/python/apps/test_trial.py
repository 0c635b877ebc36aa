# SPDX-License-Identifier: Apache-2.0
"""``condyle-sim simulate --model``: the Python program's numbers, its own files and words, and how it refuses."""

import csv
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "fdk"))

from leg_model import FORCE_DEPENDENT, Leg, add_button, write_leg, write_table

from condyle._core import io
from condyle.whole_files import content_hash

TINY = Path(__file__).parents[2] / "data" / "tiny_surrogate.onnx"  # of a left knee
TINY_WRENCH = TINY.with_name("tiny_surrogate_wrench.onnx")
RESERVE = 9.0
KNEE = ("--femur-surface", "femoral_component", "--insert-surface", "insert")

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Leg:
    """A right leg of five time frames, with a third surface that the femur meets as a patella's would."""
    made = write_leg(tmp_path_factory.mktemp("leg"), frames=5, mesh_edge=2e-3)
    add_button(made)
    return made


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> Leg:
    return write_leg(tmp_path_factory.mktemp("left"), "left", frames=3, mesh_edge=2e-3)


def trial(leg: Leg, out: Path | str, *more: object, **changes: object) -> list[object]:
    """Arguments of a run on a leg's own meshes, exactly evaluated; a change to None leaves an option out."""
    options: dict[str, object] = {
        "model": leg.model,
        "motion": leg.motion,
        "loads": leg.loads,
        "surfaces": leg.model,
        "femur_surface": "femoral_component",
        "insert_surface": "insert",
        "side_of_body": "right",
        "evaluation": "exact",
        "reserve": RESERVE,
        "out": out,
    } | changes
    given = [(f"--{name.replace('_', '-')}", value) for name, value in options.items()]
    return ["simulate", *(word for pair in given if pair[1] is not None for word in pair), *more]


def summary_of(folder: Path) -> dict[str, Any]:
    found = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert isinstance(found, dict)
    return found


def table(file: Path) -> dict[str, np.ndarray]:
    """Columns by name, without time."""
    motion = io.read_motion(file, True)
    return dict(zip(motion.names, np.asarray(motion.data).T, strict=True))


def write_python_s(leg: Leg, folder: Path, kind: str, *, patella: str | None = None) -> list[Path]:
    """The same trial by the Python package."""
    from condyle.fdk import (
        TrialSimulationSettings,
        contact_pressures,
        patellofemoral_contact,
        simulate_trial,
        tibiofemoral_contact,
        write_trial_simulation,
    )
    from condyle.model import (
        JointSurfaces,
        MuscleSettings,
        MusculoskeletalModel,
        read_trial,
        surface_files,
    )

    model = MusculoskeletalModel.read(leg.model)
    read = read_trial(model, leg.motion, external_loads=leg.loads)
    surfaces = surface_files(model, [leg.model])
    joint = JointSurfaces("femoral_component", "insert", patella)
    contacts = [tibiofemoral_contact(surfaces, joint, "right", kind)]  # type: ignore[arg-type]
    if patella is not None:
        contacts.append(
            patellofemoral_contact(surfaces, joint, "right", kind)  # type: ignore[arg-type]
        )
    muscles, settings = MuscleSettings(reserve_moment=RESERVE), TrialSimulationSettings()
    found = simulate_trial(model, read, [c.contact for c in contacts], muscles, settings)
    pressures = {
        made.contact.name: contact_pressures(made.reference, found.poses[:, c])
        for c, made in enumerate(contacts)
        if made.reference is not None
    }
    inputs = {"model": leg.model, "motion": leg.motion}
    return write_trial_simulation(
        folder, model, read, found, contacts, muscles, settings, inputs, pressures
    )


# --- results --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "patella"), [("exact", None), ("fast", "button")])
def test_the_files_are_those_of_the_python_program(
    run: Run, leg: Leg, tmp_path: Path, kind: str, patella: str | None
) -> None:
    """Byte for byte: the same core, model and files."""
    evaluation = None if kind == "fast" else kind  # fast is what a trial takes by default
    done = run(*trial(leg, "out", evaluation=evaluation, patella_surface=patella))
    assert (done.returncode, done.stderr) == (0, "")
    written = write_python_s(leg, tmp_path / "python", kind, patella=patella)
    tables = [file.name for file in written if file.suffix == ".sto"]
    assert "muscle_forces.sto" in tables and "tibiofemoral_contact.sto" in tables
    for name in tables:
        theirs, ours = tmp_path / "python" / name, tmp_path / "out" / name
        assert ours.read_bytes() == theirs.read_bytes(), name
    if patella is not None:
        assert np.abs(table(tmp_path / "out" / "patellofemoral_contact.sto")["total_Fy"]).max() > 20
    rows = [_rows(folder / "record.csv") for folder in (tmp_path / "out", tmp_path / "python")]
    assert rows[0] == rows[1]
    assert len(rows[0]) == 5
    found, expected = summary_of(tmp_path / "out"), summary_of(tmp_path / "python")
    assert set(expected) <= set(found)
    for key in set(expected) - {"inputs", "files", "condyle"}:
        assert found[key] == expected[key], key
    for key in ("model", "motion"):
        assert found["inputs"][key] == expected["inputs"][key]


def _rows(file: Path) -> list[list[object]]:
    """Lines of a record, numbers as numbers."""

    def value(word: str) -> object:
        try:
            return float(word)
        except ValueError:
            return word

    with file.open(newline="", encoding="utf-8") as stream:
        head, *rows = csv.reader(stream)
    assert head[:4] == ["time", "status", "approach", "iterations"]
    return [[value(word) for word in row] for row in rows]


def test_the_folder_holds_what_its_summary_says(run: Run, leg: Leg, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    assert run(*trial(leg, "out", patella_surface="button")).returncode == 0
    assert (tmp_path / "out" / "patellofemoral_contact.sto").exists()
    assert run(*trial(leg, "out")).returncode == 0
    summary = summary_of(tmp_path / "out")
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert names == {
        "activities.sto", "coordinates.sto", "generalised_forces.sto", "ligament_forces.sto", "ligament_strains.sto",
        "muscle_forces.sto", "record.csv", "reserves.sto", "residuals.sto", "tibiofemoral_contact.sto",
        "tibiofemoral_kinematics.sto", "tibiofemoral_pressures.sto", "notes.txt", "summary.json",
    }  # fmt: skip
    assert set(summary["files"]) == names - {"notes.txt", "summary.json"}
    for name, digest in summary["files"].items():
        assert content_hash((tmp_path / "out" / name).read_bytes()) == digest
    assert set(summary["inputs"]) == {
        "model", "motion", "external_loads", "external_loads_table", "surfaces", "femur_mesh", "insert_mesh",
    }  # fmt: skip
    for what, file in (("femur_mesh", "femur.stl"), ("external_loads_table", "floor.sto")):
        digest = content_hash((leg.folder / file).read_bytes())
        assert summary["inputs"][what] == {"name": file, "sha256": digest}
    for name in names:
        assert str(leg.folder).encode() not in (tmp_path / "out" / name).read_bytes()


def test_what_is_said(run: Run, leg: Leg, tmp_path: Path) -> None:
    done = run(*trial(leg, "out"))
    lines = done.stdout.splitlines()
    assert lines[:2] == [
        "out: 5 time frames from 0.5 to 0.58 s; 5 force-dependent coordinates; contact: tibiofemoral exact",
        "5 of 5 time frames converged",
    ]
    summary = summary_of(tmp_path / "out")
    peaks = summary["peak_forces"]["tibiofemoral"]
    found = re.fullmatch(
        r"tibiofemoral Fy: peak total ([\d.]+) N at ([\d.]+) s, medial ([\d.]+) N at ([\d.]+) s, "
        r"lateral ([\d.]+) N at ([\d.]+) s",
        lines[2],
    )
    assert found is not None, lines[2]
    told = np.array(found.groups(), dtype=float).reshape(3, 2)
    expected = [[peaks[p]["value_N"], peaks[p]["time"]] for p in ("total", "medial", "lateral")]
    np.testing.assert_allclose(told, expected, rtol=0, atol=0.051)
    assert lines[3].startswith("largest activity 0.")
    assert re.fullmatch(r"largest reserve .* Nm on flexion at 0\.5\d* s \(of 9 Nm\)", lines[4])
    assert re.fullmatch(
        r"largest residual in equilibrium \S+ of its tolerance \(0\.01 N, 0\.0005 Nm\); \d+ Newton steps, "
        r"\d+ evaluations",
        lines[5],
    )
    assert re.fullmatch(
        r"solved in \S+ s, \S+ ms a time frame, \S+ times real time \(contact \d+ %, .*\); contact models \S+ s, "
        r"pressures \S+ s",
        lines[6],
    )
    assert len(lines) == 7


def test_the_same_bytes_again_and_on_more_threads(run: Run, leg: Leg, tmp_path: Path) -> None:
    for out, threads in (("a", 1), ("b", 3)):
        assert run(*trial(leg, out, chunk=2, threads=threads)).returncode == 0
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes(), file.name


def test_options_arrive(run: Run, leg: Leg, tmp_path: Path) -> None:
    solver = {
        "force_tolerance": 0.37, "moment_tolerance": 0.021, "max_iterations": 33, "max_newton_step_mm": 1.7,
        "max_newton_step_deg": 1.3, "local_search": 5, "jacobian": "finite_differences", "perturbation": 3e-7,
        "max_substeps": 7,
    }  # fmt: skip
    others = {
        "from": 0.52, "to": 0.56, "criterion": 2.5, "strength": "constant", "law": "power", "coefficient": 2.3e13,
        "exponent": 2.1, "plausible_depth_mm": 3.1, "negligible_force": 4.0,
    }  # fmt: skip
    done = run(*trial(leg, "out", **solver, **others))
    assert (done.returncode, done.stderr) == (0, "")
    summary = summary_of(tmp_path / "out")
    assert summary["settings"]["newton"] == {
        "force_tolerance_N": 0.37, "moment_tolerance_Nm": 0.021, "max_iterations": 33,
        "max_newton_step_m": 1e-3 * 1.7, "max_newton_step_rad": np.radians(1.3), "max_line_search": 5,
        "jacobian": "finite_differences", "perturbation": 3e-7,
    }  # fmt: skip
    assert summary["settings"]["solver"]["max_substeps"] == 7
    assert summary["settings"]["muscles"] == {
        "criterion": 2.5, "strength": "constant", "upper_bounds": True, "reserve_moment": 9.0, "reserve_force": 0.0,
        "reserve_price": 1.0,
    }  # fmt: skip
    assert (summary["time_frames"], summary["first_time"], summary["last_time"]) == (3, 0.52, 0.56)
    assert summary["contacts"][0]["reference"] == {
        "evaluation": "exact", "plausible_depth_m": 1e-3 * 3.1,
        "law": {"name": "power", "coefficient_Pa_per_m^n": 2.3e13, "exponent": 2.1},
    }  # fmt: skip
    assert run(*trial(leg, "min_max", "--no-pressures", criterion="min_max")).returncode == 0
    assert not (tmp_path / "min_max" / "tibiofemoral_pressures.sto").exists()
    assert summary_of(tmp_path / "min_max")["settings"]["muscles"]["criterion"] == "min_max"


def test_paths_from_elsewhere_are_held(run: Run, leg: Leg, tmp_path: Path) -> None:
    """A snapshot of a muscle's own path changes nothing; one with an arc lengthens the muscle by it."""
    muscle = leg.content["muscles"][2]
    bodies = ["thigh", "shank"]
    points = [[bodies.index(p["body"]), *p["location"]] for p in muscle["path"]["points"]]
    times = (0.5 + 0.02 * np.arange(5)).tolist()
    for arc in (0.0, 0.004):
        content = {
            "format": "condyle-path-snapshots", "version": 1, "source": "a test", "bodies": bodies, "times": times,
            "paths": {muscle["name"]: [{"points": points, "arc_excess": arc} for _ in times]},
        }  # fmt: skip
        (tmp_path / f"paths{arc}.json").write_text(json.dumps(content), encoding="utf-8")
        done = run(*trial(leg, f"held{arc}", paths=tmp_path / f"paths{arc}.json"))
        assert (done.returncode, done.stderr) == (0, "")
    assert run(*trial(leg, "own")).returncode == 0
    own, same, longer = (
        table(tmp_path / out / "muscle_forces.sto") for out in ("own", "held0.0", "held0.004")
    )
    for name, forces in own.items():
        np.testing.assert_allclose(same[name], forces, rtol=1e-6, atol=1e-4)
    assert np.abs(longer[muscle["name"]] - own[muscle["name"]]).max() > 1.0


def test_time_frames_out_of_equilibrium_are_loud_and_kept(
    run: Run, leg: Leg, tmp_path: Path
) -> None:
    done = run(*trial(leg, "out", max_iterations=1, max_substeps=1, force_tolerance=1e-5))
    assert done.returncode == 1
    summary = summary_of(tmp_path / "out")
    bad = summary["not_in_equilibrium"]
    assert summary["status"]["not_converged"] == len(bad) > 0
    assert done.stderr == f"condyle-sim: out: {summary['summary']}\n"
    assert f"{5 - len(bad)} of 5 time frames converged; first not converged: " in done.stderr
    assert bad[0]["worst_coordinate"] in FORCE_DEPENDENT
    unit = "N" if bad[0]["worst_coordinate"].startswith("t") else "Nm"
    assert abs(bad[0][f"residual_{unit}"]) > 1e-5
    assert bad[0]["message"] in done.stderr
    with (tmp_path / "out" / "record.csv").open(newline="", encoding="utf-8") as stream:
        records = list(csv.DictReader(stream))
    assert [r["status"] for r in records].count("not_converged") == len(bad)
    failed = next(r for r in records if r["status"] == "not_converged")
    assert failed["message"] == bad[0]["message"]
    assert float(failed["scaled_residual"]) == bad[0]["scaled_residual"] > 1.0
    assert len(table(tmp_path / "out" / "coordinates.sto")["ty"]) == 5


# --- surrogates -----------------------------------------------------------------------------------


def test_a_surrogate_needs_no_meshes(run: Run, left: Leg, tmp_path: Path) -> None:
    surfaces = [dict(surface) for surface in left.content["contact_surfaces"]]
    for surface in surfaces:
        del surface["mesh"]
    frames = tmp_path / "frames.json"
    frames.write_text(json.dumps({"contact_surfaces": surfaces}), encoding="utf-8")
    options = {"side_of_body": "left", "evaluation": None, "surfaces": frames}
    done = run(*trial(left, "out", surrogate=TINY, **options))
    # Whether its two springs carry this leg is not the question.
    assert done.returncode in (0, 1), done.stderr
    (contact,) = summary_of(tmp_path / "out")["contacts"]
    assert contact["contact"] == "surrogate"
    assert contact["surrogate"]["sha256"] == content_hash(TINY.read_bytes())
    assert "meshes" not in contact
    columns = table(tmp_path / "out" / "tibiofemoral_contact.sto")
    np.testing.assert_array_equal(columns["total_Fy"], columns["medial_Fy"] + columns["lateral_Fy"])
    done = run(*trial(left, "fast", **options))
    assert done.stderr == (
        f"condyle-sim: {frames}: surface 'femoral_component' has no mesh: contact on meshes needs one\n"
    )


def test_a_hybrid_that_trusts_nothing_is_the_meshes(
    run: Run, leg: Leg, untrusted: Path, tmp_path: Path
) -> None:
    assert run(*trial(leg, "meshes")).returncode == 0
    done = run(*trial(leg, "hybrid", "--hybrid", surrogate=untrusted))
    assert (done.returncode, done.stderr) == (0, "")
    summary = summary_of(tmp_path / "hybrid")
    for name in set(summary["files"]) - {"tibiofemoral_reference.sto"}:
        ours, theirs = (tmp_path / out / name for out in ("hybrid", "meshes"))
        assert ours.read_bytes() == theirs.read_bytes(), name
    loads, reference = (
        table(tmp_path / "hybrid" / f"tibiofemoral_{what}.sto") for what in ("contact", "reference")
    )
    for name, values in reference.items():
        np.testing.assert_allclose(values, loads[name], rtol=0, atol=1e-6)
    (contact,) = summary["contacts"]
    assert contact["contact"] == "hybrid" and contact["reference"]["evaluation"] == "exact"
    assert contact["reference_calls"] > summary["evaluations"]
    assert (
        f"tibiofemoral: {contact['reference_calls']} evaluations were the reference's\n"
        in done.stdout
    )


# --- mistakes -------------------------------------------------------------------------------------


def refused(run: Run, *arguments: object) -> str:
    """The one line of the refusal; nothing was written or printed."""
    answer = run(*arguments)
    assert (answer.returncode, answer.stdout) == (2, "")
    assert answer.stderr.startswith("condyle-sim: ")
    assert answer.stderr.count("\n") == 1
    return answer.stderr.removeprefix("condyle-sim: ").rstrip("\n")


@pytest.mark.parametrize(
    ("changes", "more", "words"),
    [
        ({"motion": None}, [], "--motion is missing: --model needs it"),
        ({"insert_surface": None}, [], "--insert-surface is missing: --model needs it"),
        ({"side_of_body": None}, [], "--side-of-body is missing: --model needs it"),
        ({"model": None}, [], "goes with --model M.json only"),
        ({}, ["--femur", "f.stl"], "--femur does not go with --model: --surfaces names the meshes, in m"),
        ({}, ["--load-case", "c.csv"], "--load-case does not go with --model: it is of a load case"),
        ({"model": "none.json"}, [], "none.json: cannot be opened for reading"),
        ({"motion": "none.sto"}, [], "none.sto: cannot be opened for reading"),
        ({"loads": "none.xml"}, [], "none.xml: cannot be opened for reading"),
        ({"paths": "none.json"}, [], "none.json: cannot be opened for reading"),
        ({"surfaces": "none.json"}, [], "none.json: cannot be opened for reading"),
        ({"femur_surface": "femoral"}, [],
         "MODEL: --femur-surface: no surface 'femoral' (surfaces: femoral_component, insert, button)"),
        ({"patella_surface": "buton"}, [],
         "MODEL: --patella-surface: no surface 'buton', did you mean 'button'? (surfaces: "),
        ({"evaluation": "best"}, [], "'best'"),
        ({}, ["--hybrid"], "--hybrid needs --surrogate FILE.onnx beside the meshes"),
        ({"surrogate": TINY}, [], "contact 'tibiofemoral': the contact model is of a left knee; the joint is on the "
         "right: mirror the implant, or place the contact on the other side"),
        ({"surrogate": TINY_WRENCH}, [], f"{TINY_WRENCH}: has the output wrench alone; a simulation needs stiffness"),
        ({"surrogate": TINY, "modulus": 3e9}, [],
         "--modulus does not go with --surrogate, whose file knows its law"),
        ({"force_tolerance": -1}, [], "force_tolerance is -1.000000: must be finite and above 0"),
        ({"chunk": -1}, [], "trial simulation settings: chunk is -1: must be at least 0 time frames"),
        ({"criterion": "cubic"}, [], "--criterion cubic: must be a power, at least 1, or min_max"),
        ({"criterion": 0.5}, [], "0.5"),
        ({"plausible_depth_mm": 0}, [], "plausible"),
        ({"from": 7}, [], "MOTION: no time frame from 7 s; it has 0.5 to 0.58 s"),
        ({"reserve": -3}, [], "--reserve"),
        ({"jacobian": "none"}, [], "--jacobian"),
        ({"out": "MODEL"}, [], "--out MODEL: is a file: must be a folder"),
    ],
)  # fmt: skip
def test_mistakes_end_in_one_line(
    run: Run,
    leg: Leg,
    tmp_path: Path,
    changes: dict[str, object],
    more: list[object],
    words: str,
) -> None:
    names = {"MODEL": str(leg.model), "MOTION": str(leg.motion)}
    changes = {k: names.get(str(v), v) for k, v in changes.items()}
    for name, file in names.items():
        words = words.replace(name, file)
    said = refused(run, *trial(leg, changes.pop("out", "out"), *more, **changes))  # type: ignore[arg-type]
    assert words in said
    assert not (tmp_path / "out").exists()


def test_a_trial_that_does_not_fit_its_model_is_refused(run: Run, leg: Leg, tmp_path: Path) -> None:
    times = np.linspace(0.5, 0.6, 6)
    data = np.stack([0.2 + 0 * times, 0.4 + 0 * times, 0.1 + 0 * times], axis=1)
    write_table(tmp_path / "pose.sto", ["hip", "flexion", "rotatoin"], times, data)
    said = refused(run, *trial(leg, "out", motion=tmp_path / "pose.sto"))
    assert said == (
        f"{tmp_path / 'pose.sto'}: column 'rotatoin' is no coordinate of model 'right leg'; did you mean "
        "'rotation'?"
    )
    content = json.loads(leg.model.read_text(encoding="utf-8"))
    for coordinate in content["coordinates"]:
        coordinate.pop("role", None)
    stiff = tmp_path / "stiff.json"
    stiff.write_text(json.dumps(content), encoding="utf-8")
    assert refused(run, *trial(leg, "out", model=stiff)) == (
        f"{stiff}: model 'right leg' has no force-dependent coordinate: nothing to solve for; give the knee's "
        "secondary coordinates the role force_dependent"
    )


def test_an_earlier_result_survives_a_mistake(run: Run, leg: Leg, tmp_path: Path) -> None:
    assert run(*trial(leg, "out")).returncode == 0
    before = {file.name: file.read_bytes() for file in (tmp_path / "out").iterdir()}
    refused(run, *trial(leg, "out", criterion=0.5))
    assert {file.name: file.read_bytes() for file in (tmp_path / "out").iterdir()} == before


def test_the_options_that_the_documentation_names_exist(run: Run) -> None:
    text = (Path(__file__).parents[3] / "docs" / "simulation.md").read_text(encoding="utf-8")
    (section,) = re.findall(r"## Without Python\n(.*?)\n## ", text, re.DOTALL)
    known = run("simulate", "--help").stdout
    named = set(re.findall(r"--[a-z][a-z-]+", section))
    assert len(named) > 15
    assert not [option for option in sorted(named) if f"  {option} " not in known]
