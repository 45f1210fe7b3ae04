// SPDX-License-Identifier: Apache-2.0
#include "tracking/data_association.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "testing/board.h"

namespace rds {
namespace {

// Points 0.. with given probabilities, each matched to the keypoint of its number.
struct Scene {
  LocalMap map;
  MovingProbabilities probabilities;
  std::vector<PointMatch> matches;

  void Add(int count, double probability) {
    for (int i = 0; i < count; ++i) {
      const auto index = static_cast<std::uint32_t>(map.ids.size());
      map.ids.push_back(PointId{index});
      map.observations.push_back(10);
      probabilities.Set(PointId{index}, probability);
      matches.push_back({index, index, PointState::kUnknown, 1.0});
    }
  }
  [[nodiscard]] Association Select(const AssociationOptions& options,
                                   const KeypointProbabilities* propagated = nullptr) const {
    return SelectMatches(matches, map, probabilities, propagated, options);
  }
};

TEST(DataAssociation, EnoughStaticMatchesLeaveUnknownOnesAside) {
  Scene scene;
  scene.Add(30, 0.5);
  scene.Add(20, 0.1);
  scene.Add(10, 0.9);
  const Association association = scene.Select({});
  EXPECT_EQ(association.used.size(), 20U);
  EXPECT_EQ(association.static_count, 20);
  EXPECT_EQ(association.deferred.size(), 30U);
  EXPECT_EQ(association.dynamic.size(), 10U);
}

TEST(DataAssociation, BelowTauUnknownOnesFollowTheStaticOnes) {
  Scene scene;
  scene.Add(30, 0.5);
  scene.Add(19, 0.1);
  scene.Add(10, 0.9);
  AssociationOptions options;
  options.unknown = UnknownPoints::kPaper;
  const Association association = scene.Select(options);
  ASSERT_EQ(association.used.size(), 49U);
  EXPECT_EQ(association.used.front().state, PointState::kStatic);
  EXPECT_EQ(association.used.back().state, PointState::kUnknown);
  EXPECT_DOUBLE_EQ(association.used.front().weight, 1.0);
  EXPECT_NEAR(association.used.back().weight, 0.5 / 0.9, 1e-6);
  EXPECT_EQ(association.dynamic.size(), 10U);  // never used
}

TEST(DataAssociation, DeferredUnknownOnesWaitForThePoseOfAFewStaticOnes) {
  for (const int still : {9, 10}) {
    Scene scene;
    scene.Add(30, 0.5);
    scene.Add(still, 0.1);
    scene.Add(10, 0.9);
    const Association association = scene.Select({});
    EXPECT_EQ(association.static_count, still);
    EXPECT_EQ(association.deferred.size(), still == 10 ? 30U : 0U);
    EXPECT_EQ(association.used.size(), still == 10 ? 10U : 39U);
    EXPECT_EQ(association.dynamic.size(), 10U);
  }
}

TEST(DataAssociation, WithoutSemanticsEverythingIsUsedAlike) {
  Scene scene;
  scene.Add(5, 0.9);
  scene.Add(5, 0.1);
  AssociationOptions options;
  options.use_semantics = false;
  const Association association = scene.Select(options);
  EXPECT_EQ(association.used.size(), 10U);
  for (const PointMatch& match : association.used) {
    EXPECT_EQ(match.weight, 1.0);
  }
}

TEST(DataAssociation, AKeypointsLabelSpeaksForAnUnknownPointOnly) {
  Scene scene;
  scene.Add(1, 0.5);
  scene.Add(1, 0.1);
  // Both keypoints lie on a board that is said to move.
  std::vector<Keypoint> keypoints(2);
  for (Keypoint& keypoint : keypoints) {
    keypoint.raw_x = 30 * kDepthGridStep;
    keypoint.raw_y = 30 * kDepthGridStep;
    keypoint.depth_m = kBoardDepth;
  }
  const auto frame = SeeBoard({20, 40}, keypoints);
  PropagatedLabels labels{FrameId{0}, 0, TestCamera(), {}, frame->depth_grid(), {}, {}};
  labels.labels.assign(std::size_t{kBoardColumns} * kBoardRows, SurfaceLabel{0, true});
  const KeypointProbabilities moving(std::make_shared<const PropagatedLabels>(labels), frame, {}, {});
  const Association association = scene.Select({}, &moving);
  ASSERT_EQ(association.dynamic.size(), 1U);
  EXPECT_EQ(association.dynamic[0].point, 0U);
  ASSERT_EQ(association.used.size(), 1U);
  EXPECT_EQ(association.used[0].point, 1U);
}

TEST(DataAssociation, PointsThatFewKeyframesSeeWeighLess) {
  Scene scene;
  scene.Add(3, 0.1);
  scene.map.observations = {1, 3, 200};
  AssociationOptions options;
  options.min_observations = 4;
  const Association association = scene.Select(options);
  ASSERT_EQ(association.used.size(), 3U);
  EXPECT_NEAR(association.used[0].weight, 0.25, 1e-9);
  EXPECT_NEAR(association.used[1].weight, 0.75, 1e-9);
  EXPECT_NEAR(association.used[2].weight, 1.0, 1e-9);
  scene.map.observations = {1, 1, 1};  // all of them new: none better than another
  for (const PointMatch& match : scene.Select(options).used) {
    EXPECT_EQ(match.weight, 1.0);
  }
}

TEST(DataAssociation, OnlyDynamicMatchesLeaveNothing) {
  Scene scene;
  scene.Add(40, 0.95);
  EXPECT_TRUE(scene.Select({}).used.empty());
}

}  // namespace
}  // namespace rds
