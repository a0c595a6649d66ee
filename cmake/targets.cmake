# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors

# Compile options of all our targets. Floating-point contraction is off: the same source then gives the same bits
# whether or not the compiler can use a fused multiply-add.
add_library(eti_options INTERFACE)
target_compile_options(eti_options INTERFACE -Wall -Wextra -Wconversion -Wno-sign-conversion -ffp-contract=off)
# In a unity build a local name may equal a constant of another file, and GCC accepts members of a type from an
# anonymous namespace only in the main file.
if(NOT ETI_UNITY)
  target_compile_options(eti_options INTERFACE -Wshadow)
elseif(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(eti_options INTERFACE -Wshadow=local -Wno-subobject-linkage)
endif()
if(ETI_WERROR)
  target_compile_options(eti_options INTERFACE -Werror)
endif()
target_include_directories(eti_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(eti_options INTERFACE ETI_VERSION="${PROJECT_VERSION}" SPDLOG_FMT_EXTERNAL)
if(ETI_SANITIZE)
  target_compile_options(eti_options INTERFACE -fsanitize=${ETI_SANITIZE} -fno-omit-frame-pointer
                                               -fno-sanitize-recover=all)
  target_link_options(eti_options INTERFACE -fsanitize=${ETI_SANITIZE})
endif()

# eti_unity(TARGET BATCH): compiles a target's sources in batches of equal size, at most BATCH each. Most of a source's
# compile time goes into its headers; a larger batch saves little more and takes over 1.4 GB of memory. A source with
# compile options or definitions of its own is compiled separately, as is one whose SKIP_UNITY_BUILD_INCLUSION is set.
function(eti_unity target batch)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources EXCLUDE REGEX "/allocations\\.cpp$")  # compiled separately, see eti_test()
  list(LENGTH sources count)
  if(ETI_UNITY AND count GREATER 1)
    math(EXPR batches "(${count} + ${batch} - 1) / ${batch}")
    math(EXPR size "(${count} + ${batches} - 1) / ${batches}")
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
  endif()
endfunction()

add_custom_target(programs COMMENT "Every eti-* program that a session needs")
add_custom_target(unit_tests COMMENT "Every test program under tests/unit")

# A room: a static library named after its folder, e.g. eti_library(server_pbd SOURCES ... LINK ...).
function(eti_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC eti_options Eigen3::Eigen ${ARG_LINK})
  eti_unity(${name} 10)
endfunction()

# A program in build/<preset>/bin. ASIDE: no session needs it, so it is not part of `programs`. PACKAGE: its Debian
# package, see cmake/package.cmake; `none` for programs that run scripts of this tree.
function(eti_program name)
  cmake_parse_arguments(ARG "ASIDE" "PACKAGE" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE eti_options ${ARG_LINK})
  eti_unity(${name} 10)
  if(NOT ARG_ASIDE)
    add_dependencies(programs ${name})
  endif()
  if(NOT ARG_PACKAGE)
    set(ARG_PACKAGE tools)
  endif()
  # Programs outside `programs` may be absent when the others are installed.
  if(ARG_ASIDE)
    set(optional OPTIONAL)
  endif()
  if(NOT ARG_PACKAGE STREQUAL none)
    install(TARGETS ${name} RUNTIME DESTINATION bin COMPONENT ${ARG_PACKAGE} ${optional})
  endif()
endfunction()

# The first folder below tests/ that contains the current folder: the label of its ctest cases.
function(eti_test_label result)
  file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR})
  string(REGEX REPLACE "/.*" "" label "${path}")
  set(${result} ${label} PARENT_SCOPE)
endfunction()

# A test program; every suite becomes a ctest case PROGRAM.SUITE. A suite whose name begins with Whole is also labelled
# long: deploy/test.sh runs it only with --whole. One case per suite creates shared data, such as a newborn that takes
# seconds to build, only once. Under a sanitizer, where that takes a minute, the whole program is one case.
function(eti_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE eti_options GTest::gtest GTest::gtest_main ${ARG_LINK})
  # Replaces operator new, which the compiler must not see together with its uses.
  set_source_files_properties(${PROJECT_SOURCE_DIR}/tests/support/allocations.cpp
                              PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  eti_unity(${name} 12)
  # A test's own code takes no time; compiling it does, a fifth less so. After -O3: the last option counts.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  eti_test_label(label)
  if(label STREQUAL unit)
    add_dependencies(unit_tests ${name})
  endif()
  if(ETI_SANITIZE)
    add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
    set_tests_properties(${name} PROPERTIES TIMEOUT 10800 LABELS ${label})
  else()
    set(found ${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake)
    set_property(TARGET ${name} APPEND PROPERTY LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/discover_suites.cmake)
    add_custom_command(TARGET ${name} POST_BUILD VERBATIM BYPRODUCTS ${found}
      COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${name}> -DNAME=${name} -DLABEL=${label} -DOUT=${found}
              -P ${PROJECT_SOURCE_DIR}/cmake/discover_suites.cmake)
    # A program that was not built appears as a case that cannot run.
    file(WRITE ${found}.include "if(EXISTS \"${found}\")\n  include(\"${found}\")\nelse()\n  add_test(${name} ${name}_NOT_BUILT)\n  set_tests_properties(${name} PROPERTIES LABELS ${label})\nendif()\n")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${found}.include)
  endif()
endfunction()

# A Python unittest file; every test method becomes a ctest case PREFIX.METHOD. Those named test_whole_... are also
# labelled long. PROPERTIES are passed to each case. Those below tests/unit are labelled scripts: they test no compiled
# code, so sanitizers have nothing to find.
function(eti_python_test prefix script)
  cmake_parse_arguments(ARG "" "TIMEOUT" "ENVIRONMENT;PROPERTIES" ${ARGN})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${script})
  file(STRINGS ${script} methods REGEX "^    def test_[a-z0-9_]+\\(")
  if(NOT methods)
    message(FATAL_ERROR "${script} has no test methods")
  endif()
  eti_test_label(label)
  string(REPLACE unit scripts label ${label})
  foreach(line ${methods})
    string(REGEX REPLACE "^    def (test_[a-z0-9_]+).*" "\\1" method "${line}")
    string(REGEX REPLACE "^test_" "" short "${method}")
    add_test(NAME ${prefix}.${short}
             COMMAND ${ETI_PYTHON} -B ${CMAKE_CURRENT_SOURCE_DIR}/${script} -v -k *.${method})
    set(labels ${label})
    if(short MATCHES "^whole_")
      list(APPEND labels long)
    endif()
    set_tests_properties(${prefix}.${short} PROPERTIES LABELS "${labels}" TIMEOUT ${ARG_TIMEOUT}
                         SKIP_REGULAR_EXPRESSION "OK \\(skipped=" ENVIRONMENT "${ARG_ENVIRONMENT}" ${ARG_PROPERTIES})
  endforeach()
endfunction()

# Adds the rooms of a part.
function(eti_rooms)
  foreach(room ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${room}/CMakeLists.txt)
      add_subdirectory(${room})
    endif()
  endforeach()
endfunction()
