// SPDX-License-Identifier: Apache-2.0
// The fast contact's kernel for the instruction set that every machine of the target has (SSE2 on
// x86-64).
#define CONDYLE_FAST_KERNEL kernel_baseline
#include "condyle/contact/fast_kernel_body.hpp"
