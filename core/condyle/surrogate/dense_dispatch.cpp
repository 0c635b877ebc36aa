// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>

#include "condyle/surrogate/dense_kernels.hpp"

namespace condyle::surrogate {

namespace dense {
extern const DenseKernels kernels_baseline;
#if defined(CONDYLE_X86_KERNELS)
extern const DenseKernels kernels_avx2;
extern const DenseKernels kernels_avx512;
#endif
}  // namespace dense

namespace {

struct Available {
  std::array<DenseKernels, 3> kernels{};
  std::size_t count = 0;

  Available() {
#if defined(CONDYLE_X86_KERNELS)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq")) {
      kernels[count++] = dense::kernels_avx512;
    }
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      kernels[count++] = dense::kernels_avx2;
    }
#endif
    kernels[count++] = dense::kernels_baseline;
  }
};

const Available& available() {
  static const Available found;
  return found;
}

}  // namespace

const DenseKernels& dense_kernels() { return available().kernels.front(); }

std::span<const DenseKernels> all_dense_kernels() {
  return std::span(available().kernels).first(available().count);
}

}  // namespace condyle::surrogate
