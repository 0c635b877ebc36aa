# SPDX-License-Identifier: Apache-2.0
"""A patella on a hinge: the laws of a hinge and of a linear ligament, both knees, and what is refused by name."""

import copy
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from patella_model import DEFAULTS, SIX, button_mesh, femur_mesh, knee_model, write_knee

from condyle._core import io
from condyle._core.common import pose_from_transform
from condyle._core.model import Kinematics
from condyle.contact import ContactPair
from condyle.errors import InputDataError
from condyle.model import (
    JointSurfaces,
    MusculoskeletalModel,
    analyse_trial,
    hinge_patella,
    joint_surfaces,
    make_trial,
    read_trial,
    surface_files,
)
from condyle.model.carried_mass import carry_mass

SCHEMA = Path(__file__).parents[3] / "docs" / "schema" / "model.schema.json"
JOINT = JointSurfaces("femur", "insert", "button")
TURNS_DEG = (-40.0, -7.0, 0.0, 13.0, 61.0, 118.0)


class Knee:
    """A knee before and after, and where its bodies are."""

    def __init__(self, folder, side_of_body):
        self.file = write_knee(folder, side_of_body)
        self.before = MusculoskeletalModel.read(self.file)
        self.surfaces = surface_files(self.before, [self.file])
        self.hinged = hinge_patella(
            self.before, self.surfaces, joint_surfaces(self.before), stiffness=9.1e5
        )
        self.after = self.hinged.model
        self.pair = ContactPair(femur_mesh(side_of_body), {"button": button_mesh()})
        self.content = json.loads(self.hinged.text())

    def configuration(self, turn_deg, **others):
        """Coordinates of the hinged model: the patella turned from rest."""
        rest = dict(zip(SIX, DEFAULTS, strict=True))["p_flex"]
        return self.after.default_q({"p_flex": rest + math.radians(turn_deg), **others})


def placements(model, q):
    X = np.asarray(Kinematics(model.core, np.ascontiguousarray(q)).body_placements)
    return {name: X[i] for i, name in enumerate(model.body_names)}


def patella_in_thigh(model, q):
    X = placements(model, q)
    return np.linalg.inv(X["thigh"]) @ X["kneecap"]


@pytest.fixture(scope="module")
def right(tmp_path_factory):
    return Knee(tmp_path_factory.mktemp("right"), "right")


@pytest.fixture(scope="module")
def left(tmp_path_factory):
    return Knee(tmp_path_factory.mktemp("left"), "left")


def test_the_patella_turns_about_one_axis_fixed_in_the_femur(right):
    axis, origin = right.hinged.hinge.X_BH[:3, 2], right.hinged.hinge.X_BH[:3, 3]
    rest = patella_in_thigh(right.after, right.configuration(0.0))
    for turn in TURNS_DEG:
        # Flexion turns it negatively about an axis that points to the right, wherever the leg is.
        now = patella_in_thigh(right.after, right.configuration(turn, hip=0.4, flexion=0.7))
        moved = now @ np.linalg.inv(rest)
        np.testing.assert_allclose(moved[:3, :3] @ axis, axis, rtol=0, atol=1e-12)
        np.testing.assert_allclose(
            moved[:3, :3] @ origin + moved[:3, 3], origin, rtol=0, atol=1e-12
        )
        across = right.hinged.hinge.X_BH[:3, 0]
        turned = moved[:3, :3] @ across
        found = math.degrees(math.atan2(np.cross(across, turned) @ axis, across @ turned))
        assert found == pytest.approx(-turn, abs=1e-9)


def test_the_axis_is_that_of_the_trochlea_s_cylinder(right):
    X_BF = right.surfaces["femur"].placement
    fit, hinge = right.hinged.trochlea.cylinder, right.hinged.hinge
    np.testing.assert_allclose(hinge.X_BH[:3, 2], X_BF[:3, :3] @ fit.axis, rtol=0, atol=1e-12)
    centre = X_BF[:3, :3] @ fit.centre + X_BF[:3, 3]
    off = np.cross(hinge.X_BH[:3, 3] - centre, hinge.X_BH[:3, 2])
    np.testing.assert_allclose(off, 0.0, rtol=0, atol=1e-12)


