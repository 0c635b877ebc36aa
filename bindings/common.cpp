// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "arrays.hpp"
#include "condyle/common/clinical_kinematics.hpp"
#include "condyle/common/pose.hpp"
#include "condyle/common/side.hpp"

namespace condyle::bindings {
namespace {

nb::ndarray<nb::numpy, double> clinical_table(const PosesIn& poses, SideOfBody side) {
  std::vector<double> table;
  table.reserve(6 * poses.shape(0));
  for (const Pose& pose : as_poses(poses)) {
    const ClinicalKinematics k = clinical_kinematics(pose, side);
    table.insert(table.end(), {k.flexion, k.adduction, k.tibial_external_rotation,
                               k.anterior_tibial_translation, k.distraction,
                               k.lateral_tibial_translation});
  }
  return to_numpy(std::move(table), {poses.shape(0), 6});
}

}  // namespace

void bind_common(nb::module_& m) {
  using namespace nb::literals;
  nb::enum_<SideOfBody>(m, "SideOfBody")
      .value("left", SideOfBody::kLeft)
      .value("right", SideOfBody::kRight);
  m.def("side_of_body", [](const std::string& name) { return side_of_body_from_name(name); }, "name"_a,
        "Reads 'left' or 'right'.");
  m.def("rotation_TF", [](const PoseIn& pose) { return to_numpy(rotation_TF(as_pose(pose))); }, "pose"_a,
        "R_TF (3, 3): components in F to components in T.");
  m.def("twist_map", [](const PoseIn& pose) { return to_numpy(twist_map(as_pose(pose))); }, "pose"_a,
        "G (6, 6): pose rates to the twist of F in T.");
  m.def("pose_from_transform",
        [](const nb::ndarray<const double, nb::shape<3, 3>, nb::c_contig, nb::device::cpu>& R,
           const nb::ndarray<const double, nb::shape<3>, nb::c_contig, nb::device::cpu>& p) {
          RigidTransform X_TF;
          X_TF.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
          X_TF.p = Vector3(p.data());
          return to_numpy(pose_from_transform(X_TF));
        },
        "R_TF"_a, "p_TFo_T"_a, "The pose (6,) of a placement.");
  m.def("clinical_kinematics", &clinical_table, "poses"_a, "side_of_body"_a,
        "Grood-Suntay kinematics (n, 6): flexion, adduction, tibial external rotation [rad], anterior tibial "
        "translation, distraction, lateral tibial translation [m].");
}

}  // namespace condyle::bindings
