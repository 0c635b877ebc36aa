// SPDX-License-Identifier: Apache-2.0
// Which compilation of the fast kernel to run.
#pragma once

#include "condyle/contact/fast_integral.hpp"
#include "condyle/contact/fast_kernel.hpp"

namespace condyle::contact::fast {

/// @throws std::invalid_argument if this machine or build cannot run `set`, naming it.
Kernel kernel_for(InstructionSet set);

}  // namespace condyle::contact::fast
