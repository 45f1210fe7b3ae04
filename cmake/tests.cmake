# One test program for each folder of src/ (FOLDER_test, label FOLDER), and the tests of the repository itself in tests/.
include(GoogleTest)

set(RDS_TEST_ENVIRONMENT
  "TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1:suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp"
  "ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1"
  "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0"
  "UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1")

set(RDS_PCH_OWNER "")
foreach(folder base geometry optim feature map semantic tracking mapping loop runtime system io eval cli testing)
  set(folder_tests ${test_sources})
  list(FILTER folder_tests INCLUDE REGEX "/src/${folder}/")
  if(NOT folder_tests)
    continue()
  endif()
  add_executable(${folder}_test ${folder_tests})
  if(folder STREQUAL "cli")
    target_link_libraries(cli_test PRIVATE rds_cli)
  endif()
  target_link_libraries(${folder}_test PRIVATE $<TARGET_NAME_IF_EXISTS:rds_testing> rds_core rds_flags Ceres::ceres nlohmann_json::nlohmann_json ${RDS_YAML_CPP}
    CURL::libcurl OpenSSL::Crypto opencv_core opencv_imgproc opencv_imgcodecs opencv_features2d opencv_calib3d
    GTest::gmock GTest::gtest_main)
  # All test programs share one precompiled header.
  if(RDS_PCH_OWNER)
    target_precompile_headers(${folder}_test REUSE_FROM ${RDS_PCH_OWNER})
  else()
    target_precompile_headers(${folder}_test PRIVATE <gmock/gmock.h> <gtest/gtest.h> <Eigen/Core> <Eigen/Geometry>)
    set(RDS_PCH_OWNER ${folder}_test)
  endif()
  gtest_discover_tests(${folder}_test TEST_PREFIX "${folder}." DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${folder} TIMEOUT 600 ENVIRONMENT "${RDS_TEST_ENVIRONMENT}")
endforeach()
