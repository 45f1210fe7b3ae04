// SPDX-License-Identifier: Apache-2.0
#include "cli/process_info.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

namespace rds {
namespace {

TEST(ProcessInfo, TimeSinceStartAdvances) {
  const double before_s = SecondsSinceProcessStart();
  EXPECT_GT(before_s, 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_GE(SecondsSinceProcessStart(), before_s + 0.02);
}

TEST(ProcessInfo, PeakMemoryGrowsWithUse) {
  const double before_mb = PeakMemoryMb();
  EXPECT_GT(before_mb, 1);
  const auto size = static_cast<std::size_t>((before_mb + 30) * 1e6);
  const std::vector<char> block(size, 1);
  EXPECT_GE(PeakMemoryMb(), before_mb + 20) << static_cast<int>(block.back());
}

}  // namespace
}  // namespace rds
