# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors

# Debian packages, one per component, built by `cpack` in the build folder or by deploy/package.sh. dpkg-shlibdeps finds
# linked libraries; those that a program loads or runs are listed below.
set(ETI_PACKAGE_CONTACT "The NeoETI authors <neoeti@localhost>" CACHE STRING "Maintainer named in Debian packages")
set(debian ${PROJECT_SOURCE_DIR}/deploy/debian)

set(packages data server client devices tools doc demo)
if(NOT ETI_CLIENT)
  list(REMOVE_ITEM packages client demo)  # the demo draws
endif()

# data: read by several of the other packages
install(DIRECTORY deploy/data/ DESTINATION share/neoeti COMPONENT data)
install(FILES deploy/security/make_lab.py deploy/security/make_network.py deploy/security/roles.py DESTINATION share/neoeti/security COMPONENT data)

# Services, their settings, and the user account that they run under
install(FILES deploy/systemd/neoeti.sysusers DESTINATION lib/sysusers.d RENAME neoeti.conf COMPONENT data)
function(eti_services component)
  foreach(service ${ARGN})
    install(FILES deploy/systemd/eti-${service}@.service DESTINATION lib/systemd/system COMPONENT ${component})
    install(FILES deploy/systemd/conf.d/${service}.conf DESTINATION /etc/neoeti/conf.d COMPONENT ${component})
    list(APPEND settings "/etc/neoeti/conf.d/${service}.conf\n")
  endforeach()
  file(WRITE ${CMAKE_BINARY_DIR}/package/${component}/conffiles ${settings})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA ${debian}/services/postinst ${debian}/services/prerm
      ${CMAKE_BINARY_DIR}/package/${component}/conffiles PARENT_SCOPE)
endfunction()
eti_services(server server)
eti_services(devices haptics tracker)
set(CPACK_DEBIAN_DATA_PACKAGE_CONTROL_EXTRA ${debian}/data/postinst)

# doc
install(DIRECTORY docs DESTINATION share/doc/neoeti-doc COMPONENT doc FILES_MATCHING
        PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg" PATTERN "*.csv")
install(FILES README.md CONTRIBUTING.md DESTINATION share/doc/neoeti-doc COMPONENT doc)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/package)
file(CREATE_LINK /usr/share/common-licenses/Apache-2.0 ${CMAKE_BINARY_DIR}/package/LICENSE SYMBOLIC)
install(FILES ${CMAKE_BINARY_DIR}/package/LICENSE DESTINATION share/doc/neoeti-doc COMPONENT doc)

# demo: runs a program of each
install(PROGRAMS ${debian}/eti-demo DESTINATION bin COMPONENT demo)
install(PROGRAMS deploy/session_run.py DESTINATION share/neoeti COMPONENT demo)

# Debian requires a compressed changelog; -n keeps it reproducible from run to run.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${debian}/changelog)
execute_process(COMMAND gzip -9nc ${debian}/changelog OUTPUT_FILE ${CMAKE_BINARY_DIR}/package/changelog.gz)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME neoeti)
set(CPACK_PACKAGE_CONTACT ${ETI_PACKAGE_CONTACT})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL ${packages})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# eti_package(COMPONENT SUMMARY [ANY] [DEPENDS text] [RECOMMENDS text] [SUGGESTS text]). ANY: has compiled programs.
macro(eti_package component summary)
  cmake_parse_arguments(PACKAGE "ANY" "DEPENDS;RECOMMENDS;SUGGESTS" "" ${ARGN})
  string(TOUPPER ${component} upper)
  set(name neoeti-${component})
  if(${component} STREQUAL demo)
    set(name neoeti)
  endif()
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\nNeoETI simulates the intubation of a newborn: soft tissue, what the \
hand\nfeels, and how the attempt is measured. Its processes meet over DDS.\nIt is not a medical device and does not \
certify skill.")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${PACKAGE_DEPENDS}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS "${PACKAGE_RECOMMENDS}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_SUGGESTS "${PACKAGE_SUGGESTS}")
  if(PACKAGE_ANY)
    set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS ON)
  else()
    set(CPACK_DEBIAN_${upper}_PACKAGE_ARCHITECTURE all)
  endif()
  install(FILES ${debian}/copyright ${CMAKE_BINARY_DIR}/package/changelog.gz
          DESTINATION share/doc/${name} COMPONENT ${component})
endmacro()

# Packages of two releases of Debian differ in their libraries, so also in their version: an upgrade of the system then
# upgrades them. On other systems the version has no suffix.
cmake_host_system_information(RESULT distribution QUERY DISTRIB_ID DISTRIB_VERSION_ID)
set(CPACK_DEBIAN_PACKAGE_VERSION ${PROJECT_VERSION})
if(distribution MATCHES "^debian;([0-9]+)$")
  string(APPEND CPACK_DEBIAN_PACKAGE_VERSION "+deb${CMAKE_MATCH_1}")
endif()

set(ours "(= ${CPACK_DEBIAN_PACKAGE_VERSION})")
eti_package(data "scenarios, operators and profiles of the newborn-intubation simulator"
            DEPENDS "systemd-standalone-sysusers | systemd-sysusers" RECOMMENDS "openssl, python3")
eti_package(server "physics server of the newborn-intubation simulator" ANY
            DEPENDS "neoeti-data ${ours}" RECOMMENDS fastdds-tools SUGGESTS neoeti-doc)
# Epoxy loads EGL and GL, which load Mesa's drivers.
eti_package(client "trainee's and observer's views of the newborn-intubation simulator" ANY
            DEPENDS "neoeti-data ${ours}, libegl1, libgl1, libopengl0, libgl1-mesa-dri"
            RECOMMENDS "fastdds-tools, fonts-dejavu-core" SUGGESTS neoeti-doc)
# Drivers of 6-DOF mice and pads load their libraries when such a device is requested.
eti_package(devices "haptic loop, trackers and calibration of the newborn-intubation simulator" ANY
            DEPENDS "neoeti-data ${ours}" RECOMMENDS "fastdds-tools, libspnav0" SUGGESTS "neoeti-doc, spacenavd")
eti_package(tools "models, recorded sessions and benchmarks of the newborn-intubation simulator" ANY
            DEPENDS "neoeti-data ${ours}" SUGGESTS neoeti-doc)
eti_package(doc "documentation of the newborn-intubation simulator")
eti_package(demo "newborn-intubation simulator, all of it, with a demo"
            DEPENDS "neoeti-server ${ours}, neoeti-client ${ours}, neoeti-devices ${ours}, neoeti-tools ${ours}, \
neoeti-data ${ours}, python3" RECOMMENDS neoeti-doc)
include(CPack)
