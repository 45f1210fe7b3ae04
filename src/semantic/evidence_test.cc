// SPDX-License-Identifier: Apache-2.0
#include "semantic/evidence.h"

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

std::shared_ptr<const FrameData> Data(std::vector<Keypoint> keypoints) {
  std::vector<Descriptor> descriptors(keypoints.size());
  return std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), std::move(descriptors));
}

// Two keyframes of four keypoints each.
struct Scene {
  Map map{ScalePyramid()};
  MovingProbabilities probabilities;
  MovingProbabilityOptions options;
  KeyframeId a = map.AddKeyframe(FrameId{0}, 0, {}, Data(std::vector<Keypoint>(4))).id;
  KeyframeId b = map.AddKeyframe(FrameId{1}, 1, {}, Data(std::vector<Keypoint>(4))).id;

  PointId Add(KeyframeId keyframe, std::uint32_t keypoint) {
    return AddPoint(map, {0, 0, 2}, keyframe, keypoint, probabilities, options).id;
  }
  void Label(KeyframeId keyframe, Labels labels) {
    ApplyLabels(map, keyframe, std::move(labels), probabilities, options);
  }
};

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
  EXPECT_EQ(LabelKeypoints(*Data(keypoints), mask), (Labels{kDynamic, kStatic, kStatic}));
}

TEST(LabelKeypoints, SaysNothingWhereTheMaskIsUnsure) {
  Image8 mask(640, 480);
  mask.At(10, 10) = kUnsurePixel;
  std::vector<Keypoint> keypoints(1);
  keypoints[0].raw_x = keypoints[0].raw_y = 10;
  EXPECT_EQ(LabelKeypoints(*Data(keypoints), mask), (Labels{kNone}));
}

TEST(LabelKeypoints, TakesTheBorderForWhatLiesOutside) {
  Image8 mask(640, 480);
  mask.At(0, 0) = 255;
  mask.At(639, 479) = 255;
  std::vector<Keypoint> keypoints(2);
  keypoints[0].raw_x = keypoints[0].raw_y = -2;
  keypoints[1].raw_x = 639.7F;
  keypoints[1].raw_y = 481;
  EXPECT_EQ(LabelKeypoints(*Data(keypoints), mask), (Labels{kDynamic, kDynamic}));
}

TEST(LabelKeypoints, RefusesAMaskOfAnotherSize) {
  const auto data = Data(std::vector<Keypoint>(1));
  EXPECT_THROW(static_cast<void>(LabelKeypoints(*data, Image8(320, 240))), InvariantError);
  EXPECT_THROW(static_cast<void>(LabelKeypoints(*data, Image8(640, 480, 3))), InvariantError);
}

TEST(ApplyLabels, TakesOneStepForEachPointThatTheKeyframeSees) {
  Scene scene;
  const PointId moves = scene.Add(scene.a, 0);
  const PointId stays = scene.Add(scene.a, 1);
  const PointId unsaid = scene.Add(scene.a, 2);
  const PointId elsewhere = scene.Add(scene.b, 0);
  scene.Label(scene.a, {kDynamic, kStatic, kNone, kDynamic});
  EXPECT_TRUE(scene.map.At(scene.a).IsLabeled());
  EXPECT_NEAR(scene.probabilities.Get(moves), 0.9, 1e-6);
  EXPECT_NEAR(scene.probabilities.Get(stays), 0.1, 1e-6);
  EXPECT_EQ(scene.probabilities.Get(unsaid), kUnknownProbability);
  EXPECT_EQ(scene.probabilities.Get(elsewhere), kUnknownProbability);
}

TEST(ApplyLabels, NeverCountsTheSameEvidenceTwice) {
  Scene scene;
  const PointId point = scene.Add(scene.a, 0);
  const Labels labels = {kStatic, kStatic, kStatic, kStatic};
  scene.Label(scene.a, labels);
  EXPECT_THROW(scene.Label(scene.a, labels), InvariantError);
  EXPECT_NEAR(scene.probabilities.Get(point), 0.1, 1e-6);
}

TEST(ApplyLabels, WantsALabelForEachKeypoint) {
  Scene scene;
  const PointId point = scene.Add(scene.a, 0);
  EXPECT_THROW(scene.Label(scene.a, {kDynamic, kDynamic}), InvariantError);
  EXPECT_FALSE(scene.map.At(scene.a).IsLabeled());
  EXPECT_EQ(scene.probabilities.Get(point), kUnknownProbability);
}

TEST(Evidence, ANewPointStartsFromTheLabelOfItsKeypoint) {
  Scene scene;
  scene.Label(scene.a, {kDynamic, kStatic, kNone, kStatic});
  EXPECT_NEAR(scene.probabilities.Get(scene.Add(scene.a, 0)), 0.9, 1e-6);
  EXPECT_NEAR(scene.probabilities.Get(scene.Add(scene.a, 1)), 0.1, 1e-6);
  EXPECT_EQ(scene.probabilities.Get(scene.Add(scene.a, 2)), kUnknownProbability);
  EXPECT_EQ(scene.probabilities.Get(scene.Add(scene.b, 0)), kUnknownProbability);  // no label yet
}

TEST(Evidence, AObservationCountsOnlyIfItIsMade) {
  Scene scene;
  scene.Label(scene.b, {kDynamic, kStatic, kDynamic, kDynamic});
  const PointId first = scene.Add(scene.a, 0);
  const PointId second = scene.Add(scene.a, 1);
  const auto add = [&](PointId point, std::uint32_t keypoint) {
    return AddObservation(scene.map, point, scene.b, keypoint, scene.probabilities, scene.options);
  };
  EXPECT_TRUE(add(first, 0));
  EXPECT_NEAR(scene.probabilities.Get(first), 0.9, 1e-6);
  EXPECT_FALSE(add(first, 2));   // the keyframe sees it already
  EXPECT_FALSE(add(second, 0));  // the keypoint is taken
  EXPECT_NEAR(scene.probabilities.Get(first), 0.9, 1e-6);
  EXPECT_EQ(scene.probabilities.Get(second), kUnknownProbability);
}

TEST(Evidence, FusingJoinsWhatBothPointsKnow) {
  Scene scene;
  const auto fuse = [&](std::uint32_t keypoint, double from_probability, double to_probability) {
    const PointId from = scene.Add(scene.a, keypoint);
    const PointId to = scene.Add(scene.b, keypoint);
    scene.probabilities.Set(from, from_probability);
    scene.probabilities.Set(to, to_probability);
    FusePoints(scene.map, from, to, scene.probabilities, scene.options);
    EXPECT_EQ(scene.map.Find(from), nullptr);
    EXPECT_EQ(scene.map.Resolve(from), to);
    EXPECT_EQ(scene.map.At(to).observations.size(), 2U);
    return scene.probabilities.Get(to);
  };
  EXPECT_NEAR(fuse(0, 0.2, 0.2), 0.04 / (0.04 + 0.64), 1e-6);
  EXPECT_NEAR(fuse(1, 0.9, 0.1), 0.5, 1e-6);  // they contradict each other
  EXPECT_NEAR(fuse(2, 0.9, kUnknownProbability), 0.9, 1e-6);
  EXPECT_NEAR(fuse(3, 0.95, 0.95), 1 - scene.options.floor, 1e-6);  // never quite certain
}

}  // namespace
}  // namespace rds
