// SPDX-License-Identifier: Apache-2.0
#include "semantic/keypoint_labels.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "base/error.h"
#include "segmentation/mask.h"
#include "testing/view.h"

namespace rds {
namespace {

using Labels = std::vector<KeypointLabel>;
constexpr KeypointLabel kNone = KeypointLabel::kNone;
constexpr KeypointLabel kStatic = KeypointLabel::kStatic;
constexpr KeypointLabel kDynamic = KeypointLabel::kDynamic;

TEST(LabelKeypoints, LooksUpTheRecordedPixelNotTheUndistortedOne) {
  Image8 mask(640, 480);
  mask.At(100, 50) = 255;
  std::vector<Keypoint> keypoints(3);
  keypoints[0].raw_x = 100.4F;  // rounds into the mask; its undistorted place lies outside of it
  keypoints[0].raw_y = 49.6F;
  keypoints[0].x = 110;
  keypoints[0].y = 60;
  keypoints[1].raw_x = 100.6F;  // rounds beside it
  keypoints[1].raw_y = 50;
  keypoints[2].raw_x = 110;  // the other way round
  keypoints[2].raw_y = 60;
  keypoints[2].x = 100;
  keypoints[2].y = 50;
  EXPECT_EQ(LabelKeypoints(*FrameOf(keypoints), mask), (Labels{kDynamic, kStatic, kStatic}));
}

TEST(LabelKeypoints, SaysNothingWhereTheMaskIsUnsure) {
  Image8 mask(640, 480);
  mask.At(10, 10) = kUnsurePixel;
  std::vector<Keypoint> keypoints(1);
  keypoints[0].raw_x = keypoints[0].raw_y = 10;
  EXPECT_EQ(LabelKeypoints(*FrameOf(keypoints), mask), (Labels{kNone}));
}

TEST(LabelKeypoints, TakesTheBorderForWhatLiesOutside) {
  Image8 mask(640, 480);
  mask.At(0, 0) = 255;
  mask.At(639, 479) = 255;
  std::vector<Keypoint> keypoints(2);
  keypoints[0].raw_x = keypoints[0].raw_y = -2;
  keypoints[1].raw_x = 639.7F;
  keypoints[1].raw_y = 481;
  EXPECT_EQ(LabelKeypoints(*FrameOf(keypoints), mask), (Labels{kDynamic, kDynamic}));
}

TEST(LabelKeypoints, RefusesAMaskOfAnotherSize) {
  const auto data = FrameOf(std::vector<Keypoint>(1));
  EXPECT_THROW(static_cast<void>(LabelKeypoints(*data, Image8(320, 240))), InvariantError);
  EXPECT_THROW(static_cast<void>(LabelKeypoints(*data, Image8(640, 480, 3))), InvariantError);
}

}  // namespace
}  // namespace rds
