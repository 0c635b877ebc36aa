// SPDX-License-Identifier: Apache-2.0
// Columns of loads in the tables that condyle-sim writes.
#pragma once

#include <span>

#include "condyle/common/side.hpp"
#include "condyle/contact/contact_model.hpp"
#include "condyle/io/table.hpp"

namespace condyle::apps {

/// Appends <side>_Fx … <side>_Mz of one side [N, Nm].
void add_wrench(io::Table& table, Side side, std::span<const contact::ContactLoads> loads);

/// Appends the column `trust`.
void add_trust(io::Table& table, std::span<const contact::ContactLoads> loads);

}  // namespace condyle::apps