def overlap(knee, q, inwards=0.0, along=0.0):
    """Largest depth of the button in the femoral component [m], pushed towards the hinge's axis and along it."""
    X = placements(knee.after, q)
    axis, origin = ((X["thigh"] @ knee.hinged.hinge.X_BH)[:3, k] for k in (2, 3))
    X_GP = X["kneecap"] @ knee.surfaces["button"].placement
    out = X_GP[:3, 3] - origin
    out -= (out @ axis) * axis
    X_GP[:3, 3] += along * axis - inwards * out / np.linalg.norm(out)
    X_PF = np.linalg.inv(X_GP) @ X["thigh"] @ knee.surfaces["femur"].placement
    pose = pose_from_transform(
        np.ascontiguousarray(X_PF[:3, :3]), np.ascontiguousarray(X_PF[:3, 3])
    )
    return float(knee.pair.evaluate(pose[None]).max_depth[0, 0])


def test_at_rest_the_button_is_seated_in_the_groove(right):
    q = right.configuration(0.0)
    # The search ends within a micrometre of touch.
    assert overlap(right, q) < 2e-6
    assert overlap(right, q, inwards=10e-6) > 0.0
    assert overlap(right, q, inwards=-5e-6) == 0.0
    # To either side along the axis it would have to come out: the groove's walls are in the way.
    for aside in (-0.4e-3, 0.4e-3):
        assert overlap(right, q, along=aside) > 2e-6
    # Its orientation is the default posture's, and the turn there is the flexion's default.
    before = patella_in_thigh(right.before, right.before.default_q())
    after = patella_in_thigh(right.after, right.after.default_q())
    np.testing.assert_allclose(after[:3, :3], before[:3, :3], rtol=0, atol=1e-12)
    away = right.hinged.hinge.X_BH[:3, :3].T @ (after[:3, 3] - before[:3, 3])
    np.testing.assert_allclose(
        away, [-right.hinged.seat.inwards, 0.0, right.hinged.seat.along], rtol=0, atol=1e-9
    )


def test_how_far_the_button_leaves_the_trochlea_is_said(right):
    seat, step = right.hinged.seat, 5e-5
    gaps = []
    for turn in range(0, 61, 10):
        q = right.configuration(turn)
        pushes = np.arange(0.0, 3e-3, step)
        gaps.append(next(p for p in pushes if overlap(right, q, inwards=p + 2e-6) > 0.0))
    assert seat.overlap < 1e-6
    assert 0.5e-3 < max(gaps) < 2e-3
    assert max(gaps) == pytest.approx(seat.gap, abs=step)


def test_the_other_five_coordinates_say_where_the_hinge_has_put_the_patella(right):
    columns = [right.after.coordinate(name) for name in SIX]
    for turn in (-21.0, 0.0, 16.0, 57.0, 93.0):
        kinematics = Kinematics(right.after.core, np.ascontiguousarray(right.configuration(turn)))
        q = right.before.default_q()
        q[[right.before.coordinate(name) for name in SIX]] = np.asarray(kinematics.q)[columns]
        told = patella_in_thigh(right.before, q)
        true = patella_in_thigh(right.after, right.configuration(turn))
        # But for the sixth: the turn about the hinge is not quite the old flexion, about another axis and a point 2 mm
        # from the patella's origin.
        R = told[:3, :3].T @ true[:3, :3]
        off = np.arccos(min((np.trace(R) - 1) / 2, 1.0))
        assert off < np.radians(0.1)
        np.testing.assert_allclose(told[:3, 3], true[:3, 3], rtol=0, atol=1e-7 + 0.003 * off)


def test_a_coordinate_that_follows_moves_nothing(right):
    q = right.configuration(10.0)
    other = q.copy()
    for name in SIX[1:]:
        other[right.after.coordinate(name)] += 0.01
    for name, X in placements(right.after, q).items():
        np.testing.assert_array_equal(placements(right.after, other)[name], X)


