# SPDX-License-Identifier: Apache-2.0
# find_package(condyle) gives the target condyle::condyle: libcondyle.so and its header.
include("${CMAKE_CURRENT_LIST_DIR}/condyle-targets.cmake")
