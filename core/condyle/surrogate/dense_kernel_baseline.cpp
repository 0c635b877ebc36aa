// SPDX-License-Identifier: Apache-2.0
// The dense layers' kernels for every machine of the architecture.
#define CONDYLE_DENSE_KERNELS kernels_baseline
#define CONDYLE_DENSE_INSTRUCTION_SET "baseline"
#include "condyle/surrogate/dense_kernel_body.hpp"
