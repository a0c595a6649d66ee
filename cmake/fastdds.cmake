# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors

# Fast DDS 3, or 2.9 to 2.14, which are named fastrtps. Sets ETI_DDS_LIBRARIES and ETI_FASTDDS, the major version. For the sources, common/bus/fastdds
# hides the differences; for the generated ones, idl/CMakeLists.txt.
find_package(fastcdr REQUIRED)
find_package(fastdds 3 QUIET)
if(fastdds_FOUND)
  set(ETI_FASTDDS 3)
  set(ETI_DDS_LIBRARIES fastdds fastcdr)
  message(STATUS "Fast DDS ${fastdds_VERSION}, Fast CDR ${fastcdr_VERSION}")
else()
  find_package(fastrtps 2.9 QUIET)
  if(NOT fastrtps_FOUND)
    message(FATAL_ERROR "Fast DDS was not found: neither the CMake package fastdds, version 3, nor fastrtps, version 2.9 "
                        "or later. Remedy: deploy/setup.sh installs it; or give -DCMAKE_PREFIX_PATH=FOLDER of another one.")
  endif()
  set(ETI_FASTDDS 2)
  set(ETI_DDS_LIBRARIES fastrtps fastcdr)
  message(STATUS "Fast DDS ${fastrtps_VERSION}, Fast CDR ${fastcdr_VERSION}")
endif()
