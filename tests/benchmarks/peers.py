# SPDX-License-Identifier: Apache-2.0
"""One pose of contact, by Condyle and by other programs: time, and what they find.

    .venv/bin/pip install -e '.[peers]'
    OMP_NUM_THREADS=1 .venv/bin/python tests/benchmarks/peers.py

The right knee DM (CONDYLE_DATA, or shared/data beside the project), settled and lowered; both compartments; one thread.
A peer that is not installed says so. What is compared, and how its parameters were matched, is
written at each peer.
"""

import atexit
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from condyle.contact import (
    Derivatives,
    Mesh,
    MeshContact,
    SignedDistance,
    overlap_volume,
    read_mesh,
    read_solid,
)

MODULUS = 9.3e9  # N/m³
#: Where the parts first touch, rotations zero [mm]: x and z free (femur as low as possible), and both 0.
SETTLED, CENTRED = (6.404, 41.107, -0.218), (0.0, 42.2325, 0.0)
#: Place and depth below it [mm].
POSES = (*((SETTLED, depth) for depth in (0.5, 0.7, 0.9, 1.2)), (CENTRED, 0.7))
SIDES = ("medial", "lateral")

#: What a peer answers at a pose: vertical force on the femur [N] or volume of the overlap [m³], or what
#: tells it when called; only the answer itself is timed.
Answer = Callable[[np.ndarray], float | Callable[[], float]]
#: Name, quantity ("N" or "mm³"), and the peer itself.
Peer = tuple[str, str, Answer]


def quickest(
    body: Callable[[], float | Callable[[], float]], seconds: float = 1.0
) -> tuple[float, float]:
    """The quickest of as many calls as fit, at least three, and what the last one answered."""
    best, spent, calls = np.inf, 0.0, 0
    while calls < 3 or (spent < seconds and calls < 2000):
        start = time.perf_counter()
        value = body()
        took = time.perf_counter() - start
        best, spent, calls = min(best, took), spent + took, calls + 1
    return best, value() if callable(value) else value


