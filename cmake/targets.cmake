# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors

# Compile options shared by every target of ours. Floating-point contraction is off: the same source
# then gives the same bits whether or not the compiler finds a fused multiply-add.
add_library(eti_options INTERFACE)
target_compile_options(eti_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Wno-sign-conversion
                                             -ffp-contract=off)
if(ETI_WERROR)
  target_compile_options(eti_options INTERFACE -Werror)
endif()
target_include_directories(eti_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(eti_options INTERFACE ETI_VERSION="${PROJECT_VERSION}" SPDLOG_FMT_EXTERNAL)
if(ETI_SANITIZE)
  target_compile_options(eti_options INTERFACE -fsanitize=${ETI_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(eti_options INTERFACE -fsanitize=${ETI_SANITIZE})
endif()

# A room: a static library named after its folder, e.g. eti_library(server_pbd SOURCES ... LINK ...).
function(eti_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC eti_options Eigen3::Eigen ${ARG_LINK})
endfunction()

# A program in build/<preset>/bin.
function(eti_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE eti_options ${ARG_LINK})
  target_include_directories(${name} SYSTEM PRIVATE ${CLI11_INCLUDE_DIR})
  install(TARGETS ${name} RUNTIME DESTINATION bin)
endfunction()

# A test program; every TEST becomes a ctest case.
function(eti_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE eti_options GTest::gtest GTest::gtest_main ${ARG_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
endfunction()

# Adds the rooms that a part consists of.
function(eti_rooms)
  foreach(room ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${room}/CMakeLists.txt)
      add_subdirectory(${room})
    endif()
  endforeach()
endfunction()
