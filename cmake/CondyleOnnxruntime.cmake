# SPDX-License-Identifier: Apache-2.0
# onnxruntime in two halves: the C/C++ headers at build time, the shared library at run time (opened by name, see
# core/condyle/surrogate). Nothing links against it.
#
#   CONDYLE_ONNXRUNTIME_INCLUDE  folder that holds onnxruntime_cxx_api.h
#   CONDYLE_ONNXRUNTIME_LIBRARY  a libonnxruntime.so.1.x.y to put beside condyle-sim, so that it runs without Python
#                                (optional: without it the executable looks for libonnxruntime.so.1 in the system)
find_path(CONDYLE_ONNXRUNTIME_INCLUDE onnxruntime_cxx_api.h
  HINTS "${CMAKE_SOURCE_DIR}/.cache/onnxruntime/usr/include"
  PATH_SUFFIXES onnxruntime onnxruntime/core/session
  DOC "Folder of onnxruntime_cxx_api.h (Debian: libonnxruntime-dev)")
if(NOT CONDYLE_ONNXRUNTIME_INCLUDE)
  message(FATAL_ERROR "onnxruntime_cxx_api.h not found: install libonnxruntime-dev, run ./dev.sh (which fetches the "
                      "headers), or set CONDYLE_ONNXRUNTIME_INCLUDE")
endif()

if(NOT CONDYLE_ONNXRUNTIME_LIBRARY)
  # The wheel's copy, in the interpreter that builds us or in the project's own environment.
  file(GLOB _condyle_ort
    "${Python_SITELIB}/onnxruntime/capi/libonnxruntime.so.1.*"
    "${CMAKE_SOURCE_DIR}/.venv/lib/python3*/site-packages/onnxruntime/capi/libonnxruntime.so.1.*")
  if(_condyle_ort)
    list(GET _condyle_ort 0 _condyle_ort)
    set(CONDYLE_ONNXRUNTIME_LIBRARY "${_condyle_ort}" CACHE FILEPATH "libonnxruntime.so.1.x.y put beside condyle-sim")
  endif()
endif()

add_library(condyle_onnxruntime_headers INTERFACE)
target_include_directories(condyle_onnxruntime_headers SYSTEM INTERFACE "${CONDYLE_ONNXRUNTIME_INCLUDE}")
