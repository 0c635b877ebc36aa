# SPDX-License-Identifier: Apache-2.0
"""Files hold what was generated, and only a whole parameters.json is read back."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.implants import Implant, generate, preset, read_parameters, write_implant, write_stl


def test_stl_holds_the_mesh_in_single_precision(tmp_path: Path, flat: Implant) -> None:
    trimesh = pytest.importorskip("trimesh")
    path = tmp_path / "femur.stl"
    write_stl(path, flat.femur)
    assert not path.read_bytes().startswith(b"solid")
    assert path.stat().st_size == 84 + 50 * len(flat.femur.faces)
    loaded = trimesh.load(path, process=False)
    expected = flat.femur.vertices[flat.femur.faces]
    # Coordinates up to 0.04 m in float32: half a unit in the last place is 2e-9 m.
    np.testing.assert_allclose(loaded.triangles, expected, atol=2e-9)
    # A face of 0.15 mm height rounded to 2e-9 m turns by 3e-5 rad.
    np.testing.assert_allclose(loaded.face_normals, flat.femur.face_normals(), atol=1e-4)


def test_an_implant_is_written_whole_and_its_parameters_come_back(tmp_path: Path) -> None:
    implant = generate(preset("curved", size=0.91, side_of_body="left"))
    write_implant(tmp_path / "run" / "implant", implant)
    names = {
        "femur.stl",
        "insert.stl",
        "insert_medial.stl",
        "insert_lateral.stl",
        "parameters.json",
    }
    assert {path.name for path in (tmp_path / "run" / "implant").iterdir()} == names
    read = read_parameters(tmp_path / "run" / "implant" / "parameters.json")
    assert read == implant.parameters
    before = {name: (tmp_path / "run" / "implant" / name).read_bytes() for name in names}
    write_implant(tmp_path / "again", generate(read))
    assert before == {name: (tmp_path / "again" / name).read_bytes() for name in names}


@pytest.fixture
def stored(tmp_path: Path) -> tuple[Path, dict]:
    path = tmp_path / "parameters.json"
    content = {
        "units": {"length": "m", "angle": "rad"},
        "parameters": dataclasses.asdict(preset("flat")),
    }
    return path, content


def expect_refusal(path: Path, text: str, message: str) -> None:
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputDataError) as caught:
        read_parameters(path)
    assert str(path) in str(caught.value)
    assert message in str(caught.value)


def test_unusable_parameter_files_are_refused(stored: tuple[Path, dict]) -> None:
    path, content = stored
    expect_refusal(path, "femoral_ap = 3", "not a readable JSON file")
    expect_refusal(path, "[1, 2]", "units = [1, 2]: must be")
    expect_refusal(path, json.dumps({**content, "units": {"length": "mm"}}), "{'length': 'mm'}")
    parameters = {**content["parameters"], "colour": 3}
    del parameters["notch_width"]
    expect_refusal(
        path,
        json.dumps({**content, "parameters": parameters}),
        "missing ['notch_width'], unknown ['colour']",
    )
    wrong = {**content["parameters"], "femoral_ml": 72.0}
    expect_refusal(
        path,
        json.dumps({**content, "parameters": wrong}),
        "femoral_ml = 72 m: must lie in [0.045, 0.1] m",
    )


def test_a_missing_parameter_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputDataError, match=r"absent\.json: not a readable JSON file"):
        read_parameters(tmp_path / "absent.json")
