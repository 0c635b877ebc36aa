# SPDX-License-Identifier: Apache-2.0
"""Pressure maps in pictures and in VTP files."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from condyle import implants
from condyle.contact import ContactMap, Mesh, MeshContact, contact_map
from condyle.errors import InputDataError
from condyle.fdk import seated_pose
from condyle.report.pressure_map import Panel, pressure_map_figure
from condyle.report.style import house_style, save
from condyle.report.vtp_files import write_vtp


@pytest.fixture(scope="module")
def loaded() -> ContactMap:
    surfaces = implants.generate(replace(implants.preset("curved"), mesh_edge_length=2e-3)).meshes()
    parts = {
        part: Mesh(np.array(surfaces[part].vertices), np.array(surfaces[part].faces, np.int32))
        for part in ("femur", "insert_medial", "insert_lateral")
    }
    contact = MeshContact(**parts, side_of_body="right")
    pose = seated_pose(contact).pose
    return contact_map(contact, pose + np.array([0.0, -0.4e-3, 0.0, 0.004, 0.0, 0.0]))


def test_the_picture_shows_every_face_in_its_colour(loaded, tmp_path):
    with house_style():
        figure = pressure_map_figure([Panel("one", loaded), Panel("two", loaded)], title="both")
        file = save(figure, tmp_path / "map.png")
    assert file.read_bytes().startswith(b"\x89PNG")
    first, second, bar = figure.axes
    assert first.get_title().startswith("one")
    assert second.get_title().startswith("two")
    assert bar.get_ylabel() == "contact pressure [MPa]"
    assert bar.get_ylim()[1] == pytest.approx(1e-6 * loaded.peak_pressure, rel=1e-12)
    # Per side: the surface, its loaded faces, the contact's border, the surface's border.
    drawn = [len(c.get_paths()) for c in first.collections]
    for i, side in enumerate(loaded.sides.values()):
        assert drawn[4 * i] == len(side.faces)
        assert drawn[4 * i + 1] == int((side.pressure > 0.0).sum()) > 0
    texts = [t.get_text() for t in first.texts]
    assert {"medial", "lateral"} <= set(texts)
    # Right knee seen from above, z to the right: medial is on the left.
    place = {t.get_text(): t.xy[0] for t in first.texts}
    assert place["medial"] < 0.0 < place["lateral"]
    assert any(f"medial {loaded.sides['medial'].wrench[1]:.0f} N" in t for t in texts)


def test_a_map_without_contact_can_be_drawn(loaded):
    air = replace(
        loaded,
        sides={
            n: replace(s, pressure=0 * s.pressure, depth=0 * s.depth, wrench=0 * s.wrench)
            for n, s in loaded.sides.items()
        },
    )
    figure = pressure_map_figure([Panel("air", air)])
    assert len(figure.axes[0].collections) == 4


def test_vtp_files_read_back_the_same(loaded, tmp_path):
    pytest.importorskip("vtkmodules")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    files = write_vtp(tmp_path / "map", loaded)
    assert [f.name for f in files] == ["femur.vtp", "insert_medial.vtp", "insert_lateral.vtp"]

    def read(name):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(tmp_path / "map" / f"{name}.vtp"))
        reader.Update()
        return reader.GetOutput()

    for name, side in loaded.sides.items():
        surface = read(f"insert_{name}")
        np.testing.assert_array_equal(vtk_to_numpy(surface.GetPoints().GetData()), side.vertices)
        faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        np.testing.assert_array_equal(faces, side.faces)
        for key in ("depth", "pressure"):
            values = vtk_to_numpy(surface.GetCellData().GetArray(key))
            np.testing.assert_array_equal(values, getattr(side, key))
        field = surface.GetFieldData()
        np.testing.assert_array_equal(vtk_to_numpy(field.GetArray("pose_m_rad")), loaded.pose)
        np.testing.assert_array_equal(
            vtk_to_numpy(field.GetArray(f"{name}_wrench_N_Nm")), side.wrench
        )
        assert field.GetAbstractArray("law").GetValue(0) == loaded.law
        assert field.GetAbstractArray("side_of_body").GetValue(0) == "right"
    femur = read("femur")
    np.testing.assert_array_equal(vtk_to_numpy(femur.GetPoints().GetData()), loaded.femur_vertices)
    again = write_vtp(tmp_path / "again", loaded)
    assert [f.read_bytes() for f in files] == [f.read_bytes() for f in again]


def test_without_vtk_the_message_says_what_to_install(loaded, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "vtkmodules.util", None)
    with pytest.raises(InputDataError, match=r"pip install 'condyle\[vtk\]'"):
        write_vtp(tmp_path, loaded)
