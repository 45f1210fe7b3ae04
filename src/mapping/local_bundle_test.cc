// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_bundle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "base/random.h"
#include "testing/matchers.h"
#include "testing/view.h"

namespace rds {
namespace {

constexpr std::uint32_t kPoints = 40;

Rigid3 Truth(std::size_t keyframe) {
  const auto k = static_cast<double>(keyframe);
  return {ExpSo3({0, 0.05 * k, 0.01 * k}), {-0.15 * k, 0.02 * k, 0}};
}

// Keyframes along an arc that all see the same points exactly, but for one keypoint of each that is `free`. Poses but
// the root's are off by some centimeters, points by some millimeters.
struct Scene {
  Map map{ScalePyramid()};
  LocalBundleOptions options;
  std::vector<Eigen::Vector3d> points;

  // Keypoint `bad` of the newest keyframe is 30 px off.
  explicit Scene(std::size_t keyframes, std::size_t bad = kPoints) {
    Random random(7);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      points.emplace_back(random.Uniform(-0.7, 0.7), random.Uniform(-0.6, 0.6), random.Uniform(2, 4));
    }
    for (std::size_t k = 0; k < keyframes; ++k) {
      std::vector<Keypoint> keypoints;
      for (const Eigen::Vector3d& point : points) {
        keypoints.push_back(See(Truth(k), point));
      }
      if (k + 1 == keyframes && bad < kPoints) {
        keypoints[bad].y += 30;
      }
      keypoints.push_back(See(Truth(k), {0, 0, 2}));
      keypoints.push_back(keypoints.back());
      keypoints.back().depth_m = 0;
      std::vector<Descriptor> descriptors(keypoints.size());
      const auto data = std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), std::move(descriptors));
      Eigen::Matrix<double, 6, 1> error;
      for (double& value : error) {
        value = k == 0 ? 0 : random.Uniform(-0.02, 0.02);
      }
      const auto frame = static_cast<std::uint32_t>(k);
      const KeyframeId id = map.AddKeyframe(FrameId{frame}, 0.1 * frame, Retract(error, Truth(k)), data);
      for (std::uint32_t i = 0; i < kPoints; ++i) {
        if (k == 0) {
          map.AddPoint(points[i] + Eigen::Vector3d(random.Uniform(-0.005, 0.005), 0.003, 0.005), id, i);
        } else {
          EXPECT_TRUE(map.Observe(PointId{i}, id, i));
        }
      }
      map.UpdateCovisibility(id);
    }
  }
  [[nodiscard]] MapBundle Plan(bool semantics = true) const {
    return PlanLocalBundle(map, map.newest(), semantics, options).value();
  }
  [[nodiscard]] bool IsWorthwhile() const { return PlanLocalBundle(map, map.newest(), true, options).has_value(); }
  Applied Apply(const MapBundle& bundle) { return map.Apply(SolveLocalBundle(bundle, options.solver).value()); }
  void Label(std::uint32_t keyframe) {
    const KeyframeId id{keyframe};
    map.Label(id, std::vector(map.At(id).points.size(), KeypointLabel::kNone));
  }
};

std::vector<std::uint32_t> FreePoses(const MapBundle& bundle) {
  std::vector<std::uint32_t> free_ones;
  for (std::size_t i = 0; i < bundle.keyframes.size(); ++i) {
    if (!bundle.problem.poses[i].fixed) {
      free_ones.push_back(bundle.keyframes[i].keyframe.value);
    }
  }
  return free_ones;
}

using Values = std::vector<std::uint32_t>;

TEST(MapBundle, RecoversPosesAndPointsWithTheRootHeld) {
  Scene scene(4);
  const MapBundle bundle = scene.Plan();
  EXPECT_EQ(FreePoses(bundle), (Values{1, 2, 3}));
  EXPECT_EQ(bundle.problem.observations.size(), 4U * kPoints);
  scene.options.solver.robust_iterations = scene.options.solver.final_iterations = 20;
  scene.Apply(bundle);
  for (std::uint32_t k = 0; k < 4; ++k) {
    EXPECT_THAT(scene.map.At(KeyframeId{k}).camera_from_world, RigidNear(Truth(k), k == 0 ? 0.0 : 1e-3, 0.02)) << k;
    EXPECT_EQ(scene.map.At(KeyframeId{k}).pose_revision, k == 0 ? 0U : 1U);
  }
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    EXPECT_THAT(scene.map.At(PointId{i}).position, MatrixNear(scene.points[i], 1e-3));
    EXPECT_EQ(scene.map.At(PointId{i}).observations.size(), 4U);
  }
}

