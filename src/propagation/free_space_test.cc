// SPDX-License-Identifier: Apache-2.0
#include "propagation/free_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "testing/board.h"

namespace rds {
namespace {

KeypointLabel At(const std::vector<KeypointLabel>& judged, int column, int row) {
  return judged[SampleAt(column, row)];
}

std::ptrdiff_t Count(const std::vector<KeypointLabel>& judged, KeypointLabel label) {
  return std::ranges::count(judged, label);
}

// A view of the wall and the board from the origin.
DepthView View(const Board& board, std::vector<KeypointLabel> labels = {}) {
  return MakeView(FrameId{0}, SeeBoard(board), {}, std::move(labels));
}

TEST(CheckFreeSpace, FindsWhatStandsWhereAnEarlierViewSawTheWall) {
  const std::vector<DepthView> views{View({30, 40})};
  const auto judged = CheckFreeSpace(*SeeBoard({35, 45}), {}, views, {});
  EXPECT_EQ(At(judged, 43, 30), KeypointLabel::kDynamic);  // new there
  EXPECT_EQ(At(judged, 37, 30), KeypointLabel::kNone);     // was there before, too
  EXPECT_EQ(At(judged, 32, 30), KeypointLabel::kNone);     // the wall has come to light: nothing moved in
  EXPECT_EQ(At(judged, 60, 30), KeypointLabel::kNone);
}

TEST(CheckFreeSpace, ABoardThatKeepsStillHasNotMovedWhereverItIsSeenFrom) {
  Rigid3 camera_from_world;
  camera_from_world.translation = {-0.24, 0, 0};  // to the right: the board shifts by ten samples, the wall by five
  const std::vector<DepthView> views{View({30, 40})};
  EXPECT_EQ(Count(CheckFreeSpace(*SeeBoard({20, 30}), camera_from_world, views, {}), KeypointLabel::kDynamic), 0);
  // The same picture by a wrong pose: the board has jumped.
  EXPECT_GT(Count(CheckFreeSpace(*SeeBoard({20, 30}), {}, views, {}), KeypointLabel::kDynamic), 0);
}

TEST(CheckFreeSpace, AStaticSurfaceSeenAgainIsStaticAndNothingElseIs) {
  std::vector<KeypointLabel> labels(static_cast<std::size_t>(kBoardColumns * kBoardRows), KeypointLabel::kStatic);
  for (int row = 0; row < kBoardRows; ++row) {
    for (int column = 30; column < kBoardColumns; ++column) {  // the board, and the wall to the right of it
      labels[SampleAt(column, row)] = KeypointLabel::kDynamic;
    }
  }
  const std::vector<DepthView> views{View({30, 40}, labels)};
  const auto judged = CheckFreeSpace(*SeeBoard({20, 30}), {}, views, {});
  EXPECT_EQ(At(judged, 10, 30), KeypointLabel::kStatic);
  EXPECT_EQ(At(judged, 25, 30), KeypointLabel::kDynamic);  // the board stands where the wall was seen
  EXPECT_EQ(At(judged, 60, 30), KeypointLabel::kNone);     // no word of a label that may be old
}

// What a sensor does not know says nothing: a stereo camera, say, whose noise is a tenth of the depth here.
TEST(CheckFreeSpace, NoiseOfTheSensorMovesNothing) {
  const std::vector<KeypointLabel> labels(static_cast<std::size_t>(kBoardColumns * kBoardRows), KeypointLabel::kStatic);
  Rigid3 back;  // the same picture a step farther away: the wall has come along, or was measured wrongly
  back.translation = {0, 0, 0.08 * static_cast<double>(kWallDepth)};
  for (const bool is_noisy : {false, true}) {
    PinholeCamera camera = TestCamera();
    if (is_noisy) {
      camera.depth_noise = {0, 0.1 / static_cast<double>(kWallDepth)};
    }
    const auto see = [&camera](const Board& board) { return SeeBoard(board, {}, 2.6F, camera); };
    const std::vector<DepthView> views{MakeView(FrameId{0}, see({}), {}, labels)};
    EXPECT_EQ(At(CheckFreeSpace(*see({}), back, views, {}), 40, 30),
              is_noisy ? KeypointLabel::kStatic : KeypointLabel::kNone);
    EXPECT_EQ(At(CheckFreeSpace(*see({35, 45}), {}, views, {}), 40, 30),  // a board, 0.4 m before the wall
              is_noisy ? KeypointLabel::kNone : KeypointLabel::kDynamic);
  }
}

TEST(CheckFreeSpace, WhatStandsJustBeforeAStaticSurfaceIsNotIt) {
  const std::vector<KeypointLabel> labels(static_cast<std::size_t>(kBoardColumns * kBoardRows), KeypointLabel::kStatic);
  const std::vector<DepthView> views{View({}, labels)};
  for (const double share : {0.01, 0.03}) {
    Rigid3 camera_from_world;  // a step back, and yet the picture is the same: it has come along
    camera_from_world.translation = {0, 0, share * static_cast<double>(kWallDepth)};
    EXPECT_EQ(At(CheckFreeSpace(*SeeBoard({}), camera_from_world, views, {}), 40, 30),
              share < 0.02 ? KeypointLabel::kStatic : KeypointLabel::kNone);
  }
}

TEST(CheckFreeSpace, TellsNothingWithoutViewsOrAGrid) {
  const auto bare = std::make_shared<const FrameData>(TestCamera(), std::vector<Keypoint>{}, std::vector<Descriptor>{});
  EXPECT_EQ(Count(CheckFreeSpace(*SeeBoard({30, 40}), {}, {}, {}), KeypointLabel::kNone), kBoardColumns * kBoardRows);
  const std::vector<DepthView> views{View({30, 40})};
  EXPECT_TRUE(CheckFreeSpace(*bare, {}, views, {}).empty());
  const std::vector<DepthView> bare_views{MakeView(FrameId{0}, bare, {}, {})};
  EXPECT_EQ(Count(CheckFreeSpace(*SeeBoard({35, 45}), {}, bare_views, {}), KeypointLabel::kNone),
            kBoardColumns * kBoardRows);
}

TEST(CheckFreeSpace, BlamesThePoseIfNearlyAllMovedIn) {
  const std::vector<DepthView> views{View({})};
  EXPECT_EQ(Count(CheckFreeSpace(*SeeBoard({5, 75}), {}, views, {}), KeypointLabel::kDynamic), 0);
}

TEST(LabelGrid, TakesTheMiddleOfEachSample) {
  Image8 mask(640, 480);
  mask.At(43 * kDepthGridStep + kDepthGridStep / 2, 30 * kDepthGridStep + kDepthGridStep / 2) = 255;
  mask.At(44 * kDepthGridStep + kDepthGridStep / 2, 30 * kDepthGridStep + kDepthGridStep / 2) = 128;
  mask.At(45 * kDepthGridStep, 30 * kDepthGridStep) = 255;
  const auto labels = LabelGrid(*SeeBoard({}), mask);
  EXPECT_EQ(At(labels, 43, 30), KeypointLabel::kDynamic);
  EXPECT_EQ(At(labels, 44, 30), KeypointLabel::kNone);
  EXPECT_EQ(At(labels, 45, 30), KeypointLabel::kStatic);
  EXPECT_EQ(std::ssize(labels), kBoardColumns * kBoardRows);
}

TEST(EarlierKeyframes, AreSpreadOverTheTimeAllowedTheOldestAmongThem) {
  Map map{ScalePyramid()};
  for (const std::uint32_t frame : {0U, 10U, 20U, 30U, 40U, 50U, 60U, 70U}) {
    map.AddKeyframe(FrameId{frame}, frame, {}, SeeBoard({}));
  }
  const auto frames = [&](KeyframeId of) {
    std::vector<std::uint32_t> result;
    for (const PosedFrame& view : EarlierKeyframes(map, of)) {
      result.push_back(view.frame.value);
    }
    return result;
  };
  EXPECT_EQ(frames(KeyframeId{6}), (std::vector<std::uint32_t>{40, 20, 0}));   // of frame 60
  EXPECT_EQ(frames(KeyframeId{7}), (std::vector<std::uint32_t>{50, 30, 10}));  // of frame 70: 0 is too long ago
  EXPECT_EQ(frames(KeyframeId{1}), (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(frames(KeyframeId{0}).empty());
}

TEST(MarkNewlyOccupied, MakesKeypointsThereDynamicAndLeavesTheOthers) {
  std::vector<Keypoint> keypoints(2);
  keypoints[0].raw_x = 43 * kDepthGridStep + 3;
  keypoints[0].raw_y = 30 * kDepthGridStep + 3;
  keypoints[1].raw_x = 60 * kDepthGridStep + 3;
  keypoints[1].raw_y = 30 * kDepthGridStep + 3;
  const auto now = SeeBoard({35, 45}, keypoints);
  const std::vector<DepthView> views{View({30, 40})};
  std::vector<KeypointLabel> labels{KeypointLabel::kStatic, KeypointLabel::kStatic};
  MarkNewlyOccupied(*now, CheckFreeSpace(*now, {}, views, {}), labels);
  EXPECT_EQ(labels, (std::vector{KeypointLabel::kDynamic, KeypointLabel::kStatic}));
}

}  // namespace
}  // namespace rds
