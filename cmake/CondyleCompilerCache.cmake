# SPDX-License-Identifier: Apache-2.0
# CGAL takes tens of seconds a file on two cores; ccache, where there is one, makes every later build cheap.
find_program(CONDYLE_CCACHE ccache)
if(CONDYLE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CONDYLE_CCACHE}")
endif()
