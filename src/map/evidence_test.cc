// SPDX-License-Identifier: Apache-2.0
// What labels say of points, and that the map counts it once.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "base/error.h"
#include "map/map.h"
#include "testing/view.h"

namespace rds {
namespace {

using Labels = std::vector<KeypointLabel>;
constexpr KeypointLabel kNone = KeypointLabel::kNone;
constexpr KeypointLabel kStatic = KeypointLabel::kStatic;
constexpr KeypointLabel kDynamic = KeypointLabel::kDynamic;

// Two keyframes of four keypoints each.
struct Scene {
  Map map{ScalePyramid()};
  KeyframeId a = map.AddKeyframe(FrameId{0}, 0, {}, FrameOf(std::vector<Keypoint>(4)));
  KeyframeId b = map.AddKeyframe(FrameId{1}, 1, {}, FrameOf(std::vector<Keypoint>(4)));

  PointId Add(KeyframeId keyframe, std::uint32_t keypoint) { return map.AddPoint({0, 0, 2}, keyframe, keypoint); }
  [[nodiscard]] double Get(PointId point) const { return map.probabilities().Get(point); }
};

TEST(MapEvidence, TakesOneStepForEachPointThatTheKeyframeSees) {
  Scene scene;
  const PointId moves = scene.Add(scene.a, 0);
  const PointId stays = scene.Add(scene.a, 1);
  const PointId unsaid = scene.Add(scene.a, 2);
  const PointId elsewhere = scene.Add(scene.b, 0);
  scene.map.Label(scene.a, {kDynamic, kStatic, kNone, kDynamic});
  EXPECT_TRUE(scene.map.At(scene.a).IsLabeled());
  EXPECT_NEAR(scene.Get(moves), 0.9, 1e-6);
  EXPECT_NEAR(scene.Get(stays), 0.1, 1e-6);
  EXPECT_EQ(scene.Get(unsaid), kUnknownProbability);
  EXPECT_EQ(scene.Get(elsewhere), kUnknownProbability);
}

TEST(MapEvidence, NeverCountsTheSameEvidenceTwice) {
  Scene scene;
  const PointId point = scene.Add(scene.a, 0);
  const Labels labels = {kStatic, kStatic, kStatic, kStatic};
  scene.map.Label(scene.a, labels);
  scene.map.Label(scene.a, labels);
  EXPECT_NEAR(scene.Get(point), 0.1, 1e-6);
}

TEST(MapEvidence, WantsALabelForEachKeypoint) {
  Scene scene;
  const PointId point = scene.Add(scene.a, 0);
  EXPECT_THROW(scene.map.Label(scene.a, {kDynamic, kDynamic}), InvariantError);
  EXPECT_FALSE(scene.map.At(scene.a).IsLabeled());
  EXPECT_EQ(scene.Get(point), kUnknownProbability);
}

TEST(MapEvidence, ANewPointStartsFromTheLabelOfItsKeypoint) {
  Scene scene;
  scene.map.Label(scene.a, {kDynamic, kStatic, kNone, kStatic});
  EXPECT_NEAR(scene.Get(scene.Add(scene.a, 0)), 0.9, 1e-6);
  EXPECT_NEAR(scene.Get(scene.Add(scene.a, 1)), 0.1, 1e-6);
  EXPECT_EQ(scene.Get(scene.Add(scene.a, 2)), kUnknownProbability);
  EXPECT_EQ(scene.Get(scene.Add(scene.b, 0)), kUnknownProbability);  // no label yet
}

TEST(MapEvidence, AnObservationCountsOnlyIfItIsMade) {
  Scene scene;
  scene.map.Label(scene.b, {kDynamic, kStatic, kDynamic, kDynamic});
  const PointId first = scene.Add(scene.a, 0);
  const PointId second = scene.Add(scene.a, 1);
  const auto add = [&](PointId point, std::uint32_t keypoint) { return scene.map.Observe(point, scene.b, keypoint); };
  EXPECT_TRUE(add(first, 0));
  EXPECT_NEAR(scene.Get(first), 0.9, 1e-6);
  EXPECT_FALSE(add(first, 2));   // the keyframe sees it already
  EXPECT_FALSE(add(second, 0));  // the keypoint is taken
  EXPECT_NEAR(scene.Get(first), 0.9, 1e-6);
  EXPECT_EQ(scene.Get(second), kUnknownProbability);
}

TEST(MapEvidence, FusingJoinsWhatBothPointsKnow) {
  Scene scene;
  const auto fuse = [&](std::uint32_t keypoint, double from_probability, double to_probability) {
    const PointId from = scene.Add(scene.a, keypoint);
    const PointId to = scene.Add(scene.b, keypoint);
    scene.map.SetMovingProbability(from, from_probability);
    scene.map.SetMovingProbability(to, to_probability);
    scene.map.Fuse(from, to);
    EXPECT_EQ(scene.map.Find(from), nullptr);
    EXPECT_EQ(scene.map.Resolve(from), to);
    EXPECT_EQ(scene.map.At(to).observations.size(), 2U);
    return scene.Get(to);
  };
  EXPECT_NEAR(fuse(0, 0.2, 0.2), 0.04 / (0.04 + 0.64), 1e-6);
  EXPECT_NEAR(fuse(1, 0.9, 0.1), 0.5, 1e-6);  // they contradict each other
  EXPECT_NEAR(fuse(2, 0.9, kUnknownProbability), 0.9, 1e-6);
  EXPECT_NEAR(fuse(3, 0.95, 0.95), 1 - MovingProbabilityOptions().floor, 1e-6);  // never quite certain
}

TEST(MapEvidence, ALabelThatIsSeenForgottenAndSeenAgainCountsOnce) {
  for (const std::uint32_t others : {0U, 1U, 3U, 6U}) {  // with many, the probability is at its floor
    Scene scene;
    const PointId point = scene.Add(scene.a, 0);
    for (std::uint32_t i = 0; i < others; ++i) {
      const KeyframeId other = scene.map.AddKeyframe(FrameId{2 + i}, 2 + i, {}, FrameOf(std::vector<Keypoint>(4)));
      ASSERT_TRUE(scene.map.Observe(point, other, 0));
      scene.map.Label(other, {kDynamic, kNone, kNone, kNone});
    }
    const double before = scene.Get(point);
    scene.map.Label(scene.b, {kDynamic, kDynamic, kNone, kStatic});
    ASSERT_TRUE(scene.map.Observe(point, scene.b, 0));
    const double once = scene.Get(point);
    for (int i = 0; i < 5; ++i) {
      scene.map.Forget(point, scene.b);
      EXPECT_NEAR(scene.Get(point), before, 1e-5);
      ASSERT_TRUE(scene.map.Observe(point, scene.b, 0));
      EXPECT_NEAR(scene.Get(point), once, 1e-5);
    }
    scene.map.Forget(point, scene.b);
    ASSERT_TRUE(scene.map.Observe(point, scene.b, 3));  // another keypoint, another label
    EXPECT_LT(scene.Get(point), before);
  }
}

TEST(MapEvidence, ALaterLabelOfAKeyframeTakesThePlaceOfTheFirst) {
  Scene scene;
  const PointId point = scene.Add(scene.a, 0);
  scene.map.Label(scene.a, {kStatic, kNone, kNone, kNone});
  EXPECT_NEAR(scene.Get(point), 0.1, 1e-6);
  scene.map.Label(scene.a, {kDynamic, kNone, kNone, kNone});
  EXPECT_NEAR(scene.Get(point), 0.9, 1e-6);
  scene.map.Label(scene.a, {kNone, kNone, kNone, kNone});
  EXPECT_NEAR(scene.Get(point), kUnknownProbability, 1e-6);
  EXPECT_THROW(scene.map.Label(scene.a, {kNone}), InvariantError);
}

TEST(MapEvidence, WhatWasSeenToMoveIsDynamicWhateverWasSaidBefore) {
  Scene scene;
  const PointId point = scene.Add(scene.a, 0);
  const PointId other = scene.Add(scene.a, 1);
  scene.map.SetMovingProbability(point, MovingProbabilityOptions().floor);
  scene.map.SetMovingProbability(other, 0.1);
  scene.map.Label(scene.a, {kDynamic, kStatic, kNone, kNone}, true);
  EXPECT_GT(scene.Get(point), MovingProbabilityOptions().dynamic_above);
  EXPECT_NEAR(scene.Get(other), 0.01 / (0.01 + 0.81), 0.02);  // static ones count once
  scene.map.Label(scene.a, {kNone, kNone, kNone, kNone});
  EXPECT_NEAR(scene.Get(point), MovingProbabilityOptions().floor, 1e-4);
}

TEST(MapEvidence, AMaskSpeaksOnceOfPointsThatAreFused) {
  Scene scene;
  const PointId from = scene.Add(scene.a, 0);
  const PointId to = scene.Add(scene.a, 1);
  scene.map.Label(scene.a, {kDynamic, kDynamic, kNone, kNone});
  scene.map.Fuse(from, to);
  EXPECT_NEAR(scene.Get(to), 0.9, 1e-5);
  scene.map.Forget(to, scene.a);  // its last observation
  EXPECT_EQ(scene.map.Find(to), nullptr);
}

TEST(MapEvidence, OutlivesTheKeyframeThatGaveIt) {
  Scene scene;
  const PointId point = scene.Add(scene.a, 0);
  ASSERT_TRUE(scene.map.Observe(point, scene.b, 0));
  scene.map.UpdateCovisibility(scene.b);
  scene.map.Label(scene.b, {kDynamic, kNone, kNone, kNone});
  scene.map.EraseKeyframe(scene.b);
  EXPECT_NEAR(scene.Get(point), 0.9, 1e-6);
}

TEST(MapEvidence, LabelsThatComeBeforeTheirKeyframeAreKeptAndOthersDropped) {
  Scene scene;  // frames 0 and 1
  scene.map.KeepEarlyLabels(FrameId{5}, {kStatic});
  scene.map.KeepEarlyLabels(FrameId{0}, {kStatic});
  EXPECT_TRUE(scene.map.TakeEarlyLabels(FrameId{0}).empty());
  EXPECT_EQ(scene.map.TakeEarlyLabels(FrameId{5}), (Labels{kStatic}));
  EXPECT_TRUE(scene.map.TakeEarlyLabels(FrameId{5}).empty());
}

}  // namespace
}  // namespace rds
