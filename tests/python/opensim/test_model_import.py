# SPDX-License-Identifier: Apache-2.0
import json

import numpy as np
import pytest
from forward_kinematics import function_value, path_points, placements, point_in_ground

from condyle.errors import InputDataError
from condyle.opensim import import_model, summary, write_model
from condyle.opensim.library import load_model

# Both sides evaluate the same formulas in double precision over chains of at most 10 joints, positions
# of a few metres: 1e-10 is far above the rounding (seen: 1e-15) and far below any real difference.
SAME = 1e-10


def random_postures(loaded, model, rng, n, lowest=-0.7):
    """Sets OpenSim's state to random coordinates, n times; yields them by name, coupled ones set."""
    coordinates = list(loaded.model.getCoordinateSet())
    dependent = {coupling["dependent"] for coupling in model["couplings"]}
    for coordinate in coordinates:
        coordinate.setLocked(loaded.state, False)
    for _ in range(n):
        q = {c.getName(): float(rng.uniform(lowest, 1.3)) for c in coordinates}
        for coordinate in coordinates:
            if coordinate.getName() not in dependent:
                coordinate.setValue(loaded.state, q[coordinate.getName()], False)
        follow(loaded, model, q)
        loaded.model.realizePosition(loaded.state)
        yield q


def follow(loaded, model, q):
    """Coupled coordinates as OpenSim's own function has them."""
    for constraint in loaded.model.getConstraintSet():
        name = constraint.getConcreteClassName()
        if name != "CoordinateCouplerConstraint":
            continue
        import opensim

        coupler = opensim.CoordinateCouplerConstraint.safeDownCast(constraint)
        at = q[coupler.getIndependentCoordinateNames().get(0)]
        dependent = coupler.getDependentCoordinateName()
        scale = float(coupler.getPropertyByName("scale_factor").toString())
        q[dependent] = scale * coupler.getFunction().calcValue(opensim.Vector(1, at))
        coordinate = loaded.model.getCoordinateSet().get(dependent)
        coordinate.setValue(loaded.state, q[dependent], False)


def placement_of(body, state):
    X = np.eye(4)
    transform = body.getTransformInGround(state)
    X[:3, :3] = [[transform.R().get(i, j) for j in range(3)] for i in range(3)]
    X[:3, 3] = [transform.p().get(i) for i in range(3)]
    return X


@pytest.mark.parametrize("name", ["chain_of_plain_joints", "leg"])
def test_bodies_stand_where_opensim_puts_them(models, rng, name):
    model, loaded = import_model(models[name]), load_model(models[name])
    for q in random_postures(loaded, model, rng, 10):
        placed = placements(model, q)
        for body in loaded.model.getBodySet():
            expected = placement_of(body, loaded.state)
            np.testing.assert_allclose(placed[body.getName()], expected, rtol=0, atol=SAME)


def test_a_coupled_coordinate_follows_as_in_opensim(models):
    model, loaded = import_model(models["leg"]), load_model(models["leg"])
    coordinates = {c.getName(): c for c in loaded.model.getCoordinateSet()}
    q = {c["name"]: c["default"] for c in model["coordinates"]} | {"pf_flex": 99.0}
    for at in (-0.3, 0.2, 0.9, 1.35):
        # True: OpenSim assembles, so its own constraint sets pf_flex (to its accuracy of 1e-9).
        coordinates["knee_flex"].setValue(loaded.state, at, True)
        at = q["knee_flex"] = coordinates["knee_flex"].getValue(loaded.state)
        (coupling,) = model["couplings"]
        found = function_value(coupling["function"], at)
        assert found == pytest.approx(coordinates["pf_flex"].getValue(loaded.state), abs=1e-7)
        loaded.model.realizePosition(loaded.state)
        expected = placement_of(loaded.model.getBodySet().get("patella"), loaded.state)
        np.testing.assert_allclose(placements(model, q)["patella"], expected, rtol=0, atol=1e-7)


def test_paths_run_over_the_points_of_opensim(models, rng):
    model, loaded = import_model(models["leg"]), load_model(models["leg"])
    library = pytest.importorskip("opensim")
    forces = {f["name"]: f for f in [*model["muscles"], *model["ligaments"]]}
    present = set()
    # Within the coordinates' range: beyond it OpenSim holds moving points (a finding says so).
    for q in random_postures(loaded, model, rng, 20, lowest=-0.35):
        placed = placements(model, q)
        for name in ("plain", "bent", "strand"):
            force = loaded.model.getForceSet().get(name)
            kind = getattr(library, force.getConcreteClassName())
            expected = kind.safeDownCast(force).getGeometryPath().getLength(loaded.state)
            points = path_points(forces[name]["path"], placed, q)
            length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
            assert length == pytest.approx(expected, abs=SAME), (name, q)
            if name == "bent":
                present.add(len(points))
    assert present == {3, 4}, "the conditional point was there, or was not, in all postures"


