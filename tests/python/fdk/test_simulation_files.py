# SPDX-License-Identifier: Apache-2.0
"""A simulated trial: its laws, recomputed from public functions, and what its files hold."""

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from leg_model import FORCE_DEPENDENT, write_floor, write_leg

from condyle._core import io
from condyle._core.common import pose_from_transform
from condyle._core.model import Kinematics
from condyle.contact import Derivatives
from condyle.errors import InputDataError
from condyle.fdk import (
    BodyContact,
    ReferenceSettings,
    TrialSimulationSettings,
    contact_pressures,
    simulate_trial,
    tibiofemoral_contact,
    write_trial_simulation,
)
from condyle.fdk.simulation_summary import contact_peaks, scaled_residuals
from condyle.model import (
    MuscleSettings,
    MusculoskeletalModel,
    analyse_trial,
    joint_surfaces,
    read_trial,
    surface_files,
)
from condyle.whole_files import content_hash

MUSCLES = MuscleSettings(reserve_moment=7.3)


class Run:
    """A leg's simulation on its meshes, and the way to its files."""

    def __init__(self, leg, side, *, settings=None, floor=None, kind="exact"):
        self.leg, self.model = leg, MusculoskeletalModel.read(leg.model)
        self.trial = read_trial(self.model, leg.motion, external_loads=floor or leg.loads)
        self.settings = settings or TrialSimulationSettings()
        surfaces = surface_files(self.model, [leg.model])
        self.joint = tibiofemoral_contact(surfaces, joint_surfaces(self.model), side, kind)
        self.simulation = simulate_trial(
            self.model, self.trial, [self.joint.contact], MUSCLES, self.settings
        )
        self.pressures = {
            "tibiofemoral": contact_pressures(self.joint.reference, self.simulation.poses[:, 0])
        }

    def write(self, folder, **changes):
        simulation = replace(self.simulation, **changes)
        inputs = {"model": self.leg.model, "motion": self.leg.motion, "paths": None}
        return write_trial_simulation(
            folder, self.model, self.trial, simulation, [self.joint], MUSCLES, self.settings, inputs,
            self.pressures,
        )  # fmt: skip


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    return write_leg(tmp_path_factory.mktemp("right"), "right")


@pytest.fixture(scope="module")
def right(leg):
    return Run(leg, "right")


@pytest.fixture(scope="module")
def written(right, tmp_path_factory):
    folder = tmp_path_factory.mktemp("written") / "out"
    right.write(folder)
    return folder


def table(file):
    """Columns by name, without time."""
    motion = io.read_motion(file, True)
    return dict(zip(motion.names, np.asarray(motion.data).T, strict=True))


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def contact_pose(run, q):
    """Pose of F in T at a configuration."""
    placed, contact = Kinematics(run.model.core, q).body_placements, run.joint.contact
    X_GF = placed[run.model.body(contact.moving_body)] @ contact.X_BF
    X_GT = placed[run.model.body(contact.fixed_body)] @ contact.X_BT
    X_TF = np.linalg.inv(X_GT) @ X_GF
    return pose_from_transform(X_TF[:3, :3].copy(), X_TF[:3, 3].copy())


def test_what_is_found_is_an_equilibrium(right):
    """Inverse dynamics, ligaments, springs and moment arms of the analysis at the configuration found."""
    found, model = right.simulation, right.model
    assert found.converged
    assert found.force_dependent == FORCE_DEPENDENT
    columns = [model.coordinate(name) for name in FORCE_DEPENDENT]
    rates = [right.trial.qd.copy(), right.trial.qdd.copy()]
    for rate in rates:  # secondary coordinates are quasi-static
        rate[:, columns] = 0.0
    trial = replace(right.trial, q=found.q, qd=rates[0], qdd=rates[1])
    parts = analyse_trial(model, trial, MUSCLES)
    pull = np.einsum("tnm,tm->tn", parts.moment_arms, found.muscle_forces)
    left = parts.generalised_forces - parts.ligament_loads - parts.spring_loads - pull
    left -= found.contact_loads
    # Taken off by another sum: rounding of some kN.
    limits = np.array([5e-4] * 2 + [0.01] * 3) + 1e-8
    assert (np.abs(left[:, columns]) <= limits).all()
    # Muscles and their reserve, within recruitment's own tolerance: 1e-6 of some 40 Nm.
    flexion = model.coordinate("flexion")
    np.testing.assert_allclose(left[:, flexion], found.reserves[:, 0], rtol=0, atol=1e-4)
    np.testing.assert_allclose(found.residuals[:, columns], left[:, columns], rtol=0, atol=1e-8)
    scaled = scaled_residuals(model, found, right.settings)
    np.testing.assert_allclose(
        scaled, np.abs(left[:, columns] / limits).max(axis=1), rtol=0, atol=1e-4
    )


