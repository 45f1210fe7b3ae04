# SPDX-License-Identifier: Apache-2.0
# One test program for each folder of src/ (FOLDER_test, label FOLDER), and the tests of the repository itself in tests/
# (label repository).
include(GoogleTest)

# One variable only: gtest_discover_tests takes a list apart. The sanitizers' options come from test.sh.
set(RDS_TEST_ENVIRONMENT "RDS_EVO_PYTHON=${PROJECT_SOURCE_DIR}/build/venv/bin/python")

add_custom_target(rds_thread_tests)  # what is worth running under ThreadSanitizer
set(pch_owner "")
foreach(folder base geometry optim feature segmentation map semantic propagation place tracking mapping loop runtime system
    io eval synth cli)
  set(folder_tests ${test_sources})
  list(FILTER folder_tests INCLUDE REGEX "/src/${folder}/")
  if(NOT folder_tests)
    continue()
  endif()
  set(program ${folder}_test)
  add_executable(${program} ${folder_tests})
  set_target_properties(${program} PROPERTIES UNITY_BUILD OFF)  # their helpers share names
  if(folder STREQUAL "cli")
    target_link_libraries(${program} PRIVATE rds_cli)
  endif()
  target_link_libraries(${program} PRIVATE $<TARGET_NAME_IF_EXISTS:rds_synth> rds_io rds_flags
    nlohmann_json::nlohmann_json ${RDS_YAML_CPP} CURL::libcurl OpenSSL::Crypto
    opencv_core opencv_imgproc opencv_imgcodecs opencv_features2d opencv_calib3d
    GTest::gmock GTest::gtest_main)
  # All test programs share one precompiled header.
  if(pch_owner AND NOT folder STREQUAL "cli")
    target_precompile_headers(${program} REUSE_FROM ${pch_owner})
  elseif(NOT pch_owner)
    target_precompile_headers(${program} PRIVATE
      <gmock/gmock.h> <gtest/gtest.h> <Eigen/Core> <Eigen/Geometry> <memory> <string> <vector>)
    set(pch_owner ${program})
  endif()
  if(RDS_SANITIZE)  # few processes: scenes are rendered once in each, which is slow there
    set(shards 1)
    if(folder STREQUAL "synth")  # long ones, on two cores
      set(shards 2)
    elseif(folder STREQUAL "system")
      set(shards 3)
      # Together: they look at the same rooms. What is in lockstep has one thread, and runs in the dev build.
      add_test(NAME system.places COMMAND ${program} "--gtest_filter=*SlamPlaces*/Threaded")
      set_tests_properties(system.places PROPERTIES LABELS system TIMEOUT 1800 ENVIRONMENT "${RDS_TEST_ENVIRONMENT}")
    endif()
    # What asks for accuracy, or for the same again in each variant, is for the dev build: its code runs here in the others.
    set(arguments "")
    if(folder STREQUAL "synth")
      set(arguments "--gtest_filter=-*/orbit:*/xyz:*/rpy:*/static:*/halfsphere:*/sitting:*/crossing:*/crowd")
    elseif(folder STREQUAL "loop")
      set(arguments "--gtest_filter=-*TenThousand*:*NotExplain*:*NotFolded*")
    elseif(folder STREQUAL "system" AND RDS_SANITIZE STREQUAL "thread")  # one thread only, in lockstep
      set(arguments "--gtest_filter=-*SlamPlaces*:*Lockstep*:*WalkTogether*:*TheMapGrows*:*TrackedAgainWithIt*:*FallFarther*")
    elseif(folder STREQUAL "system")
      set(arguments "--gtest_filter=-*SlamPlaces*:*WalkTogether*:*NeedsNoName*:*FallFarther*")
    endif()
    foreach(shard RANGE 1 ${shards})
      math(EXPR index "${shard} - 1")
      add_test(NAME ${folder}.${shard} COMMAND ${program} ${arguments})
      set_tests_properties(${folder}.${shard} PROPERTIES LABELS ${folder} TIMEOUT 1800
        ENVIRONMENT "${RDS_TEST_ENVIRONMENT};GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${index}")
    endforeach()
  else()
    gtest_discover_tests(${program} TEST_PREFIX "${folder}." DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
      PROPERTIES LABELS ${folder} TIMEOUT 600 ENVIRONMENT "${RDS_TEST_ENVIRONMENT}")
  endif()
  if(folder MATCHES "^(runtime|segmentation|semantic|system)$")
    add_dependencies(rds_thread_tests ${program})
  endif()
