// SPDX-License-Identifier: Apache-2.0
#include "map/correction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "base/error.h"
#include "map/map.h"
#include "testing/matchers.h"
#include "testing/view.h"

namespace rds {
namespace {

using testing::IsEmpty;

constexpr std::uint32_t kPoints = 20;

std::shared_ptr<const FrameData> Data() {
  return std::make_shared<const FrameData>(TestCamera(), std::vector<Keypoint>(2 * kPoints),
                                           std::vector<Descriptor>(2 * kPoints));
}

Rigid3 At(double x) { return {Eigen::Quaterniond::Identity(), {x, 0, 0}}; }

// Three keyframes that see the same points; the first made them, but for the last kPoints / 2, which the second made.
struct Scene {
  Map map{ScalePyramid()};
  std::vector<KeyframeId> keyframes;
  std::vector<PointId> points;

  Scene() {
    for (std::uint32_t k = 0; k < 3; ++k) {
      keyframes.push_back(map.AddKeyframe(FrameId{k}, k, At(0.1 * k), Data()));
      for (std::uint32_t i = 0; i < kPoints; ++i) {
        if (k == (i < kPoints / 2 ? 0U : 1U)) {
          points.push_back(map.AddPoint({0.1 * i, 0, 2}, keyframes[k], i));
        } else if (i < points.size()) {
          EXPECT_TRUE(map.Observe(points[i], keyframes[k], i));
        }
      }
      map.UpdateCovisibility(keyframes[k]);
    }
  }
  ~Scene() { EXPECT_THAT(map.Validate(), IsEmpty()); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  [[nodiscard]] KeyframeVersion Version(std::size_t k) const {
    return {keyframes[k], map.At(keyframes[k]).pose_revision};
  }
  [[nodiscard]] Correction::Point PointAt(std::size_t i, const Eigen::Vector3d& position) const {
    const MapPoint& point = map.At(points[i]);
    return {point.id, point.revision, {point.reference, map.At(point.reference).pose_revision}, position};
  }
};

// As when a local bundle is solved while the semantic thread corrects a pose: whichever comes first stays.
TEST(Correction, APointThatAnotherSolverMovedIsNotWrittenOver) {
  Scene scene;
  Correction bundle;
  bundle.poses.push_back({scene.Version(2), At(0.3)});
  for (std::size_t i = 0; i < kPoints; ++i) {
    bundle.points.push_back(scene.PointAt(i, {0, 0, 9}));
  }
  Correction semantic;
  semantic.poses.push_back({scene.Version(1), At(0.1 - 0.5), true});
  EXPECT_EQ(scene.map.Apply(semantic).poses, 1);
  const Eigen::Vector3d moved(0.1 * (kPoints - 1) + 0.5, 0, 2);  // made by the keyframe: it moved along
  ASSERT_THAT(scene.map.At(scene.points.back()).position, MatrixNear(moved, 1e-9));
  const Applied applied = scene.map.Apply(bundle);
  EXPECT_EQ(applied.poses, 1);
  EXPECT_EQ(applied.points, static_cast<int>(kPoints) / 2);
  EXPECT_THAT(scene.map.At(scene.points.back()).position, MatrixNear(moved, 1e-9));
  EXPECT_EQ(scene.map.At(scene.points.front()).position, Eigen::Vector3d(0, 0, 9));
}

TEST(Correction, OfTwoSolversOfTheSamePointsTheFirstOneCounts) {
  Scene scene;
  Correction first;
  Correction second;
  first.points.push_back(scene.PointAt(3, {1, 0, 2}));
  second.points.push_back(scene.PointAt(3, {5, 0, 2}));
  second.points.push_back(scene.PointAt(4, {6, 0, 2}));
  EXPECT_EQ(scene.map.Apply(first).points, 1);
  EXPECT_EQ(scene.map.Apply(second).points, 1);
  EXPECT_EQ(scene.map.At(scene.points[3]).position, Eigen::Vector3d(1, 0, 2));
  EXPECT_EQ(scene.map.At(scene.points[4]).position, Eigen::Vector3d(6, 0, 2));
}

TEST(Correction, APointWhoseReferenceMovedIsLeft) {
  Scene scene;
  Correction correction;
  correction.points.push_back(scene.PointAt(0, {5, 0, 2}));
  scene.map.SetPose(scene.keyframes[0], At(1));
  EXPECT_EQ(scene.map.Apply(correction).points, 0);
  EXPECT_EQ(scene.map.At(scene.points[0]).position, Eigen::Vector3d(0, 0, 2));
}

TEST(Correction, PosesThatChangedOrWentAreLeft) {
  Scene scene;
  Correction correction;
  for (const std::size_t k : {0U, 1U, 2U}) {
    correction.poses.push_back({scene.Version(k), At(7)});
  }
  scene.map.SetPose(scene.keyframes[1], At(3));
  scene.map.EraseKeyframe(scene.keyframes[2]);
  EXPECT_EQ(scene.map.Apply(correction).poses, 1);
  EXPECT_EQ(scene.map.At(scene.keyframes[1]).camera_from_world.translation.x(), 3);
  EXPECT_EQ(scene.map.At(scene.keyframes[0]).camera_from_world.translation.x(), 7);
}

TEST(Correction, NewPointsAndMatchesOfAMovedKeyframeAreLeft) {
  Scene scene;
  Correction correction;
  correction.new_points.push_back({{0, 0, 2}, scene.Version(0), kPoints, scene.Version(1), kPoints});
  correction.new_points.push_back({{0, 0, 2}, scene.Version(0), kPoints + 1, scene.Version(2), kPoints + 1});
  correction.new_points.push_back({{0, 0, 2}, scene.Version(0), 0, scene.Version(2), kPoints + 2});  // taken
  correction.matches.push_back({scene.points[0], scene.Version(1), kPoints + 5});                    // sees it already
  const PointId other = scene.map.AddPoint({0, 0, 2}, scene.keyframes[0], kPoints + 6);
  const PointId third = scene.map.AddPoint({0, 0, 2}, scene.keyframes[0], kPoints + 7);
  correction.matches.push_back({other, scene.Version(2), 0});            // shown by a keypoint of another point
  correction.matches.push_back({third, scene.Version(1), kPoints + 7});  // moved
  scene.map.SetPose(scene.keyframes[1], At(3));
  const Applied applied = scene.map.Apply(correction);
  ASSERT_EQ(applied.new_points.size(), 1U);
  EXPECT_EQ(scene.map.At(applied.new_points[0]).observations.size(), 2U);
  EXPECT_EQ(scene.map.Resolve(other), scene.points[0]);
  EXPECT_EQ(scene.map.At(third).observations.size(), 1U);
}

TEST(Correction, RemovalsTakeObservationsAwayAndPointsThatNothingSees) {
  Scene scene;
  Correction correction;
  const PointId lone = scene.map.AddPoint({0, 0, 2}, scene.keyframes[0], kPoints);
  correction.removals = {{scene.points[0], scene.keyframes[1]}, {lone, scene.keyframes[0]}, {PointId{999}, {}}};
  correction.points.push_back({lone, 0, scene.Version(0), {1, 1, 1}});
  EXPECT_EQ(scene.map.Apply(correction).points, 0);
  EXPECT_EQ(scene.map.At(scene.points[0]).observations.size(), 2U);
  EXPECT_EQ(scene.map.Find(lone), nullptr);
}

TEST(Worlds, EachHasAnOriginAndMergingKeepsIds) {
  Map map{ScalePyramid()};
  const KeyframeId a = map.AddKeyframe(FrameId{0}, 0, At(0), Data());
  const WorldId other = map.AddWorld();
  const KeyframeId b = map.AddKeyframe(FrameId{1}, 1, At(0), Data());
  const KeyframeId c = map.AddKeyframe(FrameId{2}, 2, At(1), Data());
  map.UpdateCovisibility(c);
  EXPECT_EQ(map.Root(WorldId{0}), a);
  EXPECT_EQ(map.Root(other), b);
  EXPECT_TRUE(map.IsRoot(b) && !map.IsRoot(c));
  EXPECT_EQ(map.At(c).parent, b);
  const PointId point = map.AddPoint({0, 0, 2}, c, 0);
  EXPECT_THROW(map.Observe(point, a, 0), InvariantError);
  const KeyframeId erased = map.AddKeyframe(FrameId{3}, 3, At(2), Data());
  map.UpdateCovisibility(erased);
  map.EraseKeyframe(erased);
  ASSERT_THAT(map.Validate(), IsEmpty());

  const Rigid3 a_from_b{ExpSo3({0, 0, 1}), {0, 5, 0}};
  const Rigid3 before = map.At(c).camera_from_world;
  const Rigid3 erased_before = map.CameraFromWorld(erased);
  map.Merge(c, a, a_from_b);
  EXPECT_THAT(map.Validate(), IsEmpty());
  EXPECT_EQ(map.At(c).parent, a);
  EXPECT_EQ(map.At(b).parent, c);  // its tree is turned round
  EXPECT_EQ(map.WorldOf(erased), WorldId{0});
  EXPECT_FALSE(map.Root(other).valid());
  EXPECT_THAT(map.At(point).position, MatrixNear((a_from_b * Eigen::Vector3d(0, 0, 2)).eval(), 1e-12));
  EXPECT_THAT(map.At(c).camera_from_world * a_from_b, RigidNear(before, 1e-9, 1e-6));
  EXPECT_THAT(map.CameraFromWorld(erased) * a_from_b, RigidNear(erased_before, 1e-9, 1e-6));
  EXPECT_TRUE(map.Observe(point, a, 0));
  // Who still names the world that is gone means the one that it became.
  EXPECT_EQ(map.At(map.AddKeyframe(FrameId{4}, 4, At(0), Data(), other)).world, WorldId{0});
  EXPECT_THROW(map.Merge(c, a, {}), InvariantError);
}

// A solver that began before two worlds were merged changes nothing of what was moved.
TEST(Worlds, WhatWasComputedBeforeAMergeIsStale) {
  Map map{ScalePyramid()};
  const KeyframeId a = map.AddKeyframe(FrameId{0}, 0, At(0), Data());
  map.AddWorld();
  const KeyframeId b = map.AddKeyframe(FrameId{1}, 1, At(0), Data());
  const PointId point = map.AddPoint({0, 0, 2}, b, 0);
  Correction correction;
  correction.poses.push_back({{b, 0}, At(9)});
  correction.points.push_back({point, 0, {b, 0}, {9, 9, 9}});
  map.Merge(b, a, At(1));
  const Applied applied = map.Apply(correction);
  EXPECT_EQ(applied.poses + applied.points, 0);
}

}  // namespace
}  // namespace rds
