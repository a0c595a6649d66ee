# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors

# eti_writable(RESULT FOLDER): whether a user's cache is writable; creates it if it is missing.
function(eti_writable result folder)
  execute_process(COMMAND ${CMAKE_COMMAND} -E make_directory "${folder}" OUTPUT_QUIET ERROR_QUIET)
  execute_process(COMMAND test -w "${folder}" RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(status EQUAL 0)
    set(${result} ON PARENT_SCOPE)
  else()
    set(${result} OFF PARENT_SCOPE)
  endif()
endfunction()

# Compilers run through ccache if it is installed. A second checkout reuses the results of the first: paths below the
# checkout do not count. If the user's cache is not writable (a read-only home), it lies in build/ccache.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CCACHE_SETTINGS CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1)
  execute_process(COMMAND ${CCACHE} --get-config cache_dir OUTPUT_VARIABLE cache OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  eti_writable(writable "${cache}")
  if(NOT writable)
    list(APPEND CCACHE_SETTINGS CCACHE_DIR=${PROJECT_SOURCE_DIR}/build/ccache)
  endif()
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env ${CCACHE_SETTINGS} ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_C_COMPILER_LAUNCHER})
endif()
