# SPDX-License-Identifier: Apache-2.0
"""The published schemas, and that they and the reader say the same."""

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from condyle._core import io

ROOT = Path(__file__).parents[3]
SCHEMAS = ROOT / "docs" / "schema"
EXAMPLE = ROOT / "docs" / "examples" / "pendulum.json"
Edit = Callable[[Any], None]


def schema(name: str) -> Draft202012Validator:
    content = json.loads((SCHEMAS / f"{name}.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(content)
    return Draft202012Validator(content)


MODEL, SNAPSHOTS = schema("model"), schema("path_snapshots")


def example() -> Any:
    return json.loads(EXAMPLE.read_text(encoding="utf-8"))


def everything() -> Any:
    """The example with one of every kind of item that a model file may have."""
    model = example()
    frame = {"body": "upper", "translation": [0.1, 0.2, 0.3], "orientation_xyz": [0.4, 0.5, 0.6]}
    spline = {"kind": "simm_spline", "x": [-1.0, 0.5, 2], "y": [0.01, 0.02, -0.01]}
    polynomial = {"kind": "polynomial", "coefficients": [0.1, 0.2]}
    model["bodies"][0]["meshes"] = ["upper.stl"]
    model["joints"][0]["translations"] = [
        {"axis": [1, 0, 0], "constant": 0.01},
        {"axis": [0, 1, 0], "terms": [{"coordinate": "elbow_flexion", "function": spline}]},
        {"axis": [0, 0, 1], "terms": [{"coordinate": "elbow_flexion", "function": polynomial}]},
    ]
    model["couplings"] = [
        {"dependent": "shoulder_flexion", "independent": "elbow_flexion", "function": spline}
    ]
    model["coordinates"][0] |= {"locked": True, "role": "force_dependent"}
    model["wraps"] += [
        {"name": "egg", "kind": "ellipsoid", "frame": frame, "semi_axes": [0.1, 0.2, 0.3]},
        {"name": "ball", "kind": "sphere", "frame": frame, "radius": 0.1, "active": False},
        {
            "name": "ring",
            "kind": "torus",
            "frame": frame,
            "inner_radius": 0.1,
            "outer_radius": 0.2,
        },
    ]
    path = copy.deepcopy(model["muscles"][0]["path"])
    path["points"][0]["moving"] = {"y": [{"coordinate": "elbow_flexion", "function": polynomial}]}
    path["points"][1]["condition"] = {"coordinate": "elbow_flexion", "min": 0, "max": 1}
    path["wraps"] = [{"wrap": "egg", "method": "axial", "first_point": 0, "last_point": 1}]
    model["ligaments"] = [
        {"name": "band", "law": "linear", "stiffness": 1e5, "slack_length": 0.1, "path": path}
    ]
    model["markers"] = [{"name": "heel", "body": "lower", "location": [0, 0.1, 0.2]}]
    model["contact_surfaces"] = [{"name": n, "frame": frame, "mesh": f"{n}.stl"} for n in "ab"]
    model["contact_pairs"] = [{"name": "ab", "first": "a", "second": "b", "thickness": 0.01}]
    model["not_supported"] = ["a bushing"]
    return model


def accepted_by_reader(model: Any) -> bool:
    try:
        io.parse_model(json.dumps(model), "model.json")
    except ValueError:
        return False
    return True


def put(*path: Any) -> Edit:
    """Sets a value: the last of `path`, at the keys and indices before it."""
    *way, key, value = path

    def edit(model: Any) -> None:
        for step in way:
            model = model[step]
        model[key] = value

    return edit


def drop(*path: Any) -> Edit:
    *way, key = path

    def edit(model: Any) -> None:
        for step in way:
            model = model[step]
        del model[key]

    return edit


_TERM = ("joints", 0, "rotations", 0, "terms", 0)
_POINT = ("ligaments", 0, "path", "points", 0)
BROKEN: dict[str, Edit] = {
    "another format": put("format", "condyle-study"),
    "another version": put("version", 2),
    "no name": drop("name"),
    "no bodies": drop("bodies"),
    "no coordinates": drop("coordinates"),
    "an unknown key": put("bodys", []),
    "an unknown key of a body": put("bodies", 0, "mass_center", [0, 0, 0]),
    "a mass in words": put("bodies", 0, "mass", "heavy"),
    "no mass": drop("bodies", 0, "mass"),
    "a body without a name": put("bodies", 0, "name", ""),
    "five inertias": put("bodies", 0, "inertia", [1, 1, 1, 0, 0]),
    "a vector of two": put("gravity", [0, -9.8]),
    "a vector of words": put("gravity", [0, "down", 0]),
    "bodies as an object": put("bodies", {}),
    "two rotations": drop("joints", 0, "rotations", 2),
    "a joint without a child": drop("joints", 0, "child"),
    "an axis without a direction": drop("joints", 0, "rotations", 0, "axis"),
    "an unknown function": put(*_TERM, "function", "kind", "spline"),
    "a slope of null": put(*_TERM, "function", "slope", None),
    "a linear function with knots": put(*_TERM, "function", "x", [0, 1]),
    "a spline of one knot": put("couplings", 0, "function", "x", [0]),
    "a polynomial without coefficients": put(
        *_TERM, "function", {"kind": "polynomial", "coefficients": []}
    ),
    "a motion that is none": put("coordinates", 0, "motion", "coupled"),
    "a range of three": put("coordinates", 0, "range", [0, 1, 2]),
    "locked by a number": put("coordinates", 0, "locked", 1),
    "a role that is none": put("coordinates", 0, "role", "free"),
    "a cylinder without a length": drop("wraps", 0, "length"),
    "a sphere with semi-axes": put("wraps", 2, "semi_axes", [1, 1, 1]),
    "a quadrant that is none": put("wraps", 0, "quadrant", "w"),
    "a wrap that is none": put("wraps", 0, "kind", "cone"),
    "a point without a body": drop(*_POINT, "body"),
    "a point that moves along w": put(*_POINT, "moving", {"w": []}),
    "a condition without an end": put(*_POINT, "condition", {"coordinate": "elbow", "min": 0}),
    "half a point": put("ligaments", 0, "path", "wraps", 0, "first_point", 0.5),
    "a point before the first": put("ligaments", 0, "path", "wraps", 0, "last_point", -2),
    "a method that is none": put("ligaments", 0, "path", "wraps", 0, "method", "exact"),
    "a law that is none": put("ligaments", 0, "law", "hill"),
    "a muscle without a path": drop("muscles", 0, "path"),
    "a marker without a place": drop("markers", 0, "location"),
    "a surface without a mesh": drop("contact_surfaces", 0, "mesh"),
    "a pair of one": drop("contact_pairs", 0, "second"),
    "a number among texts": put("not_supported", [1]),
}


def test_the_example_and_one_of_everything_are_models_to_both() -> None:
    for model in (example(), everything()):
        assert list(MODEL.iter_errors(model)) == []
        assert accepted_by_reader(model)


@pytest.mark.parametrize("fault", BROKEN)
def test_schema_and_reader_refuse_the_same_files(fault: str) -> None:
    model = everything()
    BROKEN[fault](model)
    assert not MODEL.is_valid(model)
    assert not accepted_by_reader(model)


def test_what_condyle_writes_fits_the_schema_and_reads_back() -> None:
    text = io.model_text(io.parse_model(json.dumps(everything()), "model.json"))
    assert list(MODEL.iter_errors(json.loads(text))) == []
    assert io.model_text(io.parse_model(text, "again")) == text


def test_every_key_of_the_schema_is_described() -> None:
    def undescribed(node: Any, way: str) -> list[str]:
        found = []
        for key, value in node.get("properties", {}).items():
            at = f"{way}.{key}"
            if not {"description", "const", "$ref"} & value.keys():
                found.append(at)
            found += undescribed(value, at)
        for name, value in node.get("$defs", {}).items():
            found += [] if "description" in value else [name]
            found += undescribed(value, name)
            for choice in value.get("oneOf", []):
                found += undescribed(choice, name)
        return found

    for validator in (MODEL, SNAPSHOTS):
        assert undescribed(validator.schema, "") == []


def test_a_model_file_is_read_with_its_origin() -> None:
    model = io.read_model_file(EXAMPLE)
    assert model.name == "double pendulum"
    assert model.source == str(EXAMPLE)
    assert model.provenance.startswith("written by hand")
    assert model.not_supported == []


def snapshots() -> Any:
    points = [[1, 0.03, 1.41, 0.005], [0, 0.02, -0.05, 0.004]]
    entries = [{"points": points, "arc_excess": 1e-4}, {"points": points}]
    return {
        "format": "condyle-path-snapshots",
        "version": 1,
        "source": "a test",
        "bodies": ["lower", "ground"],
        "times": [0.5, 0.75],
        "paths": {"flexor": entries},
    }


SNAPSHOTS_BROKEN: dict[str, Edit] = {
    "another format": put("format", "condyle-model"),
    "no times": put("times", []),
    "a time in words": put("times", ["now", 1]),
    "a point of three numbers": put("paths", "flexor", 0, "points", 0, [0, 1, 2]),
    "a path of one point": put("paths", "flexor", 1, "points", [[0, 1, 2, 3]]),
    "half a body": put("paths", "flexor", 0, "points", 0, [0.5, 1, 2, 3]),
    "a body before the first": put("paths", "flexor", 0, "points", 0, [-1, 1, 2, 3]),
    "an unknown key": put("paths", "flexor", 0, "length", 0.3),
    "no bodies": drop("bodies"),
}


def accepted_snapshots(content: Any) -> bool:
    try:
        io.parse_path_snapshots(json.dumps(content), "s.json", io.read_model_file(EXAMPLE))
    except ValueError:
        return False
    return True


def test_snapshots_fit_their_schema_and_read_back() -> None:
    assert list(SNAPSHOTS.iter_errors(snapshots())) == []
    assert accepted_snapshots(snapshots())
    model = io.read_model_file(EXAMPLE)
    read = io.parse_path_snapshots(json.dumps(snapshots()), "s.json", model)
    assert (read.times, read.paths) == ([0.5, 0.75], ["flexor"])
    text = io.path_snapshots_text(read, model, "written again")
    assert list(SNAPSHOTS.iter_errors(json.loads(text))) == []
    again = io.parse_path_snapshots(text, "again", model)
    assert io.path_snapshots_text(again, model, "written again") == text


@pytest.mark.parametrize("fault", SNAPSHOTS_BROKEN)
def test_schema_and_reader_refuse_the_same_snapshots(fault: str) -> None:
    content = snapshots()
    SNAPSHOTS_BROKEN[fault](content)
    assert not SNAPSHOTS.is_valid(content)
    assert not accepted_snapshots(content)
