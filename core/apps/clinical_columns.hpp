// SPDX-License-Identifier: Apache-2.0
// Names of clinical kinematics in the tables that condyle-sim writes.
#pragma once

#include <array>
#include <utility>

#include "condyle/common/clinical_kinematics.hpp"

namespace condyle::apps {

using ClinicalColumn = std::pair<const char*, double ClinicalKinematics::*>;

inline constexpr std::array<ClinicalColumn, 6> kClinicalColumns{
    {{"flexion_rad", &ClinicalKinematics::flexion},
     {"adduction_rad", &ClinicalKinematics::adduction},
     {"tibial_external_rotation_rad", &ClinicalKinematics::tibial_external_rotation},
     {"anterior_tibial_translation_m", &ClinicalKinematics::anterior_tibial_translation},
     {"distraction_m", &ClinicalKinematics::distraction},
     {"lateral_tibial_translation_m", &ClinicalKinematics::lateral_tibial_translation}}};

}  // namespace condyle::apps
