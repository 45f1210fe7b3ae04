// SPDX-License-Identifier: Apache-2.0
#include "system/confidence_watch.h"

#include <gtest/gtest.h>

namespace rds {
namespace {

int Warnings(ConfidenceWatch& watch, int frames, std::optional<double> confidence) {
  int warnings = 0;
  for (int i = 0; i < frames; ++i) {
    warnings += watch.Add(confidence, true) ? 1 : 0;
  }
  return warnings;
}

TEST(ConfidenceWatch, WarnsOnceWhereItStaysLow) {
  ConfidenceWatch watch;
  EXPECT_EQ(Warnings(watch, 100, 0.9), 0);
  EXPECT_EQ(Warnings(watch, 100, std::nullopt), 0);
  EXPECT_EQ(Warnings(watch, 10, 0.2), 0);
  EXPECT_EQ(Warnings(watch, 1, 0.9), 0);
  EXPECT_EQ(Warnings(watch, 10, 0.2), 0);  // it was not on end
  EXPECT_EQ(Warnings(watch, 100, 0.2), 1);
  EXPECT_EQ(Warnings(watch, 100, 0.9), 0);
  EXPECT_EQ(Warnings(watch, 100, 0.2), 0);  // said before
}

}  // namespace
}  // namespace rds
