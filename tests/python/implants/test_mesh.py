# SPDX-License-Identifier: Apache-2.0
"""Surfaces are clean, oriented, open discs; left is the mirror of right."""

from dataclasses import replace

import numpy as np
import pytest

from condyle.errors import InputDataError
from condyle.implants import Implant, SurfaceMesh, generate, preset


def test_surfaces_are_manifold_and_consistently_wound(implant: Implant, measure) -> None:
    for name, mesh in implant.meshes().items():
        undirected, directed = measure.edge_uses(mesh)
        assert undirected.max() == 2, name
        assert directed.max() == 1, name  # two faces run an edge in opposite directions
        assert np.array_equal(np.unique(mesh.faces), np.arange(len(mesh.vertices))), name
        assert mesh.vertices.dtype == np.float64
        assert mesh.faces.dtype == np.int32


def test_every_surface_is_one_disc(implant: Implant, measure) -> None:
    trimesh = pytest.importorskip("trimesh")
    for name, mesh in implant.meshes().items():
        edges = len(measure.edge_uses(mesh)[0])
        euler = len(mesh.vertices) - edges + len(mesh.faces)
        assert euler == 1, name  # connected (below) and one border loop: the notch opens backwards
        other = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        assert other.body_count == 1, name
        assert other.is_winding_consistent, name


def test_no_face_is_degenerate(implant: Implant) -> None:
    edge = implant.parameters.mesh_edge_length
    for name, mesh in implant.meshes().items():
        corners = mesh.vertices[mesh.faces]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        area = np.linalg.norm(mesh.area_vectors(), axis=1)
        height = 2.0 * area / sides.max(axis=1)
        assert height.min() > 0.2 * edge, name
        assert sides.max() < 4.0 * edge, name
        assert 0.7 * edge < np.median(sides) < 1.2 * edge, name


def test_mesh_sizes_are_as_announced(implant: Implant) -> None:
    assert 20_000 <= len(implant.femur.faces) <= 30_000
    assert 10_000 <= len(implant.insert.faces) <= 15_000


def test_left_is_the_mirror_of_right_with_outward_normals(implant: Implant) -> None:
    right = implant
    left = generate(replace(right.parameters, side_of_body="left"))
    mirror = np.array([1.0, 1.0, -1.0])
    for name, mesh in left.meshes().items():
        other = right.meshes()[name]
        # Corners come in the opposite order, so centroids differ by rounding: eps * 0.04 m.
        np.testing.assert_allclose(mesh.centroids(), other.centroids() * mirror, atol=4e-17)
        # A mirrored normal is a mirrored vector: flipping the faces keeps it outward.
        np.testing.assert_allclose(mesh.face_normals(), other.face_normals() * mirror, atol=1e-12)
    assert left.insert_medial.vertices[:, 2].min() == 0.0
    assert right.insert_medial.vertices[:, 2].max() == 0.0
    assert left.insert_lateral.vertices[:, 2].max() == 0.0


def test_normals_point_at_the_partner(implant: Implant) -> None:
    assert implant.insert.face_normals()[:, 1].min() > 0.5
    femur, p = implant.femur, implant.parameters
    normals, centroids = femur.face_normals(), femur.centroids()
    # Seen from an axis inside the J-curve, every face that is not a side wall looks away from it.
    away = centroids[:, :2] - np.array([-p.distal_point_offset, -0.25 * p.distal_point_height])
    outward = (normals[:, :2] * away).sum(axis=1) / np.linalg.norm(away, axis=1)
    articular = np.abs(normals[:, 2]) < 0.5
    assert articular.sum() > 0.6 * len(normals)
    assert outward[articular].min() > 0.1
    lowest = centroids[:, 1] < -p.distal_point_height + 0.1e-3
    # 0.1 mm up the 4 mm edge the normal has turned by acos(1 - 0.1 / 4).
    assert normals[lowest, 1].max() < -0.97


def test_the_insert_is_its_two_halves(implant: Implant) -> None:
    whole = np.linalg.norm(implant.insert.area_vectors(), axis=1).sum()
    halves = [implant.insert_medial, implant.insert_lateral]
    areas = [np.linalg.norm(half.area_vectors(), axis=1).sum() for half in halves]
    assert areas[0] == pytest.approx(areas[1], rel=1e-12)
    assert sum(areas) == pytest.approx(whole, rel=1e-12)
    assert len(halves[0].faces) + len(halves[1].faces) == len(implant.insert.faces)


def test_generation_is_reproducible() -> None:
    p = preset("curved", size=0.93)
    first, second = generate(p), generate(p)
    for name, mesh in first.meshes().items():
        assert mesh.vertices.tobytes() == second.meshes()[name].vertices.tobytes()
        assert mesh.faces.tobytes() == second.meshes()[name].faces.tobytes()


def test_border_vertices_are_those_of_an_open_square() -> None:
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0))
    vertices = np.stack([x.ravel(), y.ravel(), 0.3 * x.ravel()], axis=-1)
    corner = np.array([4 * j + i for j in range(2) for i in range(3)])
    first = np.stack([corner, corner + 1, corner + 5], -1)
    second = np.stack([corner, corner + 5, corner + 4], -1)
    faces = np.concatenate([first, second]).astype(np.int32)
    border = SurfaceMesh(vertices, faces).border_vertices()
    assert sorted(set(range(12)) - set(border.tolist())) == [5, 6]


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (np.zeros((3, 2)), np.zeros((1, 3)), "mesh vertices of shape (3, 2): must be (n, 3)"),
        (np.zeros((3, 3)), np.zeros(3), "mesh faces of shape (3,): must be (n, 3)"),
        (np.zeros((3, 3)), np.array([[0, 1, 3]]), "use vertices 0 to 3: must lie in [0, 2]"),
    ],
)
def test_arrays_that_are_no_mesh_are_refused(vertices, faces, message: str) -> None:
    with pytest.raises(InputDataError) as caught:
        SurfaceMesh(vertices, faces.astype(np.int32))
    assert message in str(caught.value)
