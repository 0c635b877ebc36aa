// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/contact/fast_dispatch.hpp"
#include "condyle/contact/fast_faces.hpp"
#include "contact/fast_fixture.hpp"

namespace condyle::contact {
namespace {

TEST_CASE("[property] the best set and all below it can run; what cannot run is refused by name") {
  CHECK_NOTHROW(fast::kernel_for(best_instruction_set()));
  CHECK_NOTHROW(fast::kernel_for(InstructionSet::kBaseline));
  for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (set <= best_instruction_set()) {
      const bool own = fast::kernel_for(set) != fast::kernel_for(InstructionSet::kBaseline);
      CHECK(own);
      continue;
    }
    try {
      fast::kernel_for(set);
      FAIL("accepted");
    } catch (const std::invalid_argument& error) {
      CHECK(std::string(error.what()).find(name(set)) != std::string::npos);
    }
  }
}

TEST_CASE("[property] each set has its own name") {
  CHECK(std::string(name(InstructionSet::kBaseline)) == "baseline");
  CHECK(std::string(name(InstructionSet::kAvx2)) == "avx2");
  CHECK(std::string(name(InstructionSet::kAvx512)) == "avx512");
}

}  // namespace
}  // namespace condyle::contact
