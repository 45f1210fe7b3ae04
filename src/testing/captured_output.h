// SPDX-License-Identifier: Apache-2.0
// What code under test prints.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace rds {

// What `run` prints on standard output. Standard error is swallowed; what `run` throws is thrown.
template <typename Function>
std::string OutputOf(Function&& run) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  try {
    run();
  } catch (...) {
    ::testing::internal::GetCapturedStdout();
    ::testing::internal::GetCapturedStderr();
    throw;
  }
  ::testing::internal::GetCapturedStderr();
  return ::testing::internal::GetCapturedStdout();
}

}  // namespace rds
