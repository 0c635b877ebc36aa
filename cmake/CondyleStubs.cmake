# SPDX-License-Identifier: Apache-2.0
# Run as a script: cmake -DFOLDER=<folder of .pyi files> -P CondyleStubs.cmake
# The stub generator sees the extension as `_core`, before it has a package around it; type checkers know it as condyle._core.
file(GLOB stubs "${FOLDER}/*.pyi")
foreach(stub IN LISTS stubs)
  file(READ "${stub}" text)
  string(REGEX REPLACE "(\n(from|import)) _core" "\\1 condyle._core" corrected "${text}")
  string(REGEX REPLACE "([^.a-z])_core\\." "\\1condyle._core." corrected "${corrected}")
  if(NOT corrected STREQUAL text)
    file(WRITE "${stub}" "${corrected}")
  endif()
endforeach()
