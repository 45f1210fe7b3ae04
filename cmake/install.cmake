# SPDX-License-Identifier: Apache-2.0
# `cmake --install`: the libraries with the headers that their public API needs, a CMake package, the program, the
# camera files.
include(CMakePackageConfigHelpers)

# The public API: these headers and all that they include.
set(RDS_PUBLIC_HEADERS system/slam.h segmentation/mask.h base/error.h base/log.h  # rds::rds
  segmentation/segmenter_factory.h)  # rds::io

# rds_add_headers(LIST HEADER): adds HEADER (relative to src/) and, recursively, what it includes, to LIST.
function(rds_add_headers list header)
  set(result ${${list}})
  if(NOT header IN_LIST result)
    list(APPEND result ${header})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${header})
    file(STRINGS ${PROJECT_SOURCE_DIR}/src/${header} includes REGEX "^#include \"")
    foreach(include ${includes})
      string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" include "${include}")
      rds_add_headers(result ${include})
    endforeach()
  endif()
  set(${list} ${result} PARENT_SCOPE)
endfunction()

set(headers "")
foreach(header ${RDS_PUBLIC_HEADERS})
  rds_add_headers(headers ${header})
endforeach()
foreach(header ${headers})
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES src/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rds/${folder} COMPONENT development)
endforeach()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rds)
install(TARGETS rds_core rds_io EXPORT rds ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(EXPORT rds NAMESPACE rds:: FILE rdsTargets.cmake DESTINATION ${package_dir} COMPONENT development)
if(RDS_OPENVINO_FROM_WHEEL)
  set(RDS_OPENVINO_CMAKE ${CMAKE_INSTALL_LIBDIR}/rds/openvino/cmake)
else()
  set(RDS_OPENVINO_CMAKE "${OpenVINO_DIR}")
endif()
configure_package_config_file(cmake/rdsConfig.cmake.in ${PROJECT_BINARY_DIR}/package/rdsConfig.cmake
  INSTALL_DESTINATION ${package_dir} PATH_VARS RDS_OPENVINO_CMAKE)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/rdsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/rdsConfig.cmake ${PROJECT_BINARY_DIR}/package/rdsConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT development)

if(TARGET rds_program)
  install(TARGETS rds_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
if(RDS_OPENVINO_FROM_WHEEL)  # what the program needs lies beside it; the headers stay behind
  install(DIRECTORY ${RDS_OPENVINO_ROOT}/openvino/libs DESTINATION ${CMAKE_INSTALL_LIBDIR}/rds/openvino COMPONENT program)
  install(DIRECTORY ${RDS_OPENVINO_ROOT}/openvino/cmake DESTINATION ${CMAKE_INSTALL_LIBDIR}/rds/openvino
    COMPONENT development)
  install(DIRECTORY DESTINATION ${CMAKE_INSTALL_LIBDIR}/rds/openvino/include COMPONENT development)
  file(GLOB rds_openvino_licenses ${RDS_OPENVINO_ROOT}/openvino-*.dist-info/licenses)
  install(DIRECTORY ${rds_openvino_licenses} DESTINATION ${CMAKE_INSTALL_DOCDIR}/openvino COMPONENT program)
endif()
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rds/config COMPONENT program FILES_MATCHING PATTERN "*.yaml")
install(FILES LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program OPTIONAL)