def test_the_ligament_is_one_linear_spring_that_is_taut_at_rest(right):
    hinged, model = right.hinged, right.after
    line = model.ligament_names.index("patellar_ligament")
    turns = np.array([0.0, 0.01, -0.01, 2.0, -2.0, -4.0])
    q = np.array([right.configuration(turn) for turn in turns])
    found = analyse_trial(model, make_trial(model, 0.1 * np.arange(len(q)), q), recruitment=False)
    forces, strains = found.ligament_forces[:, line], found.ligament_strains[:, line]
    assert hinged.slack_length == pytest.approx(right.content["ligaments"][line]["slack_length"])
    assert abs(strains[0]) < 1e-12 and abs(forces[0]) < 1e-6
    # Extension pulls the patella up: F = k (L − L₀); down, the ligament is slack.
    stretched = strains * hinged.slack_length
    assert (stretched[turns < 0] > 0).all() and (stretched[turns > 0] < 0).all()
    expected = np.where(stretched > 0, 9.1e5 * stretched, 0.0)
    np.testing.assert_allclose(forces, expected, rtol=1e-9, atol=1e-6)
    assert forces[-1] > 1000.0
    # It runs amid the strands, which stay and carry nothing.
    assert hinged.ligament.strands == ("PT1", "PT2", "PT3")
    for name in hinged.ligament.strands:
        assert (found.ligament_forces[:, model.ligament_names.index(name)] == 0.0).all()
    before = {item["name"]: item for item in knee_model("right")["ligaments"]}
    ends = [before[name]["path"]["points"] for name in hinged.ligament.strands]
    mean = np.mean(
        [p["location"] for points in ends for p in points if p["body"] == "shank"], axis=0
    )
    (tibial,) = (
        p for p in right.content["ligaments"][line]["path"]["points"] if p["body"] == "shank"
    )
    np.testing.assert_allclose(tibial["location"], mean, rtol=1e-12)
    kept = right.content["ligaments"][before_index := model.ligament_names.index("retinaculum")]
    assert before_index == 1 and kept["stiffness"] == 800.0


def test_one_strand_alone_becomes_the_line(tmp_path):
    def only_one(content):
        content["ligaments"] = [x for x in content["ligaments"] if x["name"] not in ("PT1", "PT3")]

    file = write_knee(tmp_path, edit=only_one)
    model = MusculoskeletalModel.read(file)
    hinged = hinge_patella(model, surface_files(model, [file]), JOINT)
    assert hinged.ligament.name == "PT2" and hinged.ligament.strands == ("PT2",)
    assert hinged.model.ligament_names == model.ligament_names
    (line,) = (x for x in json.loads(hinged.text())["ligaments"] if x["name"] == "PT2")
    assert line["law"] == "linear" and line["stiffness"] == 1.187e6
    assert line["slack_length"] == pytest.approx(hinged.slack_length)
    assert not any("strands" in said for said in hinged.model.not_supported)


def test_the_mass_rides_on_the_femur(right):
    """Generalised forces of the whole leg are as if the patella were fixed to the femur with its mass."""
    masses = {body["name"]: body["mass"] for body in right.content["bodies"]}
    assert masses["kneecap"] == 0.0
    assert masses["thigh"] == pytest.approx(7.3 + 0.31)
    fixed = copy.deepcopy(right.content)
    original = {body["name"]: body for body in knee_model("right")["bodies"]}
    fixed["bodies"] = [original[body["name"]] for body in fixed["bodies"]]
    heavy = MusculoskeletalModel(io.parse_model(json.dumps(fixed), "fixed"))
    q = right.configuration(0.0, hip=0.3, flexion=0.6)[None]
    qd, qdd = np.zeros_like(q), np.zeros_like(q)
    for name, rate, acceleration in (("hip", 2.0, -31.0), ("flexion", -3.0, 17.0)):
        qd[0, right.after.coordinate(name)] = rate
        qdd[0, right.after.coordinate(name)] = acceleration
    loads = [
        analyse_trial(
            model, make_trial(model, np.zeros(1), q, qd, qdd), recruitment=False, ligaments=False
        ).generalised_forces[0]
        for model in (right.after, heavy)
    ]
    for name in ("hip", "flexion"):
        c = right.after.coordinate(name)
        assert loads[0][c] == pytest.approx(loads[1][c], rel=1e-12)
    turn = right.after.coordinate("p_flex")
    assert loads[0][turn] == 0.0 and abs(loads[1][turn]) > 1e-3


