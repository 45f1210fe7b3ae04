# SPDX-License-Identifier: Apache-2.0
# Finds the OpenVINO runtime and gives `rds_add_openvino(TARGET)`. Without it TARGET is built all the same, and says what
# is missing when asked for the back end.
#
# RDS_OPENVINO: AUTO (use it where it is found), ON (it must be found), OFF. Under sanitizers AUTO means OFF: the runtime
# is not instrumented, so its own synchronization looks like races to ThreadSanitizer, and AddressSanitizer ends a
# program that loads libraries as the runtime's libtbb does (RTLD_DEEPBIND).
#
# Looked for in build/deps/openvino of the source tree, where scripts/install_openvino.sh puts it, then wherever
# find_package looks (OpenVINO_DIR, CMAKE_PREFIX_PATH, distribution packages).
#
# libtbb: the wheel brings its own libtbb.so.12, newer than the distribution's, which OpenCV is linked with. A process
# has one library of a name, so both must use one. The wheel's is named first, before OpenCV can pull in the older one;
# oneTBB keeps its binary interface, so OpenCV runs with it.

set(RDS_OPENVINO AUTO CACHE STRING "OpenVINO back end: AUTO, ON or OFF")
set_property(CACHE RDS_OPENVINO PROPERTY STRINGS AUTO ON OFF)
set(RDS_OPENVINO_ROOT ${PROJECT_SOURCE_DIR}/build/deps/openvino CACHE PATH "Where scripts/install_openvino.sh put it")
mark_as_advanced(RDS_OPENVINO_ROOT)

set(RDS_WITH_OPENVINO OFF)
set(RDS_OPENVINO_FROM_WHEEL OFF)
if(RDS_OPENVINO STREQUAL "ON" OR (RDS_OPENVINO STREQUAL "AUTO" AND NOT RDS_SANITIZE))
  if(EXISTS ${RDS_OPENVINO_ROOT}/openvino/cmake/OpenVINOConfig.cmake)
    set(TBB_DIR ${RDS_OPENVINO_ROOT}/openvino/cmake)  # its own
    find_package(OpenVINO CONFIG QUIET COMPONENTS Runtime
      PATHS ${RDS_OPENVINO_ROOT}/openvino/cmake NO_DEFAULT_PATH)
  endif()
  if(NOT OpenVINO_FOUND)
    find_package(OpenVINO CONFIG QUIET COMPONENTS Runtime)
  endif()
  if(OpenVINO_FOUND)
    set(RDS_WITH_OPENVINO ON)
    message(STATUS "OpenVINO ${OpenVINO_VERSION}: ${OpenVINO_DIR}")
    string(FIND "${OpenVINO_DIR}" "${RDS_OPENVINO_ROOT}/" rds_place)
    if(rds_place EQUAL 0)
      set(RDS_OPENVINO_FROM_WHEEL ON)
    endif()
  elseif(RDS_OPENVINO STREQUAL "ON")
    message(FATAL_ERROR "OpenVINO not found; run scripts/install_openvino.sh or set OpenVINO_DIR")
  else()
    message(STATUS "OpenVINO not found: no back end 'openvino' (scripts/install_openvino.sh installs it)")
  endif()
endif()

# Compiles the back end into TARGET and links the runtime. Call it before TARGET's other libraries are named. How
# programs find the runtime is in run_path.cmake.
function(rds_add_openvino target)
  if(NOT RDS_WITH_OPENVINO)
    return()
  endif()
  set_source_files_properties(
    ${PROJECT_SOURCE_DIR}/src/segmentation/openvino_network.cc ${PROJECT_SOURCE_DIR}/src/segmentation/openvino_segmenter.cc
    TARGET_DIRECTORY ${target} PROPERTIES COMPILE_DEFINITIONS RDS_WITH_OPENVINO SKIP_PRECOMPILE_HEADERS ON)
  if(TARGET TBB::tbb AND RDS_OPENVINO_FROM_WHEEL)
    # A direct dependency of each program, so that it is loaded before the libraries that OpenCV depends on.
    target_link_libraries(${target} PRIVATE -Wl,--push-state,--no-as-needed TBB::tbb -Wl,--pop-state)
  endif()
  target_link_libraries(${target} PRIVATE openvino::runtime)
endfunction()
