# SPDX-License-Identifier: Apache-2.0
# Finds every dependency, within the versions this project is tested with, and names all that is missing at once.
# Lower bounds are those of Ubuntu 22.04, upper bounds the next version that may break the interface.

set(rds_missing "")

# rds_find(NAME MINIMUM BEFORE [arguments of find_package]): MINIMUM <= version < BEFORE.
macro(rds_find name minimum before)
  find_package(${name} ${ARGN} QUIET)
  string(TOUPPER ${name} rds_upper)
  set(rds_version "")
  foreach(variable ${name}_VERSION ${rds_upper}_VERSION ${rds_upper}_VERSION_STRING)
    if(NOT rds_version AND ${variable})
      set(rds_version "${${variable}}")
    endif()
  endforeach()
  if(NOT ${name}_FOUND AND NOT ${rds_upper}_FOUND)
    list(APPEND rds_missing "${name} (>= ${minimum}, < ${before}): not found")
  elseif(rds_version VERSION_LESS "${minimum}" OR NOT rds_version VERSION_LESS "${before}")
    list(APPEND rds_missing "${name} (>= ${minimum}, < ${before}): found ${rds_version}")
  else()
    message(STATUS "${name} ${rds_version}")
  endif()
endmacro()

set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)
rds_find(Eigen3 3.4 4 NO_MODULE)
rds_find(OpenCV 4.5 5 COMPONENTS core imgproc imgcodecs features2d calib3d videoio)
rds_find(yaml-cpp 0.7 0.9)
rds_find(nlohmann_json 3.10 4)
rds_find(spdlog 1.9 2)
rds_find(CLI11 2.1 3)
rds_find(CURL 7.81 9)
rds_find(OpenSSL 3.0 4 COMPONENTS Crypto)
rds_find(Boost 1.74 2)  # headers only
rds_find(LibArchive 3.4 4)
if(RDS_TESTS)
  rds_find(GTest 1.11 2)
endif()

if(rds_missing)
  list(JOIN rds_missing "\n    " rds_missing)
  message(FATAL_ERROR "Missing dependencies:\n    ${rds_missing}\n"
    "  On Debian and Ubuntu run scripts/install_dependencies.sh; it names the packages where it cannot install them.")
endif()

# yaml-cpp renamed its target in 0.8.
if(TARGET yaml-cpp::yaml-cpp)
  set(RDS_YAML_CPP yaml-cpp::yaml-cpp)
else()
  set(RDS_YAML_CPP yaml-cpp)
endif()