def test_contact_loads_are_the_derivative_of_the_energy(right):
    found, frame, step = right.simulation, 4, 5e-8
    for name in ("flexion", *FORCE_DEPENDENT):
        column = right.model.coordinate(name)
        energy = []
        for sign in (1.0, -1.0):
            q = found.q[frame].copy()
            q[column] += sign * step
            pose = contact_pose(right, q)
            energy.append(right.joint.reference.evaluate_details(pose[None], 1).energy.sum())
        # The step is so small that hardly a face finds another closest triangle; rounding leaves 1e-6 N.
        expected = -(energy[0] - energy[1]) / (2 * step)
        assert found.contact_loads[frame, column] == pytest.approx(expected, rel=2e-4, abs=2e-3)
    assert np.abs(found.contact_loads[frame]).max() > 500.0


def test_wrenches_and_poses_are_those_of_the_bodies(right):
    """The pose from where the bodies are, the wrench from the contact's own evaluation there."""
    found, contact = right.simulation, right.joint.contact
    placed = Kinematics(right.model.core, found.q[3]).body_placements
    np.testing.assert_allclose(found.rotations[3], placed[:, :3, :3], rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.positions[3], placed[:, :3, 3], rtol=0, atol=1e-14)
    poses = [contact_pose(right, q) for q in found.q]
    np.testing.assert_allclose(poses, found.poses[:, 0], rtol=0, atol=1e-12)
    loads = contact.model.evaluate(np.ascontiguousarray(found.poses[:, 0]), Derivatives.none, 1)
    # The bodies' pose and the written one differ by rounding: 1e-15 m times some 1e7 N/m.
    np.testing.assert_allclose(loads.wrench, found.wrenches[:, 0], rtol=0, atol=1e-6)
    assert found.wrenches[:, 0, :, 1].min() > 20.0  # both sides carry


def test_a_left_leg_is_the_right_one_in_a_mirror(right, tmp_path):
    left = Run(write_leg(tmp_path, "left"), "left").simulation
    found = right.simulation
    # Meshes are mirrored to single precision (STL): 1e-9 m of some cm, times the stiffness over the knee's softest.
    np.testing.assert_allclose(left.q, found.q, rtol=0, atol=2e-6)
    mirror = np.array([1, 1, -1, -1, -1, 1.0])
    np.testing.assert_allclose(
        left.wrenches, found.wrenches * mirror, rtol=0, atol=0.3
    )  # sides keep their names
    kinematics = left.kinematics("tibiofemoral")
    np.testing.assert_allclose(kinematics, found.kinematics("tibiofemoral"), rtol=0, atol=2e-6)


def test_pressures_are_the_law_s(right):
    found = right.pressures["tibiofemoral"]
    np.testing.assert_allclose(found.peak_pressure, 9.3e9 * found.max_depth, rtol=1e-12)
    assert (found.mean_pressure < found.peak_pressure).all()
    np.testing.assert_allclose(found.wrench, right.simulation.wrenches[:, 0], rtol=0, atol=1e-6)
    # A right knee: medial is z < 0. The centres are on the insert, below Fo.
    assert (found.centre_of_pressure[:, 0, 2] < 0).all()
    assert (found.centre_of_pressure[:, 1, 2] > 0).all()
    apart = contact_pressures(
        right.joint.reference, np.array([[0.0, 0.09, 0, 0, 0, 0], [np.nan] * 6])
    )
    assert np.isnan(apart.centre_of_pressure).all()
    assert (apart.area[0] == 0.0).all() and np.isnan(apart.area[1]).all()


