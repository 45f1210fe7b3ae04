// SPDX-License-Identifier: Apache-2.0
#include "place/explained_share.h"

#include <gtest/gtest.h>

#include "testing/board.h"

namespace rds {
namespace {

const Rigid3 kSamePose;

TEST(ExplainedShare, IsOneWhereNothingMoved) {
  const auto frame = SeeBoard({20, 40});
  const auto share = ExplainedShare(*frame, {}, *frame, kSamePose);
  ASSERT_TRUE(share.has_value());
  EXPECT_EQ(*share, 1);
}

TEST(ExplainedShare, WhatStandsWhereTheViewLookedThroughIsNotExplained) {
  const auto empty = SeeBoard({});
  const auto with_board = SeeBoard({20, 60});  // a third of the samples
  EXPECT_NEAR(ExplainedShare(*with_board, {}, *empty, kSamePose).value_or(0), 2.0 / 3, 0.05);
  // The other way round the wall behind the board was hidden: nobody can say.
  EXPECT_EQ(ExplainedShare(*empty, {}, *with_board, kSamePose).value_or(0), 1);
}

TEST(ExplainedShare, OnlyUsableSamplesAreAsked) {
  const auto with_board = SeeBoard({20, 60});
  std::vector<std::uint8_t> wall(with_board->depth_grid().size());
  for (std::size_t i = 0; i < wall.size(); ++i) {
    wall[i] = with_board->depth_grid()[i] > kBoardDepth ? 1 : 0;
  }
  EXPECT_EQ(ExplainedShare(*with_board, wall, *SeeBoard({}), kSamePose).value_or(0), 1);
}

TEST(ExplainedShare, AWrongPoseExplainsNothing) {
  const auto frame = SeeBoard({});
  const Rigid3 nearer{Eigen::Quaterniond::Identity(), {0, 0, -0.5}};  // the wall seems half a meter nearer
  EXPECT_EQ(ExplainedShare(*frame, {}, *frame, nearer).value_or(1), 0);
}

TEST(ExplainedShare, SaysNothingWhereTooLittleCanBeJudged) {
  const auto frame = SeeBoard({});
  EXPECT_FALSE(ExplainedShare(*frame, {}, *FrameOf({}), kSamePose).has_value());
  const Rigid3 turned_away{ExpSo3({0, 3, 0}), {}};
  EXPECT_FALSE(ExplainedShare(*frame, {}, *frame, turned_away).has_value());
}

}  // namespace
}  // namespace rds
