// SPDX-License-Identifier: Apache-2.0
#include "condyle/common/clinical_kinematics.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>

#include "support/random_pose.hpp"

using namespace condyle;

namespace {

Matrix3 about(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// A placement built from clinical quantities by turning about the joint coordinate system's own axes:
// flexion about the femoral z, adduction about the floating axis, rotation about the tibial y.
RigidTransform placement(double a, double b, double c, const Vector3& p_TFo_T) {
  const Matrix3 R_FT =
      about(Vector3::UnitZ(), a) * about(Vector3::UnitX(), b) * about(Vector3::UnitY(), c);
  return {R_FT.transpose(), p_TFo_T};
}

}  // namespace

TEST_CASE("clinical angles come back from a placement built of them, left and right [oracle]") {
  test::Draw draw(21);
  for (int trial = 0; trial < 40; ++trial) {
    const double a = draw(-2.0, 0.2), b = draw(-0.4, 0.4), c = draw(-0.5, 0.5);
    const Vector3 p(draw(-0.01, 0.01), draw(0.03, 0.05), draw(-0.01, 0.01));
    const Pose pose = pose_from_transform(placement(a, b, c, p));
    for (const SideOfBody side : {SideOfBody::kLeft, SideOfBody::kRight}) {
      const double mirror = side == SideOfBody::kRight ? 1.0 : -1.0;
      const ClinicalKinematics clinical = clinical_kinematics(pose, side);
      CHECK(clinical.flexion == doctest::Approx(-a).epsilon(1e-12));
      CHECK(clinical.adduction == doctest::Approx(mirror * b).epsilon(1e-12));
      CHECK(clinical.tibial_external_rotation == doctest::Approx(-mirror * c).epsilon(1e-12));
    }
  }
}

TEST_CASE("translations are components of the vector between origins along the joint's axes [oracle]") {
  test::Draw draw(22);
  const Pose pose = test::general_pose(draw, 0.3);
  const ClinicalKinematics clinical = clinical_kinematics(pose, SideOfBody::kRight);
  // Rebuild To − Fo from the three (non-orthogonal) components.
  const Vector3 e1 = rotation_TF(pose) * Vector3::UnitZ();
  const Vector3 e3 = Vector3::UnitY();
  const Vector3 e2 = e3.cross(e1).normalized();
  Matrix3 axes;
  axes << e1.transpose(), e2.transpose(), e3.transpose();
  const Vector3 components(clinical.lateral_tibial_translation, clinical.anterior_tibial_translation,
                           -clinical.distraction);
  CHECK((axes.inverse() * components + pose.head<3>()).norm() < 1e-14);
}

TEST_CASE("a mirrored left knee has the right knee's clinical kinematics [property]") {
  test::Draw draw(23);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose right = test::general_pose(draw, 0.5);
    Pose left = right;
    for (const int i : {kZ, kThetaX, kThetaY}) left[i] = -left[i];
    const ClinicalKinematics r = clinical_kinematics(right, SideOfBody::kRight);
    const ClinicalKinematics l = clinical_kinematics(left, SideOfBody::kLeft);
    CHECK(l.flexion == doctest::Approx(r.flexion));
    CHECK(l.adduction == doctest::Approx(r.adduction));
    CHECK(l.tibial_external_rotation == doctest::Approx(r.tibial_external_rotation));
    CHECK(l.anterior_tibial_translation == doctest::Approx(r.anterior_tibial_translation));
    CHECK(l.distraction == doctest::Approx(r.distraction));
    CHECK(l.lateral_tibial_translation == doctest::Approx(r.lateral_tibial_translation));
  }
}

TEST_CASE("raising the femur is distraction, moving it back is anterior tibial translation [oracle]") {
  Pose pose = Pose::Zero();
  pose[kY] = 0.043;
  pose[kX] = -0.004;
  pose[kThetaZ] = -0.7;
  const ClinicalKinematics clinical = clinical_kinematics(pose, SideOfBody::kLeft);
  CHECK(clinical.distraction == doctest::Approx(0.043));
  CHECK(clinical.anterior_tibial_translation == doctest::Approx(0.004));
  CHECK(clinical.flexion == doctest::Approx(0.7));
}
