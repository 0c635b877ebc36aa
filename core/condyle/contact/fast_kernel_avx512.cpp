// SPDX-License-Identifier: Apache-2.0
// The fast contact's kernel for AVX-512; compiled with that instruction set's flags, called only
// where the machine has it.
#if !defined(__AVX512F__) || !defined(__AVX512VL__) || !defined(__FMA__)
#error "this file needs the flags that CMakeLists.txt gives it"
#endif
#define CONDYLE_FAST_KERNEL kernel_avx512
#include "condyle/contact/fast_kernel_body.hpp"
