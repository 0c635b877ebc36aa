// SPDX-License-Identifier: Apache-2.0
// The dense layers' kernels for AVX2+FMA; called only where the machine has it.
#if !defined(__AVX2__) || !defined(__FMA__)
#error "this file needs the flags that CMakeLists.txt gives it"
#endif
#define CONDYLE_DENSE_KERNELS kernels_avx2
#define CONDYLE_DENSE_INSTRUCTION_SET "avx2"
#include "condyle/surrogate/dense_kernel_body.hpp"