def test_files_are_the_results_by_name(right, written):
    names = sorted(file.name for file in written.iterdir())
    assert names == [
        "activities.sto", "coordinates.sto", "generalised_forces.sto", "ligament_forces.sto", "ligament_strains.sto",
        "muscle_forces.sto", "record.csv", "reserves.sto", "residuals.sto", "simulation.parquet", "summary.json",
        "tibiofemoral_contact.sto", "tibiofemoral_kinematics.sto", "tibiofemoral_pressures.sto",
    ]  # fmt: skip
    found = right.simulation
    for i, name in enumerate(right.model.coordinate_names):
        np.testing.assert_array_equal(table(written / "coordinates.sto")[name], found.q[:, i])
    assert list(table(written / "generalised_forces.sto"))[1:4] == [
        "flexion_moment", "adduction_moment", "rotation_moment",
    ]  # fmt: skip
    assert list(table(written / "residuals.sto"))[-1] == "tz_force"
    contact = table(written / "tibiofemoral_contact.sto")
    np.testing.assert_array_equal(contact["theta_z"], found.poses[:, 0, 5])
    np.testing.assert_array_equal(contact["lateral_Fy"], found.wrenches[:, 0, 1, 1])
    np.testing.assert_array_equal(contact["total_Mx"], contact["medial_Mx"] + contact["lateral_Mx"])
    assert not contact["medial_error_Fy"].any() and (contact["trust"] == 1.0).all()
    kinematics = table(written / "tibiofemoral_kinematics.sto")
    np.testing.assert_array_equal(kinematics["flexion_rad"], found.kinematics("tibiofemoral")[:, 0])
    pressures = table(written / "tibiofemoral_pressures.sto")
    np.testing.assert_array_equal(
        pressures["medial_cop_z"], right.pressures["tibiofemoral"].centre_of_pressure[:, 0, 2]
    )


def test_the_parquet_file_holds_everything_once_more(right, written):
    whole = pq.read_table(written / "simulation.parquet")
    for file in written.glob("*.sto"):
        for name, values in table(file).items():
            np.testing.assert_array_equal(whole[f"{file.stem}/{name}"].to_numpy(), values)
    np.testing.assert_array_equal(whole["time"].to_numpy(), right.simulation.times)
    np.testing.assert_array_equal(
        whole["muscle_lengths/hamstring_lateral"].to_numpy(), right.simulation.muscle_lengths[:, 3]
    )
    units = {field.name: (field.metadata or {}).get(b"unit") for field in whole.schema}
    assert units["coordinates/tz"] == b"m" and units["residuals/tz_force"] == b"N"
    assert units["residuals/flexion_moment"] == b"Nm" and units["time"] == b"s"
    assert units["tibiofemoral_contact/lateral_Mx"] == b"Nm"
    assert units["tibiofemoral_pressures/medial_peak_pressure"] == b"Pa"
    assert units["activities/hamstring_lateral"] is None
    told, summary = json.loads(whole.schema.metadata[b"condyle"]), summary_of(written)
    del summary["files"]
    assert told == summary
    with (written / "record.csv").open(encoding="utf-8") as file:
        for row, status in zip(
            csv.DictReader(file), whole["record/status"].to_pylist(), strict=True
        ):
            assert row["status"] == status == "converged"
            assert float(row["scaled_residual"]) <= 1.0


def test_the_summary_says_what_it_came_from(right, leg, written):
    summary = summary_of(written)
    for name, digest in summary["files"].items():
        assert content_hash((written / name).read_bytes()) == digest
    assert summary["inputs"]["model"] == {
        "name": "leg.json", "sha256": content_hash(leg.model.read_bytes()),
    }  # fmt: skip
    assert "paths" not in summary["inputs"]
    assert summary["settings"]["newton"]["force_tolerance_N"] == 0.01
    assert summary["settings"]["muscles"]["reserve_moment"] == 7.3
    (contact,) = summary["contacts"]
    assert contact["contact"] == "exact" and contact["side_of_body"] == "right"
    assert contact["reference"]["law"] == {"name": "linear_volume", "modulus_N_per_m3": 9.3e9}
    assert contact["meshes"] == right.joint.reference.mesh_hashes()
    assert contact["moving"]["body"] == "thigh" and contact["fixed"]["surface"] == "insert"
    assert summary["status"] == {"converged": 9}
    assert summary["not_in_equilibrium"] == []
    compression = right.simulation.wrenches[:, 0, :, 1]
    peak = summary["peak_forces"]["tibiofemoral"]
    assert peak["load"] == "Fy"
    assert peak["total"]["value_N"] == compression.sum(axis=1).max()
    assert peak["lateral"]["time"] == right.simulation.times[compression[:, 1].argmax()]
    for file in ("summary.json", "record.csv", "simulation.parquet", "coordinates.sto"):
        assert str(leg.folder).encode() not in (written / file).read_bytes()