def test_markers_stand_where_opensim_puts_them(models, rng):
    model, loaded = import_model(models["leg"]), load_model(models["leg"])
    assert len(model["markers"]) == 12
    for q in random_postures(loaded, model, rng, 3):
        placed = placements(model, q)
        for marker in model["markers"]:
            station = loaded.model.getMarkerSet().get(marker["name"])
            p = station.getLocationInGround(loaded.state)
            found = point_in_ground(placed, marker["body"], marker["location"])
            np.testing.assert_allclose(found, [p.get(i) for i in range(3)], rtol=0, atol=SAME)


def test_parameters_keep_their_values(models):
    model = import_model(models["leg"])
    muscle = next(m for m in model["muscles"] if m["name"] == "bent")
    assert {k: v for k, v in muscle.items() if k != "path"} == {
        "name": "bent",
        "max_isometric_force": 812.0,
        "optimal_fibre_length": 0.091,
        "tendon_slack_length": 0.137,
        "pennation_at_optimal": 0.21,
        "max_contraction_velocity": 11.5,
    }
    strand = next(each for each in model["ligaments"] if each["name"] == "strand")
    assert (strand["law"], strand["stiffness"], strand["slack_length"]) == (
        "blankevoort",
        2345.0,
        0.043,
    )
    assert (strand["transition_strain"], strand["damping"]) == (0.06, 0.003)  # OpenSim's defaults
    tendon = next(each for each in model["ligaments"] if each["name"] == "tendon")
    assert (tendon["law"], tendon["stiffness"], tendon["slack_length"]) == (
        "linear",
        1.187e6,
        0.051,
    )
    assert model["springs"] == [
        {"coordinate": "knee_shift", "stiffness": 321.0, "rest": 0.012, "viscosity": 0.45}
    ]
    knee = next(c for c in model["coordinates"] if c["name"] == "knee_flex")
    assert (knee["default"], knee["range"], knee["locked"]) == (0.35, [-0.35, 1.4], False)
    assert model["gravity"] == [0.3, -9.7, 0.2]
    assert model["bodies"][1]["inertia"] == [0.11, 0.12, 0.13, 0.011, 0.012, 0.013]


def test_wraps_keep_their_shape_and_get_unique_names(models):
    wraps = {wrap["name"]: wrap for wrap in import_model(models["leg"])["wraps"]}
    assert sorted(wraps) == ["condyles", "head", "plateau", "ring", "shank/head"]
    condyles = wraps["condyles"]
    assert (condyles["kind"], condyles["radius"], condyles["length"]) == ("cylinder", 0.021, 0.2)
    assert (condyles["quadrant"], condyles["active"]) == ("x", True)
    assert condyles["frame"]["body"] == "thigh"
    np.testing.assert_allclose(condyles["frame"]["orientation_xyz"], [0.2, -0.3, 0.1], atol=1e-14)
    assert (wraps["head"]["kind"], wraps["head"]["radius"]) == ("sphere", 0.065)
    assert wraps["shank/head"]["frame"]["body"] == "shank"
    assert wraps["plateau"]["semi_axes"] == [0.09, 0.1, 0.08]
    assert (wraps["ring"]["inner_radius"], wraps["ring"]["outer_radius"]) == (0.012, 0.05)
    muscles = {
        m["name"]: m["path"]["wraps"]
        for m in import_model(models["leg"])["muscles"]
        if "wraps" in m["path"]
    }
    assert [w["wrap"] for w in muscles["around"]] == ["plateau"]
    assert [w["wrap"] for w in muscles["over_ball"]] == ["head"]
    assert muscles["over_post"] == [
        {"wrap": "condyles", "method": "hybrid", "first_point": -1, "last_point": -1}
    ]


def test_what_does_not_fit_is_named(models):
    listed = "\n".join(import_model(models["leg"])["not_supported"])
    for words in (
        "forces of class CoordinateLimitForce: knee_stop",
        "forces of class CoordinateActuator: hip_motor",
        "constraints that are not enforced: held",
        "Thelen2003Muscle: activation dynamics",
        "a model file lets them go on): bent gliding",
    ):
        assert words in listed
    odd = "\n".join(import_model(models["oddities"])["not_supported"])
    for words in (
        "joints of class EllipsoidJoint (welded in their default pose, coordinates left out): egg",
        "stepping translation 1 (StepFunction)",
        "joints that close a loop of bodies: closing",
        "coordinates prescribed over time (free here; a trial gives them): swing",
        "scale factors of contact meshes: upper",
        "contact pairs of two different layers (taken as one, averaged): touch",
        "nonlinear pressure law of contact pairs: touch",
        "components of class FutureSpring, which this OpenSim does not know: from_tomorrow",
    ):
        assert words in odd


