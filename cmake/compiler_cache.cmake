# SPDX-License-Identifier: Apache-2.0
# ccache, if it is there: a second build, or one in another clone, compiles only what changed.
find_program(RDS_CCACHE ccache)
if(RDS_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${RDS_CCACHE})
endif()
