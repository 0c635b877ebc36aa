// SPDX-License-Identifier: Apache-2.0
#include "condyle/common/clinical_kinematics.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace condyle {

ClinicalKinematics clinical_kinematics(const Pose& pose, SideOfBody side_of_body) {
  const Matrix3 R_TF = rotation_TF(pose);
  const Matrix3 R_FT = R_TF.transpose();
  // Entries of Rz(a)·Rx(b)·Ry(c): (0,1) = −sin a cos b, (1,1) = cos a cos b, (2,1) = sin b,
  // (2,0) = −cos b sin c, (2,2) = cos b cos c.
  const double a = std::atan2(-R_FT(0, 1), R_FT(1, 1));
  const double b = std::atan2(R_FT(2, 1), std::hypot(R_FT(0, 1), R_FT(1, 1)));
  const double c = std::atan2(-R_FT(2, 0), R_FT(2, 2));

  const Vector3 p_FoTo_T = -pose.head<3>();
  const Vector3 e1 = R_TF.col(2);
  const Vector3 e3 = Vector3::UnitY();
  const Vector3 e2 = e3.cross(e1).normalized();

  const double mirror = side_of_body == SideOfBody::kRight ? 1.0 : -1.0;
  ClinicalKinematics clinical;
  clinical.flexion = -a;
  clinical.adduction = mirror * b;
  clinical.tibial_external_rotation = -mirror * c;
  clinical.lateral_tibial_translation = mirror * p_FoTo_T.dot(e1);
  clinical.anterior_tibial_translation = p_FoTo_T.dot(e2);
  clinical.distraction = -p_FoTo_T.dot(e3);
  return clinical;
}

}  // namespace condyle