def test_same_inputs_same_bytes_on_any_number_of_threads(leg, tmp_path):
    folders = []
    for threads in (1, 3):
        settings = TrialSimulationSettings()
        settings.chunk, settings.threads = 4, threads
        folders.append(tmp_path / str(threads))
        Run(leg, "right", settings=settings).write(folders[-1])
    for file in folders[0].iterdir():
        assert file.read_bytes() == (folders[1] / file.name).read_bytes(), file.name


def test_what_is_not_in_equilibrium_is_kept_and_named(leg, tmp_path):
    """One Newton step is not enough for any time frame; the best that was found is written."""
    settings = TrialSimulationSettings()
    settings.solver.newton.max_iterations = 1
    settings.solver.max_substeps = 1
    settings.solver.softer_contact = []
    run = Run(leg, "right", settings=settings)
    run.write(tmp_path)
    summary = summary_of(tmp_path)
    assert summary["status"]["not_converged"] == len(summary["not_in_equilibrium"]) > 0
    first = summary["not_in_equilibrium"][0]
    record = run.simulation.records[0]
    assert first["time"] == run.simulation.times[0]
    assert first["worst_coordinate"] in FORCE_DEPENDENT
    unit = "N" if first["worst_coordinate"].startswith("t") else "Nm"
    residual = first[f"residual_{unit}"]
    assert abs(residual) > {"N": 0.01, "Nm": 5e-4}[unit]
    assert residual == record.residual[FORCE_DEPENDENT.index(first["worst_coordinate"])]
    assert first["scaled_residual"] > 1.0
    assert f"remain on {first['worst_coordinate']}" in first["message"]
    assert len(table(tmp_path / "coordinates.sto")["ty"]) == 9


def test_peaks_are_of_time_frames_in_equilibrium(right):
    found = right.simulation
    highest = int(found.wrenches[:, 0, :, 1].sum(axis=1).argmax())
    records = list(found.records)
    records[highest] = replace(records[highest], status="not_converged")
    peaks = contact_peaks(replace(found, records=tuple(records)), "tibiofemoral")
    assert peaks["total"]["time"] != found.times[highest]
    none = tuple(replace(record, status="not_converged") for record in records)
    assert contact_peaks(replace(found, records=none), "tibiofemoral") == {"load": "Fy"}


def test_results_that_are_not_finite_are_no_summary_s_numbers(right, tmp_path):
    """A time frame whose iteration left the numbers behind: NaN in tables, null in JSON."""
    found = right.simulation
    records, wrenches = list(found.records), found.wrenches.copy()
    records[2] = replace(
        records[2], status="not_converged", residual=np.full(5, np.nan), message="left the numbers"
    )
    wrenches[2] = np.nan
    right.write(tmp_path, records=tuple(records), wrenches=wrenches)
    (bad,) = summary_of(tmp_path)["not_in_equilibrium"]
    assert bad["message"] == "left the numbers" and bad["scaled_residual"] is None
    assert np.isnan(table(tmp_path / "tibiofemoral_contact.sto")["medial_Fy"][2])
    peak = summary_of(tmp_path)["peak_forces"]["tibiofemoral"]["medial"]["value_N"]
    assert peak == np.nanmax(wrenches[:, 0, 0, 1])


