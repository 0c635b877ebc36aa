// SPDX-License-Identifier: Apache-2.0
// Clinical knee kinematics after Grood and Suntay: what reports show, always under these names.
//
// R_FT = Rz(a)·Rx(b)·Ry(c), with H the vector Fo → To, e1 the femoral z axis, e3 the tibial y axis and
// e2 = e3 × e1 / |e3 × e1| the floating axis:
//
//   flexion = −a;   adduction = −b (left) or +b (right);   tibial external rotation = +c (left) or −c (right);
//   lateral tibial translation = H·e1 (right) or −H·e1 (left);   anterior tibial translation = H·e2;
//   distraction = −H·e3.
//
// Flexion differs from −θz of the pose by up to half a degree: θz is the coordinate, flexion the clinical measure.
//
// Source: Grood & Suntay 1983, J Biomech Eng 105(2):136–144, doi:10.1115/1.3138397; sequence as in Marra et al. 2017.
#pragma once

#include "condyle/common/pose.hpp"
#include "condyle/common/side.hpp"

namespace condyle {

struct ClinicalKinematics {
  double flexion = 0.0;                       ///< [rad]
  double adduction = 0.0;                     ///< [rad] varus positive
  double tibial_external_rotation = 0.0;      ///< [rad]
  double anterior_tibial_translation = 0.0;   ///< [m]
  double distraction = 0.0;                   ///< [m] along the tibial axis
  double lateral_tibial_translation = 0.0;    ///< [m]
};

/// Clinical kinematics of a pose. @pre |b| < π/2 (a knee's adduction is a few degrees).
ClinicalKinematics clinical_kinematics(const Pose& pose, SideOfBody side_of_body);

}  // namespace condyle
