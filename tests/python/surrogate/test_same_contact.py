# SPDX-License-Identifier: Apache-2.0
"""A surrogate of other meshes, or of another law, than the contact beside it is told apart, by field."""

import json
import shutil
from dataclasses import replace

import numpy as np
import onnx
import pytest

from condyle.contact import LinearVolumeLaw, Mesh, MeshContact, PowerLaw, read_implant, write_mesh
from condyle.errors import InputDataError
from condyle.implants import generate, preset, write_implant
from condyle.surrogate import load_surrogate
from condyle.surrogate.same_contact import require_same_law, require_same_meshes
from condyle.whole_files import content_hash

PARTS = ("femur", "insert_medial", "insert_lateral")


def make_implant(folder, size=1.0):
    parameters = preset("curved", size=size, side_of_body="left")
    parameters = replace(parameters, mesh_edge_length=3e-3)
    write_implant(folder, generate(parameters))
    return folder


@pytest.fixture(scope="module")
def implant(tmp_path_factory):
    return make_implant(tmp_path_factory.mktemp("implant"))


@pytest.fixture(scope="module")
def contact(implant):
    files = {"femur": implant / "femur.stl", "insert": implant / "insert.stl"}
    return MeshContact.from_files(**files, units="m", side_of_body="left")


@pytest.fixture
def surrogate_of(tiny_file, tmp_path):
    """Makes the closed-form surrogate say what it is of."""

    def make(**metadata):
        model = onnx.load(tiny_file)
        for entry in model.metadata_props:
            name = entry.key.removeprefix("condyle.")
            if name in metadata:
                entry.value = json.dumps(metadata[name])
        onnx.save(model, tmp_path / "surrogate.onnx")
        return load_surrogate(tmp_path / "surrogate.onnx")

    return make


def hashes(folder, names=PARTS):
    return {f"{name}.stl": content_hash((folder / f"{name}.stl").read_bytes()) for name in names}


def test_the_study_s_own_files_are_recognised(implant, contact, surrogate_of):
    files = {"femur": implant / "femur.stl", "insert": implant / "insert.stl"}
    assert require_same_meshes(surrogate_of(implant=hashes(implant)), contact, files)


def test_a_mesh_that_a_study_read_and_wrote_is_recognised(implant, surrogate_of, tmp_path):
    """Two inserts in files of their own; the study's copies have other bytes."""
    read = read_implant(
        femur=implant / "femur.stl", insert=implant / "insert.stl", units="m", side_of_body="left"
    )
    for name, mesh in read.items():
        write_mesh(tmp_path / f"{name}.stl", mesh)
    mine = {name: tmp_path / f"{name}.obj" for name in ("femur", "insert")}
    write_mesh(mine["femur"], read["femur"])
    medial, lateral = read["insert_medial"], read["insert_lateral"]
    faces = np.concatenate([medial.faces, lateral.faces + len(medial.vertices)])
    whole = Mesh(np.concatenate([medial.vertices, lateral.vertices]), faces)
    write_mesh(mine["insert"], whole)
    contact = MeshContact.from_files(**mine, units="m", side_of_body="left")
    assert require_same_meshes(surrogate_of(implant=hashes(tmp_path)), contact, mine)


def test_another_mesh_is_refused_by_field(implant, contact, surrogate_of, tmp_path):
    files = {"femur": implant / "femur.stl", "insert": implant / "insert.stl"}
    other = make_implant(tmp_path / "other", size=1.07)
    known = hashes(implant) | hashes(other, ["insert_lateral"])
    surrogate = surrogate_of(implant=known)
    with pytest.raises(InputDataError) as refused:
        require_same_meshes(surrogate, contact, files)
    assert str(refused.value).startswith(
        f"{surrogate.file}: metadata condyle.implant: insert_lateral.stl is {known['insert_lateral.stl'][:12]}…; the "
        f"insert_lateral of {files['insert']} is "
    )
    assert "it was made of another mesh; name that" in str(refused.value)


def test_a_file_of_the_right_name_beside_another_insert_proves_nothing(
    implant, surrogate_of, tmp_path
):
    """The part beside the insert has the hash, but not the insert's triangles."""
    other = make_implant(tmp_path / "other", size=1.07)
    for name in PARTS:
        shutil.copy(implant / f"{name}.stl", other)
    files = {"femur": implant / "femur.stl", "insert": other / "insert.stl"}
    contact = MeshContact.from_files(**files, units="m", side_of_body="left")
    with pytest.raises(InputDataError, match=r"insert_medial\.stl is"):
        require_same_meshes(surrogate_of(implant=hashes(implant)), contact, files)


def test_a_surrogate_that_does_not_say_is_not_compared(implant, contact, surrogate_of):
    files = {"femur": implant / "femur.stl", "insert": implant / "insert.stl"}
    assert not require_same_meshes(surrogate_of(implant={"name": "by hand"}), contact, files)
    require_same_law(surrogate_of(contact_law={}), LinearVolumeLaw(modulus=1.3e9))


def test_another_law_is_refused_by_field(surrogate_of):
    known = {**LinearVolumeLaw().describe(), "evaluation": "fast", "integration": "insert"}
    surrogate = surrogate_of(contact_law=known)
    require_same_law(surrogate, LinearVolumeLaw())
    with pytest.raises(InputDataError) as refused:
        require_same_law(surrogate, LinearVolumeLaw(modulus=7.7e9))
    assert str(refused.value) == (
        f"{surrogate.file}: metadata condyle.contact_law: modulus_N_per_m3 is 9300000000.0; the reference contact's "
        "is 7700000000.0: give both the same law"
    )
    with pytest.raises(InputDataError, match="contact_law: name is linear_volume; the reference"):
        require_same_law(surrogate, PowerLaw(coefficient=2.3e13, exponent=2.35))
