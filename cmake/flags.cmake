# SPDX-License-Identifier: Apache-2.0
# Compiler flags of this project's own code; never exported to those who use the library.
add_library(rds_flags INTERFACE)
target_compile_options(rds_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -fno-omit-frame-pointer)
target_compile_options(rds_flags INTERFACE -fno-math-errno)  # nobody reads errno; with it sqrt is no vector code
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(rds_flags INTERFACE -fpch-preprocess)  # lets ccache see through precompiled headers
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms inside std::string (GCC bugs 105329, 105651); AddressSanitizer looks for the real thing.
  target_compile_options(rds_flags INTERFACE -Wno-array-bounds -Wno-restrict)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A class in a .cc file may hold types of its unnamed namespace; in a unity build the file looks like a header.
  target_compile_options(rds_flags INTERFACE -Wno-subobject-linkage)
endif()
if(RDS_WERROR)
  target_compile_options(rds_flags INTERFACE -Werror)
endif()
if(RDS_NATIVE)
  include(CheckCXXCompilerFlag)
  check_cxx_compiler_flag(-march=native RDS_HAS_MARCH_NATIVE)
  if(RDS_HAS_MARCH_NATIVE)
    target_compile_options(rds_flags INTERFACE -march=native)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      # False alarms in the compiler's own AVX-512 headers (GCC bug 105593). The tsan preset, not native, has them on.
      target_compile_options(rds_flags INTERFACE -Wno-maybe-uninitialized -Wno-uninitialized)
    endif()
  endif()
endif()
if(RDS_SANITIZE)
  target_compile_options(rds_flags INTERFACE -fsanitize=${RDS_SANITIZE} -fno-sanitize-recover=all)
  target_link_options(rds_flags INTERFACE -fsanitize=${RDS_SANITIZE})
  if(RDS_SANITIZE STREQUAL "thread" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Boost.Asio has fences, which ThreadSanitizer does not see; what they guard is behind mutexes as well.
    target_compile_options(rds_flags INTERFACE -Wno-tsan)
  endif()
endif()

find_program(RDS_LINKER NAMES mold ld.lld)
if(RDS_LINKER MATCHES "mold$" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
  add_link_options(-fuse-ld=mold)
elseif(RDS_LINKER MATCHES "lld$")
  add_link_options(-fuse-ld=lld)
endif()
