# SPDX-License-Identifier: Apache-2.0
# One place for compile flags: link `condyle_flags` PRIVATE.
add_library(condyle_flags INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  target_compile_options(condyle_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
  # Contraction off: the compiler would fuse a*b+c where the target has FMA and not elsewhere, and results would depend on
  # the machine and on inlining. Kernels that want FMA ask for it by name.
  target_compile_options(condyle_flags INTERFACE -ffp-contract=off)
  # g++ 12 sees overlapping copies where a string is added to a temporary one (GCC bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(condyle_flags INTERFACE -Wno-restrict)
  endif()
  if(CONDYLE_WERROR)
    target_compile_options(condyle_flags INTERFACE -Werror)
  endif()
endif()