def test_contact_of_the_jam_kind_is_read_from_the_file(models):
    model = import_model(models["oddities"])
    assert [(s["name"], s["mesh"], s["frame"]["body"]) for s in model["contact_surfaces"]] == [
        ("upper", "upper.stl", "first"),
        ("lower", "lower.stl", "second"),
    ]
    (pair,) = model["contact_pairs"]
    # Moduli 3 and 5 MPa, ratios 0.5 (default) and 0.4, layers of 4 and 5 (default) mm.
    assert (pair["first"], pair["second"]) == ("upper", "lower")
    assert pair["youngs_modulus"] == pytest.approx(4e6)
    assert pair["poissons_ratio"] == pytest.approx(0.45)
    assert pair["thickness"] == pytest.approx(0.009)


def test_a_joint_without_a_counterpart_is_welded_in_its_default_pose(models):
    model, loaded = import_model(models["oddities"]), load_model(models["oddities"])
    q = {c["name"]: c["default"] for c in model["coordinates"]}
    for name in ("first", "second"):
        loaded.model.realizePosition(loaded.state)
        expected = placement_of(loaded.model.getBodySet().get(name), loaded.state)
        np.testing.assert_allclose(placements(model, q)[name], expected, rtol=0, atol=SAME)


def test_roles_follow_patterns_and_muscles_default_to_what_they_cross(models):
    def roles(**options):
        model = import_model(models["leg"], **options)
        return {c["name"]: (c["role"], c["balanced_by"]) for c in model["coordinates"]}

    # knee_rot is locked, pf_flex follows knee_flex, knee_shift is a shift.
    default = roles()
    assert {name for name, role in default.items() if role[1] == "muscles"} == {
        "hip_flex",
        "knee_flex",
    }
    assert {role[0] for role in default.values()} == {"driven"}
    chosen = roles(force_dependent=["knee_rot", "knee_sh*"], muscles=["*_flex"])
    assert chosen["knee_shift"] == chosen["knee_rot"] == ("force_dependent", "reaction")
    assert chosen["pf_flex"] == chosen["hip_flex"] == ("driven", "muscles")
    assert {role[1] for role in roles(muscles=[]).values()} == {"reaction"}
    with pytest.raises(
        InputDataError, match=r"'knie_\*' fits none of the model's coordinates: hip_flex"
    ):
        roles(force_dependent=["knie_*"])
    with pytest.raises(InputDataError, match="knee_flex: force-dependent and balanced by muscles"):
        roles(force_dependent=["knee_flex"], muscles=["knee_flex"])


def test_what_is_written_is_what_was_imported(models, tmp_path):
    model = import_model(models["leg"])
    write_model(tmp_path / "leg.json", model)
    assert json.loads((tmp_path / "leg.json").read_text(encoding="utf-8")) == model
    assert summary(model).startswith("4 bodies, 4 joints, 5 coordinates, 1 couplings, 1 springs")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hello", "not an OpenSim model: it is no XML"),
        ("<osim/>", "<osim> without <Model>"),
        ('<OpenSimDocument Version="40000"><Model name="m"><JointSet><objects><PinJoint name="p">'
         "<socket_parent_frame>/bodyset/nobody</socket_parent_frame></PinJoint></objects></JointSet>"
         "</Model></OpenSimDocument>", "OpenSim refuses it"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_model_is_refused_by_name(osim, tmp_path, text, words):
    file = tmp_path / "broken.osim"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputDataError, match=words) as caught:
        import_model(file)
    assert str(file) in str(caught.value)


def test_dm_as_published_is_imported_whole(osim, dm):
    model = import_model(dm / "model" / "DM.osim", force_dependent=["knee_t?_r", "pf_*_r"])
    counts = {name: len(model[name]) for name in model if isinstance(model[name], list)}
    assert counts | {"gravity": 3, "not_supported": 0} == {
        "gravity": 3, "bodies": 23, "joints": 23, "coordinates": 52, "couplings": 0, "springs": 11,
        "wraps": 40, "muscles": 44, "ligaments": 149, "markers": 64, "contact_surfaces": 3,
        "contact_pairs": 2, "not_supported": 0,
    }  # fmt: skip
    (knee, _) = model["contact_pairs"]
    assert (knee["first"], knee["second"]) == ("femur_implant", "tibia_implant")
    # The data's README: E 46.3 MPa, nu 0.46, a 5 mm layer on each side.
    assert knee["youngs_modulus"] == pytest.approx(46.3e6)
    assert knee["poissons_ratio"] == pytest.approx(0.46)
    assert knee["thickness"] == pytest.approx(0.01)
    solved = [c["name"] for c in model["coordinates"] if c["role"] == "force_dependent"]
    assert len(solved) == 9
    assert not [
        line
        for line in model["not_supported"]
        if "muscle's own curves" not in line and "pictures" not in line
    ]


def test_dm_stands_as_opensim_puts_it(osim, dm, rng):
    file = dm / "model" / "DM.osim"
    model, loaded = import_model(file), load_model(file)
    for q in random_postures(loaded, model, rng, 3):
        placed = placements(model, q)
        for body in loaded.model.getBodySet():
            expected = placement_of(body, loaded.state)
            np.testing.assert_allclose(placed[body.getName()], expected, rtol=0, atol=SAME)
