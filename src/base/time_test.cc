// SPDX-License-Identifier: Apache-2.0
#include "base/time.h"

#include <gtest/gtest.h>

#include <thread>

namespace rds {
namespace {

TEST(Time, SleepTakesWallTimeButNoCpuTime) {
  const Stopwatch stopwatch;
  const double cpu_start_s = ThreadCpuSeconds();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_GE(stopwatch.Milliseconds(), 20);
  EXPECT_LT(ThreadCpuSeconds() - cpu_start_s, 0.015);
}

TEST(Time, WorkTakesCpuTime) {
  const double thread_start_s = ThreadCpuSeconds();
  const double process_start_s = ProcessCpuSeconds();
  volatile double sum = 0;
  for (int i = 0; i < 1000000; ++i) {
    sum = sum + i;
  }
  EXPECT_GT(ThreadCpuSeconds(), thread_start_s);
  EXPECT_GT(ProcessCpuSeconds(), process_start_s);
}

}  // namespace
}  // namespace rds
