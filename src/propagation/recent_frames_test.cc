// SPDX-License-Identifier: Apache-2.0
#include "propagation/recent_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "testing/view.h"

namespace rds {
namespace {

using testing::IsEmpty;

RecentFrames At30Hz(std::uint32_t count) {
  RecentFrames recent;
  for (std::uint32_t i = 0; i < count; ++i) {
    recent.Add({FrameId{i}, i / 30.0, FrameOf({})});
  }
  return recent;
}

std::vector<std::uint32_t> FramesOf(const std::vector<RecentFrames::Entry>& entries) {
  std::vector<std::uint32_t> frames;
  for (const RecentFrames::Entry& entry : entries) {
    frames.push_back(entry.frame.value);
  }
  return frames;
}

bool All(FrameId /*frame*/) { return true; }

TEST(RecentFrames, TheFarthestWitnessComesFirst) {
  const auto frames = FramesOf(At30Hz(60).Witnesses(50 / 30.0, All));
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_NEAR(frames.front(), 50 - 30 * RecentFrames::kWitness_s, 0.51);
  EXPECT_TRUE(std::ranges::is_sorted(frames));
  EXPECT_LT(frames.back(), 50U);
}

TEST(RecentFrames, TheFirstFramesAreComparedWithLaterOnes) {
  const auto frames = FramesOf(At30Hz(30).Witnesses(0, All));
  ASSERT_FALSE(frames.empty());
  EXPECT_NEAR(frames.front(), 30 * RecentFrames::kWitness_s, 0.51);
}

TEST(RecentFrames, KnowWhetherAllWitnessesAreThere) {
  EXPECT_FALSE(RecentFrames().ReachBeyond(0));
  EXPECT_FALSE(At30Hz(15).ReachBeyond(0));
  EXPECT_TRUE(At30Hz(21).ReachBeyond(0));
}

TEST(RecentFrames, KeyframesRatherThanOthers) {
  const auto frames = FramesOf(At30Hz(60).Witnesses(50 / 30.0, [](FrameId frame) { return frame.value % 7 == 0; }));
  EXPECT_EQ(frames.front(), 28U);  // 30 or 31 would be nearest
}

TEST(RecentFrames, WhatIsTooNearOrTooLongAgoIsNoWitness) {
  EXPECT_THAT(RecentFrames().Witnesses(1, All), IsEmpty());
  EXPECT_THAT(At30Hz(3).Witnesses(2 / 30.0, All), IsEmpty());
  EXPECT_THAT(At30Hz(300).Witnesses(1, All), IsEmpty());
}

}  // namespace
}  // namespace rds