def test_mass_on_ground_or_without_any_is_no_trouble():
    content = {"bodies": [{"name": "a", "mass": 0.0}, {"name": "b", "mass": 2.0}]}
    carry_mass(content, "b", "ground", np.eye(4))
    carry_mass(content, "b", "a", np.eye(4))
    assert [body["mass"] for body in content["bodies"]] == [0.0, 0.0]


def test_a_left_knee_is_the_right_one_mirrored(right, left):
    mirror = np.diag([1.0, 1.0, -1.0])
    a, b = right.hinged, left.hinged
    np.testing.assert_allclose(
        b.trochlea.cylinder.axis, mirror @ -a.trochlea.cylinder.axis, atol=1e-9
    )
    assert b.slack_length == pytest.approx(a.slack_length, abs=1e-9)
    assert b.seat.along == pytest.approx(-a.seat.along, abs=1e-9)
    for turn in TURNS_DEG:
        one = patella_in_thigh(right.after, right.configuration(turn))
        other = patella_in_thigh(left.after, left.configuration(turn))
        np.testing.assert_allclose(other[:3, :3], mirror @ one[:3, :3] @ mirror, rtol=0, atol=1e-8)
        np.testing.assert_allclose(other[:3, 3], mirror @ one[:3, 3], rtol=0, atol=1e-8)
        qs = [k.configuration(turn) for k in (right, left)]
        told = [
            np.asarray(Kinematics(k.after.core, np.ascontiguousarray(q)).q)
            for k, q in zip((right, left), qs, strict=True)
        ]
        np.testing.assert_allclose(told[1], told[0], rtol=0, atol=1e-7)


def test_the_file_is_valid_says_what_was_done_and_takes_the_trials_of_before(right, tmp_path):
    Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8"))).validate(right.content)
    assert right.content["source"].startswith(
        "written by hand; kneecap on a hinge of thigh: the axis of a cylinder of 33."
    )
    assert right.content["not_supported"] == [
        "coordinates that follow p_flex and move nothing: p_rot, p_tilt, p_tx, p_ty, p_tz",
        "stiffness of the patellar ligament's strands (patellar_ligament has it): PT1, PT2, PT3",
        "contact whose place the hinge takes: trochlea",
        "mass, which is on thigh: kneecap",
    ]
    assert [pair["name"] for pair in right.content["contact_pairs"]] == ["knee"]
    assert right.after.force_dependent == ("p_flex",)
    assert joint_surfaces(right.after).patella is None
    # A motion with columns of all six, and snapshots of a strand.
    times = 0.1 * np.arange(5)
    motion = io.make_motion(
        "walk", list(right.before.coordinate_names), times,
        np.tile(right.before.default_q(), (5, 1)), False,
    )  # fmt: skip
    io.write_motion(motion, tmp_path / "walk.sto")
    ends = [(p["body"], p["location"]) for p in right.content["ligaments"][0]["path"]["points"]]
    held = {"points": [[k, *location] for k, (_, location) in enumerate(ends)]}
    snapshots = {
        "format": "condyle-path-snapshots", "version": 1, "bodies": [body for body, _ in ends],
        "times": times.tolist(), "paths": {"PT1": [held] * 5},
    }  # fmt: skip
    (tmp_path / "paths.json").write_text(json.dumps(snapshots), encoding="utf-8")
    trial = read_trial(right.after, tmp_path / "walk.sto", snapshots=tmp_path / "paths.json")
    assert len(trial) == 5


def test_the_model_that_was_given_is_as_before(right):
    again = MusculoskeletalModel.read(right.file)
    assert io.model_text(right.before.core.description) == io.model_text(again.core.description)
    assert right.before.force_dependent == SIX


def _no_strands(content):
    content["ligaments"] = [x for x in content["ligaments"] if not x["name"].startswith("PT")]


def _driven(content):
    content["coordinates"][4]["role"] = "driven"


def _on_the_shank(content):
    content["joints"][2]["parent"]["body"] = "shank"


def _five(content):
    content["joints"][2]["translations"][2].pop("terms")


