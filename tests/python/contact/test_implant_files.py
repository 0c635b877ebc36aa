# SPDX-License-Identifier: Apache-2.0
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_implant import box, femur, inserts

from condyle.contact import (
    Mesh,
    MeshContact,
    inspect_mesh,
    read_implant,
    read_mesh,
    write_mesh,
)


@pytest.fixture
def files(tmp_path: Path) -> dict[str, Any]:
    medial, lateral = inserts()
    both = Mesh(
        np.concatenate([medial.vertices, lateral.vertices]),
        np.concatenate([medial.faces, lateral.faces + np.int32(len(medial.vertices))]),
    )
    for name, mesh in {
        "femur": femur(),
        "medial": medial,
        "lateral": lateral,
        "insert": both,
    }.items():
        write_mesh(tmp_path / f"{name}.ply", mesh)
    return {
        "femur": tmp_path / "femur.ply",
        "insert": tmp_path / "insert.ply",
        "units": "m",
        "side_of_body": "right",
    }


def test_one_insert_and_its_two_halves_are_the_same_contact(files: dict[str, Any]) -> None:
    whole = MeshContact.from_files(**files)
    folder = files["insert"].parent
    halves = {"insert_medial": folder / "medial.ply", "insert_lateral": folder / "lateral.ply"}
    parts = MeshContact.from_files(**{**files, "insert": None, **halves})
    assert whole.mesh_hashes() == parts.mesh_hashes()
    implant = read_implant(**files)
    assert list(implant) == ["femur", "insert_medial", "insert_lateral"]
    assert implant["insert_medial"].vertices[:, 2].max() < 0.0


def reversed_femur(folder: Path) -> dict[str, Any]:
    made = femur()
    write_mesh(folder / "r.off", Mesh(made.vertices, np.ascontiguousarray(made.faces[:, ::-1])))
    return {"femur": folder / "r.off"}


def big_femur(folder: Path) -> dict[str, Any]:
    made = femur()
    write_mesh(folder / "big.stl", Mesh(830.0 * made.vertices, made.faces))
    return {"femur": folder / "big.stl"}


def text_femur(folder: Path) -> dict[str, Any]:
    (folder / "t.stl").write_text("a femur\n", encoding="utf-8")
    return {"femur": folder / "t.stl"}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda _: {"femur": None}, "femur is missing: name the file of the femoral component"),
        (lambda _: {"insert": None}, "insert_medial is missing: name insert, or both"),
        (lambda f: {"insert_medial": f / "medial.ply"}, "goes without insert_medial"),
        (lambda f: {"femur": f / "absent.stl"}, "absent.stl: no such file"),
        (lambda _: {"units": "cm"}, "units is 'cm': must be 'm' or 'mm'"),
        (big_femur, "big.stl: 66.4 m across when read as m: .* use --units mm"),
        (text_femur, "t.stl: not an STL"),
        (reversed_femur, "r.off: femur: normals point inwards"),
        (lambda f: {"femur": f / "insert.ply"}, "insert.ply: femur: normals point inwards"),
    ],
)
def test_each_mistake_is_one_line_that_names_the_file(
    files: dict[str, Any], change: Any, text: str
) -> None:
    with pytest.raises(ValueError, match=text) as caught:
        read_implant(**{**files, **change(files["femur"].parent)})
    assert "\n" not in str(caught.value)


def test_reading_repairs_and_inspecting_tells(tmp_path: Path) -> None:
    made = box((0.01, 0.02, 0.03), (0.0, 0.0, 0.0))
    faces = np.array(made.faces)
    faces[3] = faces[3, ::-1]  # one face turned
    loose = Mesh(made.vertices[faces].reshape(-1, 3), np.arange(36, dtype=np.int32).reshape(-1, 3))
    write_mesh(tmp_path / "box.off", loose)
    before, after = inspect_mesh(tmp_path / "box.off", "m")
    assert list(before) == list(after)
    assert (before["vertices"], after["vertices"]) == (36, 8)
    assert (before["closed"], after["closed"]) == (False, True)
    assert before["duplicate_vertices"] == 28
    assert after["inconsistent_edges"] == 0
    assert after["volume_cm3"] == pytest.approx(48.0, rel=1e-12)
    assert after["highest_mm"] == pytest.approx([10.0, 20.0, 30.0], rel=1e-12)
    assert len(read_mesh(tmp_path / "box.off", "m").vertices) == 8
    assert len(read_mesh(tmp_path / "box.off", "m", repair=False).vertices) == 36


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"unknown extension '\.step'"):
        write_mesh(tmp_path / "a.step", femur())
    with pytest.raises(RuntimeError, match="cannot be written"):
        write_mesh(tmp_path / "absent" / "a.stl", femur())
