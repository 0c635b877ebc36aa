// SPDX-License-Identifier: Apache-2.0
// The dense layers' kernels for AVX-512; called only where the machine has it.
#if !defined(__AVX512F__) || !defined(__AVX512DQ__)
#error "this file needs the flags that CMakeLists.txt gives it"
#endif
#define CONDYLE_DENSE_KERNELS kernels_avx512
#define CONDYLE_DENSE_INSTRUCTION_SET "avx512"
#include "condyle/surrogate/dense_kernel_body.hpp"