TEST(MapBundle, DynamicPointsAreLeftOutAndOthersWeightedIfAsked) {
  Scene scene(2);
  scene.map.SetMovingProbability(PointId{3}, 0.9);
  scene.map.SetMovingProbability(PointId{4}, 0.2);
  const MapBundle weighted = scene.Plan();
  EXPECT_EQ(weighted.points.size(), kPoints - 1);
  EXPECT_EQ(std::ranges::count(weighted.points, PointId{3}, &MapBundle::Point::id), 0);
  for (const BundleProblem::Observation& observation : weighted.problem.observations) {
    EXPECT_NEAR(observation.keypoint.weight, weighted.points[observation.point].id == PointId{4} ? 0.8 : 0.5, 1e-6);
  }
  const auto all_count_alike = [](const MapBundle& bundle) {
    return bundle.points.size() == kPoints &&
           std::ranges::all_of(bundle.problem.observations, [](const auto& one) { return one.keypoint.weight == 1.0; });
  };
  EXPECT_TRUE(all_count_alike(scene.Plan(false)));
  scene.options.weighted = false;
  EXPECT_TRUE(all_count_alike(scene.Plan()));
}

TEST(MapBundle, KeyframesBeyondTheWindowAreHeld) {
  Scene scene(5);
  scene.options.keyframes = 2;
  const MapBundle bundle = scene.Plan();
  EXPECT_EQ(FreePoses(bundle), (Values{4}));  // the other one of the window is the root, the most covisible by id
  EXPECT_EQ(bundle.keyframes.size(), 5U);
  scene.options.fixed_keyframes = 1;
  EXPECT_EQ(scene.Plan().keyframes.size(), 3U);
  EXPECT_EQ(scene.Plan().problem.observations.size(), 3U * kPoints);
}

TEST(MapBundle, OnlyLabeledKeyframesTakePartOnceThereAreEnough) {
  Scene scene(6);
  scene.options.labeled_only = true;
  scene.options.fixed_keyframes = 0;
  scene.Label(2);
  scene.Label(3);
  EXPECT_EQ(FreePoses(scene.Plan()), (Values{1, 2, 3, 4, 5}));
  scene.Label(5);
  // No root among them: the oldest is held.
  EXPECT_EQ(scene.Plan().keyframes.size(), 3U);
  EXPECT_EQ(FreePoses(scene.Plan()), (Values{3, 5}));
  EXPECT_EQ(FreePoses(scene.Plan(false)), (Values{1, 2, 3, 4, 5}));
}

TEST(MapBundle, APointSeenOnceTakesPartOnlyWithDepth) {
  Scene scene(2);
  const PointId deep = scene.map.AddPoint({0, 0, 2}, scene.map.newest(), kPoints);
  const PointId flat = scene.map.AddPoint({0, 0, 2}, scene.map.newest(), kPoints + 1);
  const MapBundle bundle = scene.Plan();
  EXPECT_EQ(std::ranges::count(bundle.points, deep, &MapBundle::Point::id), 1);
  EXPECT_EQ(std::ranges::count(bundle.points, flat, &MapBundle::Point::id), 0);
  EXPECT_EQ(bundle.problem.points.size(), bundle.points.size());
  EXPECT_EQ(bundle.problem.observations.size(), 2U * kPoints + 1);
}

TEST(MapBundle, IsNotWorthwhileWithOneKeyframeOrNoPoints) {
  EXPECT_FALSE(Scene(1).IsWorthwhile());
  Scene scene(2);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    scene.map.SetMovingProbability(PointId{i}, 0.95);
  }
  EXPECT_FALSE(scene.IsWorthwhile());
}

TEST(MapBundle, WhatChangedMeanwhileIsNotWrittenOver) {
  Scene scene(4);
  const MapBundle bundle = scene.Plan();
  const Correction correction = SolveLocalBundle(bundle, {}).value();
  const Rigid3 changed{Eigen::Quaterniond::Identity(), {-0.3, 0.1, 0}};
  scene.map.SetPose(KeyframeId{2}, changed);
  scene.map.EraseKeyframe(KeyframeId{1});
  scene.map.ErasePoint(PointId{5});
  scene.map.Fuse(PointId{6}, scene.map.AddPoint({0, 0, 2}, KeyframeId{3}, kPoints));
  scene.map.Apply(correction);
  EXPECT_THAT(scene.map.At(KeyframeId{2}).camera_from_world, RigidNear(changed, 0.0, 1e-6));
  EXPECT_THAT(scene.map.At(KeyframeId{3}).camera_from_world, RigidNear(Truth(3), 2e-3, 0.1));
  EXPECT_EQ(scene.map.Find(KeyframeId{1}), nullptr);
  EXPECT_EQ(scene.map.Find(PointId{5}), nullptr);
  EXPECT_EQ(scene.map.At(PointId{kPoints}).position, Eigen::Vector3d(0, 0, 2));
}

TEST(MapBundle, OutlierObservationsAreUnlinked) {
  Scene scene(4, 8);
  const MapBundle bundle = scene.Plan();
  scene.options.solver.robust_iterations = scene.options.solver.final_iterations = 20;
  scene.Apply(bundle);
  EXPECT_FALSE(scene.map.At(KeyframeId{3}).points[8].valid());
  EXPECT_EQ(scene.map.At(PointId{8}).observations.size(), 3U);
  EXPECT_EQ(scene.map.At(PointId{9}).observations.size(), 4U);
  EXPECT_THAT(scene.map.At(KeyframeId{3}).camera_from_world, RigidNear(Truth(3), 1e-3, 0.05));
}

}  // namespace
}  // namespace rds
