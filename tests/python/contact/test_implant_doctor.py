# SPDX-License-Identifier: Apache-2.0
"""The mesh doctor on meshes broken on purpose: what it finds, and what it says to do."""

import numpy as np
import pytest
from small_implant import box, femur, inserts, patch

from condyle.contact import Mesh, examine_implant, examine_mesh, write_mesh


def written(folder, name, mesh):
    write_mesh(folder / name, mesh)
    return folder / name


def texts(findings, severity):
    return [f.text for f in findings if f.severity == severity]


def without(mesh: Mesh, faces: list[int]) -> Mesh:
    kept = np.delete(np.array(mesh.faces), faces, axis=0)
    return Mesh(np.array(mesh.vertices), np.ascontiguousarray(kept))


@pytest.fixture
def pair(tmp_path):
    medial, lateral = inserts()
    return {
        "femur": written(tmp_path, "femur.off", femur()),
        "insert_medial": written(tmp_path, "medial.off", medial),
        "insert_lateral": written(tmp_path, "lateral.off", lateral),
    }


def examine(pair, **options):
    return examine_implant(**(pair | {"units": "m", "side_of_body": "right"} | options))


def test_a_sound_mesh_has_no_findings(tmp_path):
    found = examine_mesh(written(tmp_path, "box.off", box((0.03, 0.02, 0.035), (0, 0, 0))), "m")
    assert found.findings == ()
    assert found.after["closed"]


def test_repairs_are_told(tmp_path):
    made = box((0.03, 0.02, 0.035), (0.0, 0.0, 0.0))
    faces = np.array(made.faces)
    faces[3] = faces[3, ::-1]
    faces = np.concatenate([faces, faces[:1], [[0, 0, 1]]]).astype(np.int32)
    broken = written(tmp_path, "broken.off", Mesh(made.vertices, faces))
    repaired = texts(examine_mesh(broken, "m").findings, "repaired")
    assert any("1 repeated faces" in t or "1 faces without area" in t for t in repaired)
    assert any("windings that disagreed" in t for t in repaired)


def test_holes_are_warned_of_and_open_surfaces_are_not(tmp_path):
    surface = patch(0.0073, 0.0, 0.03, 10, up=True)
    assert examine_mesh(written(tmp_path, "open.off", surface), "m").findings == ()
    holed = without(surface, [55, 155])
    (finding,) = examine_mesh(written(tmp_path, "holed.off", holed), "m").findings
    assert finding.severity == "warning"
    assert "1 hole" in finding.text
    assert finding.advice.startswith("Fill them")


def test_a_wall_within_is_an_error_of_a_femur_only(tmp_path):
    made = box((0.03, 0.02, 0.035), (0.0, 0.0, 0.0))
    vertices = np.concatenate([np.asarray(made.vertices), [[0.0, 0.0, 0.0]]])
    a, b = np.array(made.faces)[0, :2]
    walled = Mesh(vertices, np.concatenate([made.faces, [[a, b, 8]]]).astype(np.int32))
    file = written(tmp_path, "walled.off", walled)
    for part, severity in (("femur", "error"), ("insert", "warning")):
        found = examine_mesh(file, "m", part).findings
        assert [f.severity for f in found if "more than two faces" in f.text] == [severity]


def test_an_inverted_solid(tmp_path):
    made = box((0.03, 0.02, 0.035), (0.0, 0.0, 0.0))
    inverted = Mesh(made.vertices, np.ascontiguousarray(np.array(made.faces)[:, ::-1]))
    (finding,) = examine_mesh(written(tmp_path, "in.off", inverted), "m", "femur").findings
    assert (finding.severity, finding.text) == ("error", "the solid is inside out")


def test_an_unusual_size_is_doubted_and_an_impossible_one_is_a_unit(tmp_path):
    small = written(tmp_path, "small.off", box((0.01, 0.008, 0.012), (0.0, 0.0, 0.0)))
    (finding,) = examine_mesh(small, "m", "femur").findings
    assert finding.severity == "warning"
    assert finding.text.startswith("24 mm across")
    (finding,) = examine_mesh(small, "mm", "femur").findings
    assert finding.severity == "error"
    assert finding.advice == "Use --units m."


def test_planes_seat_in_closed_form(pair):
    found = examine(pair)
    assert found.errors == ()
    trial = found.trial
    # Box 11 mm deep on planes at 7.3 mm; 1 kN on two squares of 12 mm: d = F/(K·A).
    depth = 1000.0 / (9.3e9 * 2 * 0.012**2)
    assert trial.first_touch_y_mm == pytest.approx(18.3, abs=2e-6)
    assert trial.seat_status == "converged"
    assert trial.seat_mm[1] == pytest.approx(18.3, abs=2e-6)
    assert trial.max_depth_mm == pytest.approx((1e3 * depth,) * 2, rel=2e-3)
    assert trial.area_mm2 == pytest.approx((144.0, 144.0), rel=1e-9)
    assert trial.peak_pressure_mpa == pytest.approx((9.3e3 * depth,) * 2, rel=2e-3)
    assert trial.loaded_faces == (288, 288)


def test_a_coarse_insert_is_told_how_fine_to_be(pair, tmp_path):
    coarse = written(tmp_path, "coarse.off", patch(0.0073, -0.021, 0.006, 3, up=True))
    (finding,) = [f for f in examine(pair, insert_medial=coarse).findings if "coarse" in f.text]
    assert finding.part == "insert_medial"
    assert "18 faces" in finding.text
    # Edges shorter by √(18/60): 60 faces on the same area.
    mean = 4.0 * (2 + np.sqrt(2)) / 3
    assert f"{mean * np.sqrt(18 / 60):.2g} mm" in finding.advice


def test_an_insert_off_the_middle(pair, tmp_path):
    off = {
        f"insert_{n}": written(tmp_path, f"{n}2.off", patch(0.0073, z + 0.005, 0.006, 12, up=True))
        for n, z in (("medial", -0.021), ("lateral", 0.021))
    }
    assert any("z = 5 mm" in f.text for f in examine(pair, **off).findings)


def test_what_cannot_touch_is_an_error(pair, tmp_path):
    far = written(tmp_path, "far.off", box((0.02, 0.011, 0.04), (0.3, 0.0, 0.0)))
    (error,) = examine(pair, femur=far).errors
    assert "without touching" in error.text
    (error,) = examine(pair, side_of_body="left").errors
    assert "side_of_body" in error.advice