def _coupled(content):
    for name in ("p_tz",):
        content["coordinates"][2 + SIX.index(name)]["role"] = "force_dependent"
    function = {"kind": "linear", "slope": 0.01}
    content["couplings"] = [{"dependent": "p_tz", "independent": "flexion", "function": function}]


def _shared(content):
    extra = {"coordinate": "p_ty", "function": {"kind": "linear", "slope": 0.1}}
    content["joints"][1]["translations"] = [
        {"axis": [1, 0, 0], "terms": [extra]}, {"axis": [0, 1, 0]}, {"axis": [0, 0, 1]},
    ]  # fmt: skip


def _taken(content):
    content["ligaments"][1]["name"] = "patellar_ligament"


def _moving_end(content):
    function = {"kind": "linear", "slope": 0.001}
    content["ligaments"][0]["path"]["points"][0]["moving"] = {
        "x": [{"coordinate": "flexion", "function": function}]
    }


def _far(content):
    content["coordinates"][2 + SIX.index("p_tx")]["default"] += 0.03


def _beside(content):
    content["coordinates"][2 + SIX.index("p_tz")]["default"] += 0.02


MISTAKES = {
    "no ligament": (_no_strands, r"no ligament runs from 'kneecap' to 'shank'"),
    "driven": (_driven, r"joint 'patella': coordinate 'p_tilt' is driven: must be force_dependent"),
    "elsewhere": (_on_the_shank, r"'kneecap' hangs on 'shank': must hang on 'thigh', which surface 'femur' is on"),
    "five": (_five, r"joint 'patella' has 5 coordinates \(p_flex, p_rot, .*\): must be 6"),
    "coupled": (_coupled, r"coordinate 'p_tz' follows another: must be free"),
    "shared": (_shared, r"coordinate 'p_ty' moves joint 'knee', too: must be of one joint"),
    "a name": (_taken, r"has a 'patellar_ligament' already: rename it"),
    "a moving end": (_moving_end, r"ligament 'PT1': its ends must be fixed to 'kneecap' and 'shank'"),
    "far": (_far, r"'button': the button at the model's default posture does not touch .* within 12 mm"),
    "beside": (_beside, r"'button': .* lies 8 mm or more beside the bottom of the trochlea"),
}  # fmt: skip


@pytest.mark.parametrize("what", MISTAKES)
def test_models_of_another_kind_are_refused_by_name(what, tmp_path):
    edit, said = MISTAKES[what]
    file = write_knee(tmp_path, edit=edit)
    model = MusculoskeletalModel.read(file)
    with pytest.raises(InputDataError, match=said):
        hinge_patella(model, surface_files(model, [file]), JOINT)


def test_other_mistakes_are_refused_by_value(right):
    surfaces = right.surfaces
    for stiffness in (0.0, -3.0, math.nan, math.inf):
        with pytest.raises(InputDataError, match=rf"stiffness {stiffness:g} N/m: must be above 0"):
            hinge_patella(right.before, surfaces, JOINT, stiffness=stiffness)
    with pytest.raises(InputDataError, match="no surface of a patella is named"):
        hinge_patella(right.before, surfaces, JointSurfaces("femur", "insert", None))
    without = {name: surface for name, surface in surfaces.items() if name != "button"}
    with pytest.raises(
        InputDataError, match=r"no mesh of surface 'button' \(there are: femur, insert\)"
    ):
        hinge_patella(right.before, without, JOINT)
    unplaced = surface_files(right.before, [right.file.parent])
    with pytest.raises(
        InputDataError, match=r"surface 'femur' \(.*femur\.stl\) needs body and placement"
    ):
        hinge_patella(right.before, unplaced, JOINT)
    ground = replace(surfaces["button"], body="ground")
    with pytest.raises(InputDataError, match="'ground' hangs on no joint"):
        hinge_patella(right.before, {**surfaces, "button": ground}, JOINT)
    dome = replace(surfaces["femur"], file=surfaces["button"].file)
    with pytest.raises(InputDataError, match="surface 'femur' does not look like a trochlea"):
        hinge_patella(right.before, {**surfaces, "femur": dome}, JOINT)
