// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/fast_dispatch.hpp"

#include <stdexcept>
#include <string>

namespace condyle::contact {
namespace {

// Null where the build has no such version or the machine cannot run it.
fast::Kernel runnable(InstructionSet set) {
  switch (set) {
    case InstructionSet::kBaseline:
      return &fast::kernel_baseline;
#if defined(CONDYLE_X86_KERNELS)
    case InstructionSet::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &fast::kernel_avx2
                                                                             : nullptr;
    case InstructionSet::kAvx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                     __builtin_cpu_supports("avx512dq")
                 ? &fast::kernel_avx512
                 : nullptr;
#endif
    default:
      return nullptr;
  }
}

}  // namespace

const char* name(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
    default:
      return "baseline";
  }
}

InstructionSet best_instruction_set() {
  for (const InstructionSet set : {InstructionSet::kAvx512, InstructionSet::kAvx2}) {
    if (runnable(set) != nullptr) return set;
  }
  return InstructionSet::kBaseline;
}

namespace fast {

Kernel kernel_for(InstructionSet set) {
  const Kernel kernel = runnable(set);
  if (kernel == nullptr) {
    throw std::invalid_argument("instruction set " + std::string(name(set)) +
                                ": not available on this machine or in this build");
  }
  return kernel;
}

}  // namespace fast
}  // namespace condyle::contact
