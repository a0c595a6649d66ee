# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors

# Bundles the report's page into one file, ETI_REPORT_PAGE. Its packages are fetched once, while configuring, and asked
# for again only when the lock file changes. Without npm or a network all else builds, and `eti-review report` says what
# is missing.
set(page ${CMAKE_CURRENT_SOURCE_DIR}/page)
set(page_build ${CMAKE_CURRENT_BINARY_DIR}/page)
find_program(ETI_NODE node)
find_program(ETI_NPM npm)
mark_as_advanced(ETI_NODE ETI_NPM)
set(ETI_REPORT_PAGE "")

if(ETI_NODE AND ETI_NPM)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${page}/package-lock.json)
  file(SHA256 ${page}/package-lock.json wanted)
  set(fetched "")
  if(EXISTS ${page_build}/fetched)
    file(READ ${page_build}/fetched fetched)
  endif()
  if(NOT fetched STREQUAL wanted)
    message(STATUS "Fetching the packages of the report's page")
    file(MAKE_DIRECTORY ${page_build})
    foreach(name package.json package-lock.json .npmrc)
      file(COPY_FILE ${page}/${name} ${page_build}/${name})
    endforeach()
    execute_process(COMMAND ${ETI_NPM} ci --ignore-scripts --prefer-offline WORKING_DIRECTORY ${page_build} TIMEOUT 300
                    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE why)
    if(failed)
      message(STATUS "npm ci failed (${failed}): ${why}")
    else()
      file(WRITE ${page_build}/fetched ${wanted})
      set(fetched ${wanted})
    endif()
  endif()
  if(fetched STREQUAL wanted)
    set(ETI_REPORT_PAGE ${page_build}/page.html)
    set(sources bundle.mjs page.html style.css main.js element.js summary.js timeline.js anatomy.js recording.js viewer.js)
    list(TRANSFORM sources PREPEND ${page}/)
    add_custom_command(OUTPUT ${ETI_REPORT_PAGE} DEPENDS ${sources} ${page_build}/fetched
                       COMMAND ${ETI_NODE} ${page}/bundle.mjs ${page_build} ${ETI_REPORT_PAGE}
                       COMMENT "Bundling the report's page" VERBATIM)
  endif()
endif()
if(NOT ETI_REPORT_PAGE)
  message(STATUS "eti-review report is built without its page: it needs npm and, once, its packages")
endif()
