// SPDX-License-Identifier: Apache-2.0
#include "propagation/motion_labels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "segmentation/mask.h"
#include "testing/board.h"
#include "testing/unlocked_map.h"

namespace rds {
namespace {

constexpr auto kNone = KeypointLabel::kNone;
constexpr auto kStatic = KeypointLabel::kStatic;
constexpr auto kDynamic = KeypointLabel::kDynamic;

// Two keypoints on a board, one on the wall.
std::shared_ptr<const FrameData> ViewOfBoard() {
  std::vector<Keypoint> keypoints;
  for (const int column : {36, 44, 20}) {
    Keypoint keypoint;
    keypoint.x = keypoint.raw_x = static_cast<float>(DepthGrid::MiddlePixel(column));
    keypoint.y = keypoint.raw_y = static_cast<float>(DepthGrid::MiddlePixel(30));
    keypoint.depth_m = column < 30 ? kWallDepth : kBoardDepth;
    keypoint.depth_sigma_m = 0.01F;
    keypoints.push_back(keypoint);
  }
  return SeeBoard({30, 50}, std::move(keypoints));
}

TEST(LabelAgain, TheSurfacesOfDynamicPointsAreDynamicInTheKeyframesBefore) {
  Map map{ScalePyramid()};
  UnlockedMap access(map);
  std::vector<KeyframeId> ids;
  for (std::uint32_t i = 0; i < 4; ++i) {
    ids.push_back(map.AddKeyframe(FrameId{10 * i}, i, {}, ViewOfBoard()));
  }
  // The first keypoint shows one point in all, the others a point each.
  const PointId shared = map.AddPoint({0, 0, 1}, ids[0], 0);
  for (std::size_t i = 1; i < ids.size(); ++i) {
    ASSERT_TRUE(map.Observe(shared, ids[i], 0));
  }
  const PointId alone = map.AddPoint({0.1, 0, 1}, ids[2], 1);
  const PointId wall = map.AddPoint({-0.3, 0, 2}, ids[2], 2);
  for (const KeyframeId id : ids) {
    map.UpdateCovisibility(id);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    map.Label(ids[i], {kStatic, kStatic, kStatic});
  }
  map.Label(ids[3], {kDynamic, kDynamic, kStatic}, true);
  LabelAgain(access, {FrameId{30}, FrameId{10}});
  EXPECT_EQ(map.At(ids[0]).labels, (std::vector<KeypointLabel>{kStatic, kStatic, kStatic}));
  EXPECT_EQ(map.At(ids[1]).labels, (std::vector<KeypointLabel>{kStatic, kStatic, kStatic}));  // the witness
  EXPECT_EQ(map.At(ids[2]).labels, (std::vector<KeypointLabel>{kDynamic, kDynamic, kStatic}));
  EXPECT_GT(map.probabilities().Get(alone), 0.9);
  EXPECT_LT(map.probabilities().Get(wall), 0.2);
  EXPECT_THAT(map.Validate(), testing::IsEmpty());
}

TEST(LabelAgain, AKeyframeThatIsGoneIsNoReasonToLabelAnything) {
  Map map{ScalePyramid()};
  UnlockedMap access(map);
  const KeyframeId id = map.AddKeyframe(FrameId{0}, 0, {}, ViewOfBoard());
  map.Label(id, {kStatic, kStatic, kNone});
  LabelAgain(access, {FrameId{30}, FrameId{10}});
  EXPECT_EQ(map.At(id).labels, (std::vector<KeypointLabel>{kStatic, kStatic, kNone}));
}

TEST(MarkMoving, WithoutWitnessesTheMaskStaysAsItIs) {
  Map map{ScalePyramid()};
  const UnlockedMap access(map);
  const auto data = ViewOfBoard();
  Image8 mask(data->camera().width, data->camera().height, 1, kUnsurePixel);
  const Image8 before = mask;
  EXPECT_FALSE(MarkMoving(access, RecentFrames(), {FrameId{0}, 0, data}, ScalePyramid(), mask));
  EXPECT_EQ(mask.data, before.data);
}

}  // namespace
}  // namespace rds