endforeach()

# What tests/fuzz/fuzz.py feeds broken input to.
add_executable(fuzz_driver ${PROJECT_SOURCE_DIR}/tests/fuzz/fuzz_driver.cc)
target_link_libraries(fuzz_driver PRIVATE rds_io rds_flags)

# rds_add_repository_test(NAME COMMAND...): exit code 77 says that it was skipped.
function(rds_add_repository_test name)
  add_test(NAME repository.${name} COMMAND ${ARGN})
  set_tests_properties(repository.${name} PROPERTIES LABELS repository SKIP_RETURN_CODE 77 TIMEOUT 600)
endfunction()

find_package(Python3 3.8 REQUIRED COMPONENTS Interpreter)
if(RDS_SANITIZE MATCHES "address" AND TARGET rds_program)
  add_test(NAME repository.fuzz COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/fuzz/fuzz.py $<TARGET_FILE:fuzz_driver> $<TARGET_FILE:rds_program>
    --keep ${PROJECT_BINARY_DIR}/fuzz_failures)
  set_tests_properties(repository.fuzz PROPERTIES LABELS repository SKIP_RETURN_CODE 77 TIMEOUT 900 RUN_SERIAL ON)
endif()
if(NOT RDS_SANITIZE)
  rds_add_repository_test(layering ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/layering_test.py)
  rds_add_repository_test(test_summary ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/summarize_tests_test.py)
  rds_add_repository_test(scripts ${PROJECT_SOURCE_DIR}/tests/scripts_test.sh)
  rds_add_repository_test(processor ${PROJECT_SOURCE_DIR}/tests/processor_test.sh ${CMAKE_CXX_COMPILER})
  if(TARGET rds_program)
    rds_add_repository_test(run_path ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/run_path_test.py
      ${PROJECT_BINARY_DIR})
    foreach(test input signals disk)
      rds_add_repository_test(faults_${test} ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/faults_test.py
        $<TARGET_FILE:rds_program> ${test})
    endforeach()
    rds_add_repository_test(fetch ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/fetch_test.py $<TARGET_FILE:rds_program>)
    rds_add_repository_test(evaluate ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/evaluate_test.py
      $<TARGET_FILE:rds_program>)
    foreach(test serve kserve)
      rds_add_repository_test(remote_${test} ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/remote_test.py
        $<TARGET_FILE:rds_program>
        ${PROJECT_SOURCE_DIR}/build/venv-kserve/bin/python ${test})
    endforeach()
    foreach(test make static walking lockstep threaded turning desk kidnap)
      set(name repository.kitchen_${test})
      add_test(NAME ${name} COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/kitchen_test.py
        $<TARGET_FILE:rds_program> ${PROJECT_SOURCE_DIR}/build/test-data ${test})
      set_tests_properties(${name} PROPERTIES LABELS repository SKIP_RETURN_CODE 77 TIMEOUT 900 FIXTURES_REQUIRED kitchen)
    endforeach()
    set_tests_properties(repository.kitchen_make PROPERTIES FIXTURES_REQUIRED "" FIXTURES_SETUP kitchen)
    set_tests_properties(repository.kitchen_threaded PROPERTIES RUN_SERIAL ON)  # in real time
  endif()
  rds_add_repository_test(package ${PROJECT_SOURCE_DIR}/tests/package_test.sh ${CMAKE_COMMAND} ${PROJECT_BINARY_DIR})
endif()
