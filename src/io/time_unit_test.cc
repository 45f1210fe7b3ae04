// SPDX-License-Identifier: Apache-2.0
#include "io/time_unit.h"

#include <gtest/gtest.h>

#include <vector>

namespace rds {
namespace {

std::vector<double> Times(double first, double step, int count = 10) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    times.push_back(first + step * i);
  }
  return times;
}

TEST(GuessTimeUnit, KnowsSecondsSince1970BySize) {
  EXPECT_EQ(GuessTimeUnit(Times(1.7e9, 0.0333), false), TimeUnit::kSeconds);
  EXPECT_EQ(GuessTimeUnit(Times(1.7e12, 33), false), TimeUnit::kMilliseconds);
  EXPECT_EQ(GuessTimeUnit(Times(1.7e15, 33333), false), TimeUnit::kMicroseconds);
  EXPECT_EQ(GuessTimeUnit(Times(1.7e18, 33333333), false), TimeUnit::kNanoseconds);
  EXPECT_EQ(GuessTimeUnit(std::vector{1.7e18}, true), TimeUnit::kNanoseconds);
  EXPECT_EQ(GuessTimeUnit(Times(1e12, 33333333), false), TimeUnit::kNanoseconds) << "1000 s since the start";
  EXPECT_EQ(GuessTimeUnit(Times(1.7e12, 5000), true), TimeUnit::kMilliseconds) << "keyframes";
}

TEST(GuessTimeUnit, KnowsTheOthersByTheirStep) {
  for (const double rate_hz : {5.0, 15.0, 30.0, 90.0}) {
    EXPECT_EQ(GuessTimeUnit(Times(0, 1 / rate_hz), false), TimeUnit::kSeconds) << rate_hz;
    EXPECT_EQ(GuessTimeUnit(Times(0, 1e3 / rate_hz), false), TimeUnit::kMilliseconds) << rate_hz;
    EXPECT_EQ(GuessTimeUnit(Times(0, 1e6 / rate_hz), false), TimeUnit::kMicroseconds) << rate_hz;
    EXPECT_EQ(GuessTimeUnit(Times(0, 1e9 / rate_hz), false), TimeUnit::kNanoseconds) << rate_hz;
  }
  EXPECT_EQ(GuessTimeUnit(Times(17, 1), false), TimeUnit::kFrames);
  EXPECT_EQ(GuessTimeUnit(Times(0.5, 1), false), TimeUnit::kSeconds) << "one picture a second";
  EXPECT_EQ(GuessTimeUnit({}, false), TimeUnit::kSeconds);
}

TEST(GuessTimeUnit, PosesMayBeSecondsApart) {
  EXPECT_EQ(GuessTimeUnit(Times(0.25, 33), true), TimeUnit::kSeconds);
  EXPECT_EQ(GuessTimeUnit(Times(0, 33), true), TimeUnit::kMilliseconds);
}

TEST(SecondsIn, GoesWithTheName) {
  EXPECT_EQ(SecondsIn(TimeUnit::kNanoseconds), 1e-9);
  EXPECT_EQ(NameOf(TimeUnit::kNanoseconds), "nanoseconds");
  EXPECT_EQ(SecondsIn(TimeUnit::kFrames), 1 / kFrameNumberRate_hz);
}

}  // namespace
}  // namespace rds
