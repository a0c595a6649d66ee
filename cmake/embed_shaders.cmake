# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors

# cmake -DFOLDER=... -DNAMESPACE=... -DHEADER=... -DINCLUDE=... -DOUT=... -P embed_shaders.cmake
# Writes a C++ source that includes the header as INCLUDE and defines each shader FOLDER/GROUP/NAME.glsl whose NAME the
# header declares as a string_view. A line #include "GROUP/NAME.glsl" is replaced by that file.
cmake_minimum_required(VERSION 3.25)

# Semicolons and brackets are special in CMake's lists, so lines are found by their position.
function(expand file depth result)
  if(depth GREATER 8)
    message(FATAL_ERROR "${file}: shaders include each other in a circle")
  endif()
  file(READ ${FOLDER}/${file} rest)
  set(text "")
  while(rest MATCHES "#include \"([^\"\n]+)\"\n")
    set(line "${CMAKE_MATCH_0}")
    set(included "${CMAKE_MATCH_1}")
    if(NOT EXISTS ${FOLDER}/${included})
      message(FATAL_ERROR "${FOLDER}/${file}: includes ${included}, which is not in ${FOLDER}")
    endif()
    string(FIND "${rest}" "${line}" at)
    string(LENGTH "${line}" length)
    string(SUBSTRING "${rest}" 0 ${at} before)
    math(EXPR at "${at} + ${length}")
    string(SUBSTRING "${rest}" ${at} -1 rest)
    math(EXPR deeper "${depth} + 1")
    expand(${included} ${deeper} text_of_included)
    string(APPEND text "${before}${text_of_included}")
  endwhile()
  set(${result} "${text}${rest}" PARENT_SCOPE)
endfunction()

file(READ ${HEADER} declared)
file(GLOB shaders RELATIVE ${FOLDER} ${FOLDER}/*/*.glsl)
set(source "// Made from ${FOLDER}\n#include \"${INCLUDE}\"\n\nnamespace ${NAMESPACE} {\n")
foreach(shader ${shaders})
  get_filename_component(name ${shader} NAME_WE)
  if(declared MATCHES "string_view ${name};")
    expand(${shader} 0 text)
    string(APPEND source "constinit const std::string_view ${name} = R\"glsl(${text})glsl\";\n")
  endif()
endforeach()
string(APPEND source "}  // namespace ${NAMESPACE}\n")
file(WRITE ${OUT} "${source}")
