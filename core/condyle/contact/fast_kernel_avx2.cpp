// SPDX-License-Identifier: Apache-2.0
// The fast contact's kernel for AVX2+FMA; compiled with that instruction set's flags, called only
// where the machine has it.
#if !defined(__AVX2__) || !defined(__FMA__)
#error "this file needs the flags that CMakeLists.txt gives it"
#endif
#define CONDYLE_FAST_KERNEL kernel_avx2
#include "condyle/contact/fast_kernel_body.hpp"
