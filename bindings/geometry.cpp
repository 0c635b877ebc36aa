// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>

#include "arrays.hpp"
#include "condyle/geometry/mesh_file.hpp"
#include "condyle/geometry/mesh_hash.hpp"
#include "condyle/geometry/mesh_repair.hpp"
#include "condyle/geometry/mesh_report.hpp"
#include "condyle/geometry/overlap_volume.hpp"
#include "condyle/geometry/signed_distance.hpp"

namespace condyle::bindings {
namespace {

using namespace geometry;

using VerticesIn = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using FacesIn = nb::ndarray<const std::int32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

void make_mesh(TriangleMesh* mesh, const VerticesIn& vertices, const FacesIn& faces) {
  TriangleMesh made;
  made.vertices = Eigen::Map<const VertexArray>(vertices.data(),
                                                static_cast<Eigen::Index>(vertices.shape(0)), 3);
  made.faces =
      Eigen::Map<const FaceArray>(faces.data(), static_cast<Eigen::Index>(faces.shape(0)), 3);
  require_well_formed(made, "mesh");
  new (mesh) TriangleMesh(std::move(made));
}

// Views of the mesh's own memory: read-only, and keeping the mesh alive.
auto vertices_of(const TriangleMesh& mesh) {
  return nb::ndarray<nb::numpy, const double, nb::shape<-1, 3>>(
      mesh.vertices.data(), {static_cast<std::size_t>(mesh.vertex_count()), 3}, nb::find(mesh));
}
auto faces_of(const TriangleMesh& mesh) {
  return nb::ndarray<nb::numpy, const std::int32_t, nb::shape<-1, 3>>(
      mesh.faces.data(), {static_cast<std::size_t>(mesh.face_count()), 3}, nb::find(mesh));
}

nb::tuple query(const SignedDistance& surface, const VerticesIn& points) {
  const std::size_t n = points.shape(0);
  std::vector<double> distance, gradient;
  for (std::size_t i = 0; i < n; ++i) {
    const SurfaceQuery found = surface.query(Vector3(points.data() + 3 * i));
    distance.push_back(found.distance);
    gradient.insert(gradient.end(), found.gradient.data(), found.gradient.data() + 3);
  }
  return nb::make_tuple(to_numpy(std::move(distance), {n}), to_numpy(std::move(gradient), {n, 3}));
}

void bind_report(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<MeshReport>(m, "MeshReport", "What is right and wrong with a triangle surface.")
      .def_ro("vertices", &MeshReport::vertices)
      .def_ro("faces", &MeshReport::faces)
      .def_ro("unused_vertices", &MeshReport::unused_vertices, "Vertices in no face.")
      .def_ro("boundary_edges", &MeshReport::boundary_edges, "Edges of one face.")
      .def_ro("boundary_loops", &MeshReport::boundary_loops, "Connected runs of boundary edges.")
      .def_ro("inconsistent_edges", &MeshReport::inconsistent_edges,
              "Edges where windings disagree.")
      .def_ro("non_manifold_edges", &MeshReport::non_manifold_edges,
              "Edges of three faces or more.")
      .def_ro("duplicate_vertices", &MeshReport::duplicate_vertices,
              "At an earlier vertex's place.")
      .def_ro("duplicate_faces", &MeshReport::duplicate_faces, "With an earlier face's vertices.")
      .def_ro("degenerate_faces", &MeshReport::degenerate_faces, "Faces without area.")
      .def_ro("sliver_faces", &MeshReport::sliver_faces, "Faces with an altitude under 1 um.")
      .def_ro("components", &MeshReport::components, "Parts that share no edge.")
      .def_ro("closed", &MeshReport::closed, "No boundary edge.")
      .def_ro("area", &MeshReport::area, "[m^2]")
      .def_ro("volume", &MeshReport::volume, "Signed, normals out positive; 0 unless closed [m^3].")
      .def_prop_ro(
          "lowest", [](const MeshReport& r) { return to_numpy(r.lowest); }, nb::rv_policy::move,
          "Bounding box (3,) [m].")
      .def_prop_ro(
          "highest", [](const MeshReport& r) { return to_numpy(r.highest); }, nb::rv_policy::move,
          "Bounding box (3,) [m].");
  m.def("report_mesh", &report_mesh, "mesh"_a, nb::call_guard<nb::gil_scoped_release>());
}

void bind_repair(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<RepairSettings>(m, "RepairSettings")
      .def(nb::init<>())
      .def_rw("weld_distance", &RepairSettings::weld_distance,
              "Vertices closer than this become one [m].")
      .def_rw("turn_closed_outward", &RepairSettings::turn_closed_outward,
              "Turn a closed component whose volume is negative.");
  nb::class_<RepairResult>(m, "RepairResult", "A repaired surface, and how much of what was done.")
      .def_ro("mesh", &RepairResult::mesh)
      .def_ro("welded_vertices", &RepairResult::welded_vertices)
      .def_ro("unused_vertices", &RepairResult::unused_vertices)
      .def_ro("degenerate_faces", &RepairResult::degenerate_faces)
      .def_ro("duplicate_faces", &RepairResult::duplicate_faces)
      .def_ro("turned_faces", &RepairResult::turned_faces)
      .def_ro("inconsistent_edges", &RepairResult::inconsistent_edges);
  m.def("repair_mesh", &repair_mesh, "mesh"_a, "settings"_a,
        nb::call_guard<nb::gil_scoped_release>(),
        "Welds vertices, drops faces without area and repeated faces, makes windings agree.");
}

// (volume (n,), centroid (n, 3), status by name): a femur's overlap with an insert at n poses.
nb::tuple overlaps(const OverlapSolid& femur, const OverlapSolid& insert, const PosesIn& poses,
                   int threads) {
  std::vector<OverlapVolume> found;
  {
    nb::gil_scoped_release release;
    found = overlap_volumes(femur, insert, as_poses(poses), threads);
  }
  std::vector<double> volume, centroid;
  std::vector<std::string> status;
  for (const OverlapVolume& one : found) {
    volume.push_back(one.volume);
    centroid.insert(centroid.end(), one.centroid.data(), one.centroid.data() + 3);
    status.emplace_back(name(one.status));
  }
  return nb::make_tuple(to_numpy(std::move(volume), {found.size()}),
                        to_numpy(std::move(centroid), {found.size(), 3}), std::move(status));
}

void bind_overlap(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<OverlapSolid>(m, "OverlapSolid", "A closed surface, prepared to be overlapped.")
      .def(nb::init<const TriangleMesh&, const std::string&>(), "mesh"_a, "what"_a,
           nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("volume", &OverlapSolid::volume, "[m^3]")
      .def_prop_ro("self_intersections", &OverlapSolid::self_intersections,
                   "Pairs of faces that meet in more than what they share.");
  m.def("overlap_volumes", &overlaps, "femur"_a, "insert"_a, "poses"_a, "threads"_a,
        "Volume (n,) [m^3], centroid (n, 3) [m] and status of the overlap at poses (n, 6).");
}

}  // namespace

void bind_geometry(nb::module_& m) {
  using namespace nb::literals;
  nb::enum_<LengthUnit>(m, "LengthUnit")
      .value("m", LengthUnit::kMetre)
      .value("mm", LengthUnit::kMillimetre);
  m.def(
      "length_unit", [](const std::string& name) { return length_unit_from_name(name); }, "name"_a,
      "Reads 'm' or 'mm'.");
  nb::class_<TriangleMesh>(m, "Mesh", "A triangle surface; arrays are read-only views.")
      .def("__init__", &make_mesh, "vertices"_a, "faces"_a)
      .def_prop_ro("vertices", &vertices_of, "(n, 3) float64 [m].")
      .def_prop_ro("faces", &faces_of, "(m, 3) int32, counter-clockwise seen from outside.");
  m.def("read_mesh", &read_mesh, "file"_a, "unit"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Reads an STL, OBJ, PLY or OFF file; vertices come in m.");
  m.def("write_mesh", &write_mesh, "file"_a, "mesh"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Writes an STL, OBJ, PLY or OFF file, in m.");
  m.def("content_hash", &content_hash, "mesh"_a,
        "SHA-256 of counts, vertices and faces, 64 hex digits.");
  bind_report(m);
  bind_repair(m);
  bind_overlap(m);
  nb::class_<SignedDistance>(m, "SignedDistance",
                             "Exact signed distance to a surface, negative inside.")
      .def(nb::init<const TriangleMesh&>(), "mesh"_a, nb::call_guard<nb::gil_scoped_release>())
      .def("query", &query, "points"_a,
           "Distance (n,) [m] and gradient (n, 3) at points (n, 3) [m].");
}

}  // namespace condyle::bindings
