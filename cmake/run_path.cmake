# SPDX-License-Identifier: Apache-2.0
# Where programs look for shared libraries: beside themselves, in the build tree as when installed, and nowhere else. No
# empty or relative element (it means the current folder, where anybody may lay a library), no path into the build tree
# in what is installed. So the run path is never changed at installation, and CMake has nothing to pad.
#
#   build tree         build/PRESET/rds, build/PRESET/lib/rds/openvino -> build/deps/openvino/openvino
#   installed          PREFIX/bin/rds, PREFIX/LIBDIR/rds/openvino

set(CMAKE_SKIP_BUILD_RPATH OFF)
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
set(CMAKE_INSTALL_RPATH "")
file(RELATIVE_PATH rds_lib_from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
if(RDS_OPENVINO_FROM_WHEEL)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/lib/rds)
  file(CREATE_LINK ${RDS_OPENVINO_ROOT}/openvino ${PROJECT_BINARY_DIR}/lib/rds/openvino SYMBOLIC)
  set(CMAKE_INSTALL_RPATH $ORIGIN/lib/rds/openvino/libs $ORIGIN/${rds_lib_from_bin}/rds/openvino/libs)
elseif(RDS_WITH_OPENVINO)
  set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)  # wherever its owner put it
endif()
if(BUILD_SHARED_LIBS)
  list(APPEND CMAKE_INSTALL_RPATH $ORIGIN $ORIGIN/${rds_lib_from_bin} $ORIGIN/rds/openvino/libs)
endif()
