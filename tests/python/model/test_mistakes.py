# SPDX-License-Identifier: Apache-2.0
"""A model or a trial that does not fit: each mistake ends in one sentence that names file, item and value."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from condyle._core import io
from condyle.model import (
    MuscleSettings,
    MusculoskeletalModel,
    analyse_trial,
    make_trial,
    read_trial,
    surface_files,
    with_snapshots,
)

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "pendulum.json"
TIMES = 0.01 * np.arange(21)
LOADS = """<OpenSimDocument Version="40000"><ExternalLoads><objects>
<ExternalForce name="plate"><applied_to_body>lower</applied_to_body>
<force_identifier>f_v</force_identifier><point_identifier>f_p</point_identifier>
</ExternalForce></objects><datafile>grf.sto</datafile></ExternalLoads></OpenSimDocument>"""


@pytest.fixture
def pendulum():
    return MusculoskeletalModel.read(EXAMPLE)


@pytest.fixture
def edited(tmp_path):
    """Reads the example as a model, after an edit."""

    def read(edit):
        content = json.loads(EXAMPLE.read_text(encoding="utf-8"))
        edit(content)
        (tmp_path / "arm.json").write_text(json.dumps(content), encoding="utf-8")
        return MusculoskeletalModel.read(tmp_path / "arm.json")

    return read


@pytest.fixture
def motion(tmp_path):
    """Writes walk.sto: columns by name, in rad unless told."""

    def write(in_degrees=False, **columns):
        data = np.stack([np.broadcast_to(v, TIMES.shape) for v in columns.values()], axis=1)
        made = io.make_motion("walk", list(columns), TIMES, np.ascontiguousarray(data), in_degrees)
        io.write_motion(made, tmp_path / "walk.sto")
        return tmp_path / "walk.sto"

    return write


def refused(call, *arguments, **options):
    """The one sentence of the refusal."""
    with pytest.raises(ValueError) as caught:
        call(*arguments, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_model_without_its_forearm(edited):
    def amputate(model):
        del model["bodies"][1]

    message = refused(edited, amputate)
    assert re.fullmatch(
        r".*arm\.json: joint 'elbow': child\.body is 'lower'; the model has no such body", message
    )


def test_a_muscle_on_a_body_that_is_not_there(edited):
    def misspell(model):
        model["muscles"][0]["path"]["points"][1]["body"] = "tibia_r"

    assert refused(edited, misspell).endswith(
        "arm.json: muscle 'flexor': path.points[1].body is 'tibia_r'; the model has no such body"
    )


def test_a_body_that_no_joint_hangs_anywhere(edited):
    def loosen(model):
        del model["joints"][1]
        model["muscles"], model["springs"] = [], []

    message = refused(edited, loosen)
    assert "arm.json" in message
    assert "'lower'" in message


def test_a_muscle_without_strength(edited):
    def weaken(model):
        model["muscles"][0]["max_isometric_force"] = 0

    assert refused(edited, weaken).endswith(
        "arm.json: muscle 'flexor': max_isometric_force is 0 N; it must be above 0"
    )


def test_misspelt_columns_name_the_near_miss(pendulum, motion):
    file = motion(shoulder_flexion=0.1, elbow_flexon=0.2)
    assert refused(read_trial, pendulum, file) == (
        f"{file}: column 'elbow_flexon' is no coordinate of model 'double pendulum'; "
        "did you mean 'elbow_flexion'?"
    )


def test_a_column_too_many(pendulum, motion):
    file = motion(shoulder_flexion=0.1, elbow_flexion=0.2, zzz=1.0, yyy=1.0)
    assert refused(read_trial, pendulum, file) == (
        f"{file}: column 'zzz' is no coordinate of model 'double pendulum' (2 such columns)"
    )


def test_a_missing_column_unless_the_coordinate_is_locked(pendulum, motion, edited):
    file = motion(shoulder_flexion=0.1)
    assert refused(read_trial, pendulum, file) == (
        f"{file}: no column for elbow_flexion; model 'double pendulum' neither locks nor couples them"
    )

    def lock(model):
        model["coordinates"][1]["locked"] = True

    trial = read_trial(edited(lock), file)
    assert (trial.q[:, 1] == 0.5).all()  # its default


def test_a_force_dependent_coordinate_needs_no_column(motion, edited):
    def free(model):
        model["coordinates"][1] |= {"role": "force_dependent", "balanced_by": "reaction"}

    trial = read_trial(edited(free), motion(shoulder_flexion=0.1))
    assert trial.at_default == ("elbow_flexion",)
    assert (trial.q[:, 1] == 0.5).all()


def test_degrees_that_are_said_to_be_radians(pendulum, motion):
    file = motion(shoulder_flexion=0.1, elbow_flexion=60 + 200 * TIMES)
    assert refused(read_trial, pendulum, file) == (
        f"{file}: column 'elbow_flexion' is 100 rad at 0.2 s; its range in model 'double pendulum' is "
        "0 to 2.5 rad: are these degrees, with inDegrees=no in the header?"
    )
    assert len(read_trial(pendulum, file, range_factor=np.inf)) == len(TIMES)
    assert len(read_trial(pendulum, motion(True, shoulder_flexion=0.1, elbow_flexion=100))) == 21


def test_millimetres_that_are_said_to_be_metres(edited, motion):
    def slide(model):
        model["coordinates"][0] |= {"motion": "translational", "range": [-0.01, 0.01]}

    model = edited(slide)
    file = motion(shoulder_flexion=-20.0, elbow_flexion=0.2)
    assert refused(read_trial, model, file).endswith("are these millimetres?")
    # Three times a narrow range is not much: 14 cm is not taken for 0.14 mm.
    assert len(read_trial(model, motion(shoulder_flexion=-0.14, elbow_flexion=0.2))) == 21


def test_a_range_that_is_none_says_nothing(edited, motion):
    def unbound(model):
        for coordinate in model["coordinates"]:
            del coordinate["range"]

    assert len(read_trial(edited(unbound), motion(shoulder_flexion=70, elbow_flexion=80))) == 21


def test_times_that_the_motion_has_not(pendulum, motion):
    file = motion(shoulder_flexion=0.1, elbow_flexion=0.2)
    assert refused(read_trial, pendulum, file, start=3.0) == (
        f"{file}: no time frame from 3 s; it has 0 to 0.2 s"
    )
    trial = read_trial(pendulum, file, start=0.05, end=0.1)
    assert (len(trial), trial.nearest(0.073)) == (6, 2)
    assert refused(trial.nearest, 0.2) == "no time frame at 0.2 s; the trial has 0.05 to 0.1 s"


def test_a_gap_in_the_ground_reactions(pendulum, motion, tmp_path):
    file = motion(shoulder_flexion=0.1, elbow_flexion=0.2)
    data = np.full((len(TIMES), 6), 3.0)
    data[5:8, 4] = np.nan
    names = [f"f_{kind}{axis}" for kind in "vp" for axis in "xyz"]
    io.write_motion(io.make_motion("grf", names, TIMES, data, None), tmp_path / "grf.sto")
    (tmp_path / "loads.xml").write_text(LOADS, encoding="utf-8")
    message = refused(read_trial, pendulum, file, external_loads=tmp_path / "loads.xml")
    assert message == (
        f"{tmp_path / 'grf.sto'}: column 'f_py' is NaN from 0.05 to 0.07 s, while the force 'plate' is "
        "5.196152422706632 N at 0.05 s (up to 0 N it may be: negligible_force)"
    )
    trial = read_trial(pendulum, file, external_loads=tmp_path / "loads.xml", negligible_force=6.0)
    # The spline through force and none overshoots; far from the gap it is the table's.
    assert trial.loads[15, 0, 1] == pytest.approx(3.0, abs=0.01)
    assert trial.loads[6, 0, 0] == 0.0


def snapshots(tmp_path, times, ends):
    content = {
        "format": "condyle-path-snapshots",
        "version": 1,
        "source": "a test",
        "bodies": ["ground", "upper", "lower"],
        "times": list(times),
        "paths": {"flexor": [{"points": ends} for _ in times]},
    }
    (tmp_path / "paths.json").write_text(json.dumps(content), encoding="utf-8")
    return tmp_path / "paths.json"


def test_snapshots_of_another_trial_or_model(pendulum, motion, tmp_path):
    trial = read_trial(pendulum, motion(shoulder_flexion=0.1, elbow_flexion=0.2))
    ends = [[0, 0.03, 1.41, 0.005], [2, 0.02, -0.05, 0.004]]
    file = snapshots(tmp_path, TIMES, ends)
    assert with_snapshots(pendulum, trial, file).snapshot_rows == tuple(range(21))
    file = snapshots(tmp_path, [0.0, 0.4], ends)
    assert refused(with_snapshots, pendulum, trial, file) == (
        f"{file}: no snapshot at 0.01 s; it has 2 from 0 to 0.4 s: snapshots are made of the motion "
        "that they go with"
    )
    file = snapshots(tmp_path, TIMES, [ends[0], [2, 0.02, -0.055, 0.004]])
    assert refused(with_snapshots, pendulum, trial, file) == (
        f"{file}: muscle 'flexor' ends 5 mm from where model 'double pendulum' has it: snapshots of "
        "another model"
    )


def test_loads_beyond_every_muscle_are_a_status_not_an_exception(pendulum):
    load = np.tile([900.0, 0, 0, 0, 1.0, 0, 0, 0, 0], (2, 1, 1))
    load[0] = 0.0
    trial = make_trial(
        pendulum, np.arange(2.0), np.full((2, 2), 0.4), load_bodies=("lower",), loads=load
    )
    found = analyse_trial(pendulum, trial)
    assert found.status[1] == "infeasible"
    assert "elbow_flexion" in found.messages[1]
    reserved = analyse_trial(pendulum, trial, MuscleSettings(reserve_moment=5000.0))
    assert reserved.status == ("converged", "converged")


def test_settings_that_are_none(pendulum):
    trial = make_trial(pendulum, np.zeros(1), np.zeros((1, 2)))
    message = refused(analyse_trial, pendulum, trial, MuscleSettings(criterion="min-max"))
    assert message == "criterion is 'min-max'; it must be a power or 'min_max'"
    message = refused(analyse_trial, pendulum, trial, MuscleSettings(strength="thelen"))
    assert message == "strength is 'thelen'; it must be 'hill' or 'constant'"
    assert "0.5" in refused(analyse_trial, pendulum, trial, MuscleSettings(criterion=0.5))
    assert refused(make_trial, pendulum, np.zeros(3), np.zeros((2, 3))) == (
        "q has shape (2, 3); it must have (3, 2) (time frames, coordinates)"
    )


def test_meshes_that_are_none(edited, tmp_path):
    def touch(model):
        frame = {"body": "lower"}
        model["contact_surfaces"] = [{"name": "shell", "frame": frame, "mesh": "shell.stl"}]

    model = edited(touch)
    assert surface_files(model) == {}
    assert refused(surface_files, model, ["nowhere"]) == (
        "meshes nowhere: must be a folder, NAME=FILE or a JSON file with contact_surfaces"
    )
    assert refused(surface_files, model, ["shel=a.stl"]) == (
        "model 'double pendulum' has no contact surface 'shel'; did you mean 'shell'?"
    )
    assert refused(surface_files, model, ["shell=a.stl"]) == "shell=a.stl: there is no such file"
    mapping = tmp_path / "surfaces.json"
    mapping.write_text('{"contact_surfaces": [{"name": "shell", "mesh": "a.stl"}]}')
    assert refused(surface_files, model, [mapping]).startswith(f"{mapping}: no 'frame'; ")
    surface = {"name": "shell", "mesh": "a.stl", "frame": {"body": "tibia"}}
    mapping.write_text(json.dumps({"contact_surfaces": [surface]}))
    assert refused(surface_files, model, [mapping]).startswith(
        f"{mapping}: model 'double pendulum' has no body 'tibia'"
    )