def arrays(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces as arrays of their own."""
    return np.array(mesh.vertices), np.array(mesh.faces)


def condyle_peers(folder: Path) -> Iterator[Peer]:
    """The reference contact, insert integration; naive: one closest-point query per face, no culling."""
    surfaces = [
        read_mesh(folder / f"{part}.stl", "m")
        for part in ("femur_contact", "insert_contact_medial", "insert_contact_lateral")
    ]
    femur = SignedDistance(surfaces[0])
    # Closed, so that femur faces beyond the rim of an open surface do not count as deep below it.
    blocks = [SignedDistance(Mesh(*thickened(surface, 8e-3))) for surface in surfaces[1:]]
    femur_faces, *insert_faces = map(weighted_centroids, surfaces)

    def naive(pose: np.ndarray) -> float:
        shift = pose[:3]
        return sum(pressed(femur, centroids - shift, areas) for centroids, areas in insert_faces)

    def both(pose: np.ndarray) -> float:
        centroids, areas = femur_faces
        on_femur = sum(-pressed(block, centroids + pose[:3], areas) for block in blocks)
        return 0.5 * (naive(pose) + on_femur)

    yield "condyle naive (force alone)", "N", naive
    yield "  its faces and the femur's, mean", "N", both
    for evaluation in ("exact", "fast"):
        contact = MeshContact(*surfaces, "right", evaluation=evaluation)

        def force(pose: np.ndarray, contact: MeshContact = contact) -> float:
            loads = contact.evaluate(pose[None], Derivatives.stiffness, threads=1)
            return float(loads.wrench[0, :, 1].sum())

        yield f"condyle {evaluation} (wrench and 6×6)", "N", force

    def law_volume(pose: np.ndarray, contact: MeshContact = contact) -> float:
        return float(contact.evaluate_details(pose[None], 1).volume.sum())

    yield "condyle fast, law's own Σ A·d", "mm³", law_volume


def weighted_centroids(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Centroids (m, 3) [m] and areas (m,) [m²] of the faces."""
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners.mean(axis=1), 0.5 * np.linalg.norm(normals, axis=1)


def pressed(surface: SignedDistance, points: np.ndarray, areas: np.ndarray) -> float:
    """Vertical force on a surface of weighted points below it, by one closest-point query each."""
    distance, gradient = surface.query(np.ascontiguousarray(points))
    return float(MODULUS * np.sum(areas * np.minimum(0.0, distance) * gradient[:, 1]))


def boolean_peers(folder: Path) -> Iterator[Peer]:
    """The exact overlap volume of the closed solids."""
    parts = ("femur_solid", "insert_solid_medial", "insert_solid_lateral")
    femur, *inserts = (read_solid(folder / f"{p}.stl", "m", option=p) for p in parts)

    def boolean(pose: np.ndarray) -> float:
        return float(sum(overlap_volume(femur, i, pose, threads=1).volume[0] for i in inserts))

    yield "condyle boolean (solids)", "mm³", boolean


def manifold_peers(folder: Path) -> Iterator[Peer]:
    """manifold3d's Boolean of the same solids, in double precision."""
    import manifold3d

    def solid(part: str) -> manifold3d.Manifold:
        vertices, faces = arrays(read_mesh(folder / f"{part}.stl", "m"))
        mesh = manifold3d.Mesh64(vertices, faces.astype(np.uint64))
        return manifold3d.Manifold(mesh)

    femur, *inserts = map(solid, ("femur_solid", "insert_solid_medial", "insert_solid_lateral"))

    def boolean(pose: np.ndarray) -> float:
        return float(sum((femur.translate(pose[:3]) ^ insert).volume() for insert in inserts))

    yield "manifold3d boolean (solids)", "mm³", boolean


def opensim_peers(folder: Path) -> Iterator[Peer]:
    """OpenSim's ElasticFoundationForce: p = K·d on the faces of both meshes, each counted half.

    Closed meshes are asked for, so the solids; no dissipation, no friction. The time is that of realising the
    model's dynamics at a new pose, of which the contact is nearly all.
    """
    import opensim

    opensim.Logger.setLevelString("error")
    model = opensim.Model()
    femur = opensim.Body("femur", 1.0, opensim.Vec3(0), opensim.Inertia(1e-3, 1e-3, 1e-3))
    model.addBody(femur)
    joint = opensim.FreeJoint("joint", model.getGround(), femur)
    model.addJoint(joint)

    scratch = scratch_folder()

    def contact_mesh(part: str, body: object) -> None:
        file = scratch / f"{part}.obj"  # not STL, whose vertices it would not weld
        write_obj(file, *arrays(read_mesh(folder / f"{part}.stl", "m")))
        mesh = opensim.ContactMesh(str(file), opensim.Vec3(0), opensim.Vec3(0), body)
        mesh.setName(part)
        model.addContactGeometry(mesh)

    contact_mesh("femur_solid", femur)
    forces = []
    for side in SIDES:
        contact_mesh(f"insert_solid_{side}", model.getGround())
        force = opensim.ElasticFoundationForce()
        force.setName(side)
        for part in ("femur_solid", f"insert_solid_{side}"):
            force.addGeometry(part)
        force.setStiffness(MODULUS)
        for zero in (force.setDissipation, force.setStaticFriction, force.setDynamicFriction):
            zero(0.0)
        force.setViscousFriction(0.0)
        model.addForce(force)
        forces.append(force)
    state = model.initSystem()
    labels = [forces[0].getRecordLabels().get(i) for i in range(forces[0].getRecordLabels().size())]
    column = next(i for i, name in enumerate(labels) if "femur" in name and "force.Y" in name)
    coordinates = [joint.get_coordinates(i) for i in range(6)]

    def vertical(pose: np.ndarray) -> float:
        for i in range(3):
            coordinates[3 + i].setValue(state, float(pose[i]), False)
        model.realizeDynamics(state)
        return float(sum(f.getRecordValues(state).get(column) for f in forces))

    yield "OpenSim ElasticFoundationForce", "N", vertical


def thickened(mesh: Mesh, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """A closed block under an open surface: its copy, moved down, and walls along the border."""
    vertices, faces = arrays(mesh)
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys = {tuple(edge) for edge in directed.tolist()}
    border = np.array([(a, b) for a, b in keys if (b, a) not in keys])
    n = len(vertices)
    a, b = border.T
    walls = np.concatenate([np.stack([b, a, a + n], 1), np.stack([b, a + n, b + n], 1)])
    below = vertices - [0.0, thickness, 0.0]
    closed = np.concatenate([faces, faces[:, ::-1] + n, walls])
    return np.concatenate([vertices, below]), np.ascontiguousarray(closed, dtype=np.int32)


def drake_peers(folder: Path) -> Iterator[Peer]:
    """Drake's hydroelastic contact: rigid femur, compliant insert of tetrahedra.

    The insert's solids pass through themselves, which no tetrahedraliser takes: so each contact surface is thickened
    downwards by 8 mm. Drake's pressure is E times depth over the deepest vertex's; E is K times that, so that
    p = K·d, d linear in each tetrahedron. Pressure is integrated over the femur's surface. Lengths are in mm, because
    tetrahedra of half a millimetre count as degenerate in m.
    """
    import pydrake.geometry as geometry
    import tetgen
    from pydrake.math import RigidTransform

    scene = geometry.SceneGraph()
    source = scene.RegisterSource("knee")
    scratch = scratch_folder()
    for side in SIDES:
        vertices, faces = thickened(read_mesh(folder / f"insert_contact_{side}.stl", "m"), 8e-3)
        mesher = tetgen.TetGen(1e3 * vertices, faces)
        nodes, tetrahedra = mesher.tetrahedralize(order=1, minratio=1.5, mindihedral=15.0)[:2]
        surface = SignedDistance(Mesh(vertices, faces))
        deepest = -1e3 * float(surface.query(np.ascontiguousarray(1e-3 * nodes))[0].min())
        write_vtk(scratch / f"{side}.vtk", nodes, tetrahedra)
        properties = geometry.ProximityProperties()
        geometry.AddCompliantHydroelasticProperties(1.0, 1e-9 * MODULUS * deepest, properties)
        block = geometry.Mesh(scratch / f"{side}.vtk")
        instance = geometry.GeometryInstance(RigidTransform(), block, side)
        instance.set_proximity_properties(properties)
        scene.RegisterAnchoredGeometry(source, instance)
    frame = scene.RegisterFrame(source, geometry.GeometryFrame("femur"))
    vertices, faces = arrays(read_mesh(folder / "femur_solid.stl", "m"))
    write_obj(scratch / "femur.obj", 1e3 * vertices, faces)
    properties = geometry.ProximityProperties()
    geometry.AddRigidHydroelasticProperties(1.0, properties)
    body = geometry.Mesh(scratch / "femur.obj")
    instance = geometry.GeometryInstance(RigidTransform(), body, "femur")
    instance.set_proximity_properties(properties)
    femur = scene.RegisterGeometry(source, frame, instance)
    context = scene.CreateDefaultContext()
    triangles = geometry.HydroelasticContactRepresentation.kTriangle

    def vertical(pose: np.ndarray) -> Callable[[], float]:
        poses = geometry.FramePoseVector()
        poses.set_value(frame, RigidTransform(1e3 * pose[:3]))
        scene.get_source_pose_port(source).FixValue(context, poses)
        query = scene.get_query_output_port().Eval(context)
        found = query.ComputeContactSurfaces(triangles)
        # Drake sums a surface's force in C++ within a plant; this sum in Python is not timed.
        return lambda: float(sum(surface_force(surface, femur) for surface in found))

    yield "Drake hydroelastic (blocks)", "N", vertical


def surface_force(surface: object, femur: object) -> float:
    """Vertical force on the femur of one hydroelastic contact surface: normals point out of N into M."""
    mesh, pressures = surface.tri_mesh_W(), surface.tri_e_MN()
    total = 0.0
    for i in range(mesh.num_triangles()):
        mean = pressures.EvaluateCartesian(e=i, p_MQ=mesh.element_centroid(i))
        total += mean * mesh.area(i) * mesh.face_normal(i)[1]
    return total if surface.id_M() == femur else -total


def scratch_folder() -> Path:
    """A folder that is gone when the program ends."""
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def write_obj(file: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """A triangle mesh as OBJ."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    file.write_text("\n".join(lines) + "\n")


def write_vtk(file: Path, nodes: np.ndarray, tetrahedra: np.ndarray) -> None:
    """A volume mesh in VTK's legacy text format."""
    lines = ["# vtk DataFile Version 3.0", "insert", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {len(nodes)} double", *(f"{x!r} {y!r} {z!r}" for x, y, z in nodes.tolist())]
    lines += [f"CELLS {len(tetrahedra)} {5 * len(tetrahedra)}"]
    lines += [f"4 {a} {b} {c} {d}" for a, b, c, d in tetrahedra.tolist()]
    lines += [f"CELL_TYPES {len(tetrahedra)}", *("10" for _ in tetrahedra)]
    file.write_text("\n".join(lines) + "\n")


def main() -> None:
    """Prints the table, a block a pose."""
    data = os.environ.get("CONDYLE_DATA")
    folder = Path(data) if data else Path(__file__).parents[2].parent / "shared" / "data"
    folder = folder / "implants" / "dm"
    if not folder.is_dir():
        raise SystemExit("no implants: set CONDYLE_DATA, or put shared/data beside the project")
    peers: list[Peer] = []
    for make in (condyle_peers, boolean_peers, manifold_peers, opensim_peers, drake_peers):
        try:
            peers += make(folder)
        except ImportError as error:
            print(f"{make.__name__.removesuffix('_peers')}: not installed ({error.name})")
        except Exception as error:  # a peer's own failure: said, and the others go on
            print(f"{make.__name__.removesuffix('_peers')}: {type(error).__name__}: {error}")
    for touch, depth in POSES:
        print_pose(peers, touch, depth)


def print_pose(peers: list[Peer], touch: tuple[float, float, float], depth: float) -> None:
    """One block of the table: every peer at the place of first touch lowered by a depth [mm]."""
    x, y, z = touch
    pose = 1e-3 * np.array([x, y - depth, z, 0.0, 0.0, 0.0])
    found = {name: quickest(partial(answer, pose)) for name, _, answer in peers}
    fast = found["condyle fast (wrench and 6×6)"][0]
    base = {
        "N": found["condyle exact (wrench and 6×6)"][1],
        "mm³": found["condyle boolean (solids)"][1],
    }
    row = "  {:<34}{:>12}{:>12}{:>14}{:>12}".format
    print(f"first touch at x {x}, y {y}, z {z} mm, lowered by {depth} mm")
    print(row("", "ms", "× fast", "Fy or volume", "difference"))
    for name, unit, _ in peers:
        seconds, value = found[name]
        shown = f"{value:.1f} N" if unit == "N" else f"{1e9 * value:.2f} mm³"
        off = f"{100 * (value / base[unit] - 1):+.3f} %"
        print(row(name, f"{1e3 * seconds:.3f}", f"{seconds / fast:.1f}", shown, off))


if __name__ == "__main__":
    main()