def test_files_of_an_earlier_run_do_not_stay(right, tmp_path):
    right.write(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    right.pressures, kept = {}, right.pressures
    try:
        right.write(tmp_path)
    finally:
        right.pressures = kept
    assert not (tmp_path / "tibiofemoral_pressures.sto").exists()
    assert (tmp_path / "notes.txt").exists()
    assert "tibiofemoral_pressures.sto" not in summary_of(tmp_path)["files"]


def test_a_foot_pulled_down_lifts_the_joint_off(leg, tmp_path):
    """Tension instead of compression: ligaments carry, contact opens, and its centre is nowhere."""
    times = read_trial(MusculoskeletalModel.read(leg.model), leg.motion).times
    write_floor(tmp_path, "right", times, -900.0)
    run = Run(leg, "right", floor=tmp_path / "floor.xml")
    assert run.simulation.converged
    open_sides = run.simulation.wrenches[:, 0, :, 1] == 0.0
    assert open_sides.any()
    centres = run.pressures["tibiofemoral"].centre_of_pressure
    np.testing.assert_array_equal(np.isnan(centres).all(axis=2), open_sides)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"kind": "hybrid"}, "contact 'hybrid' needs a surrogate file"),
        ({"kind": "surrogate"}, "contact 'surrogate' needs a surrogate file"),
        ({"own": True}, "surface 'femoral_component' (FOLDER/femur.stl) needs body and placement of a mesh"),
        ({"none": True}, "no mesh of surface 'femoral_component' (there are: none)"),
        ({"unplaced": True}, "the femur's surface has no mesh: fast contact needs one"),
        ({"depth": 0.0}, "plausible_depth"),
    ],
)  # fmt: skip
def test_contacts_that_cannot_be_are_refused(leg, tmp_path, changes, words):
    model = MusculoskeletalModel.read(leg.model)
    surfaces = surface_files(model, [leg.model])
    if "own" in changes:
        surfaces = surface_files(model)
    if "none" in changes:
        surfaces = {}
    if "unplaced" in changes:
        content = {"contact_surfaces": [dict(s) for s in leg.content["contact_surfaces"]]}
        for surface in content["contact_surfaces"]:
            del surface["mesh"]
        (tmp_path / "frames.json").write_text(json.dumps(content))
        surfaces = surface_files(model, [tmp_path / "frames.json"])
    settings = ReferenceSettings(plausible_depth=changes.get("depth", 2e-3))
    with pytest.raises(ValueError) as refused:
        tibiofemoral_contact(
            surfaces, joint_surfaces(model), "right", changes.get("kind", "fast"), settings=settings
        )
    assert words.replace("FOLDER", str(leg.folder)) in str(refused.value)


def test_a_contact_of_the_other_knee_is_refused(right):
    contact = right.joint.contact
    other = BodyContact(
        name="tibiofemoral", model=contact.model, moving_body="thigh", fixed_body="shank", side_of_body="left"
    )  # fmt: skip
    with pytest.raises(ValueError, match=r"contact 'tibiofemoral': .*left"):
        simulate_trial(right.model, right.trial, [other], MUSCLES)


@pytest.mark.parametrize(
    ("pairs", "arguments", "words"),
    [
        ([], {}, "femur and insert: model 'right leg' has no contact pair that says which surface that is; name it "
         "(surfaces: femoral_component, insert)"),
        ([("a", "femoral_component", "insert"), ("b", "insert", "femoral_component")], {},
         "femur and insert: model 'right leg' has 2 such contact pairs (a: femoral_component, insert; b: femoral_"),
        ([], {"femur": "femoral", "insert": "insert"}, "has no contact surface 'femoral'"),
        ([], {"femur": "insert", "insert": "insert"}, "femur and insert are both 'insert': must be two surfaces"),
        ([], {"femur": "femoral_component"}, "insert: model 'right leg' has no contact pair"),
        ([("a", "femoral_component", "insert")], {"patella": "button"}, "no contact surface 'button'"),
    ],
)  # fmt: skip
def test_surfaces_that_are_not_clear_are_asked_for(leg, tmp_path, pairs, arguments, words):
    content = leg.content | {
        "contact_pairs": [{"name": n, "first": a, "second": b} for n, a, b in pairs]
    }
    (tmp_path / "leg.json").write_text(json.dumps(content))
    with pytest.raises(InputDataError) as refused:
        joint_surfaces(MusculoskeletalModel.read(tmp_path / "leg.json"), **arguments)
    assert words in str(refused.value)


def test_the_documentation_s_example_runs(tmp_path, capsys, monkeypatch):
    """With the leg in the place of DM, whose paths need no snapshots."""
    leg = write_leg(tmp_path, "right", frames=5, mesh_edge=2e-3)
    for name, file in {
        "dm.json": leg.model,
        "dm_surfaces.json": leg.model,
        "coordinates.sto": leg.motion,
        "external_loads.xml": leg.loads,
    }.items():
        (tmp_path / name).write_bytes(file.read_bytes())
    text = (Path(__file__).parents[3] / "docs" / "simulation.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    for there, here in ((', snapshots="paths.json"', ""), ("start=2.406, end=3.125", "start=0.52")):
        assert there in example
        example = example.replace(there, here)
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "simulation.md", "exec"), {})
    assert capsys.readouterr().out.startswith("4 of 4 time frames converged [")
