# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Asks a GoogleTest program for its suites and writes a file of ctest cases, one per suite. eti_test() runs it after the
# program is built, with -D: PROGRAM (path), NAME, LABEL, OUT (path of the file).
# A process forked while the linker wrote the program may hold it open for a moment (ETXTBSY).
foreach(try RANGE 20)
  execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status TIMEOUT 60)
  if(NOT status STREQUAL "Text file busy")
    break()
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 0.5)
endforeach()
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: exit status ${status}\n${listed}")
endif()
# A suite's line ends with a point, and may name a type in a trailing comment; its tests' lines are indented.
string(REGEX MATCHALL "\n[^ \n][^ \n]*\\." suites "\n${listed}")
list(REMOVE_DUPLICATES suites)
if(NOT suites)
  message(FATAL_ERROR "${PROGRAM} has no tests")
endif()
set(cases "")
foreach(suite ${suites})
  string(REGEX REPLACE "^\n|\\.$" "" suite "${suite}")
  set(labels ${LABEL})
  if(suite MATCHES "^Whole")
    list(APPEND labels long)
  endif()
  string(APPEND cases
    "add_test([==[${NAME}.${suite}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==] --gtest_brief=1)\n"
    "set_tests_properties([==[${NAME}.${suite}]==] PROPERTIES LABELS [==[${labels}]==] TIMEOUT 900)\n")
endforeach()
file(WRITE ${OUT} "${cases}")
