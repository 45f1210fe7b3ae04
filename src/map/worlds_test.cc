// SPDX-License-Identifier: Apache-2.0
// Maps that are bent.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "map/local_map.h"
#include "map/map.h"
#include "map/map_bundle.h"
#include "testing/matchers.h"
#include "testing/point_world.h"

namespace rds {
namespace {

using testing::IsEmpty;

Rigid3 At(double x) { return {Eigen::Quaterniond::Identity(), {-x, 0, 0}}; }

// Three keyframes in a row, each made from the one before.
struct Scene {
  PointWorld world{300};
  Map map{ScalePyramid()};
  std::vector<KeyframeId> ids;

  Scene() {
    for (std::uint32_t i = 0; i < 3; ++i) {
      ids.push_back(world.AddTo(map, FrameId{i}, At(0.1 * i), world.Look(At(0.1 * i))));
    }
  }
};

TEST(Bend, KeyframesMoveWithThePointsThatTheyHost) {
  Scene scene;
  const Rigid3 move{ExpSo3({0, 0.1, 0}), {1, 2, 3}};
  std::vector<std::pair<PointId, Eigen::Vector3d>> expected;
  for (const PointId id : scene.map.Points()) {
    const MapPoint& point = scene.map.At(id);
    expected.emplace_back(id, point.reference == scene.ids[0] ? point.position : move * point.position);
  }
  const Rigid3 before = scene.map.At(scene.ids[2]).camera_from_world;
  const std::uint32_t epoch = scene.map.epoch();
  scene.map.Bend(std::vector<Map::WorldMove>{{scene.ids[0], {}}, {scene.ids[1], move}, {scene.ids[2], move}});
  EXPECT_EQ(scene.map.epoch(), epoch + 1);
  EXPECT_THAT(scene.map.At(scene.ids[2]).camera_from_world, RigidNear(before * move.Inverse(), 1e-12, 1e-6));
  for (const auto& [id, position] : expected) {
    EXPECT_THAT(scene.map.At(id).position, MatrixNear(position, 1e-12));
  }
  EXPECT_THAT(scene.map.Validate(), IsEmpty());
}

TEST(Bend, KeyframesThatAreNotNamedFollowTheirParents) {
  Scene scene;
  ASSERT_TRUE(scene.map.At(scene.ids[2]).parent.valid());
  const Rigid3 move{ExpSo3({0, 0.1, 0}), {1, 2, 3}};
  const Rigid3 before = scene.map.At(scene.ids[2]).camera_from_world;
  scene.map.Bend(std::vector<Map::WorldMove>{{scene.ids[0], move}, {scene.ids[1], move}});
  EXPECT_THAT(scene.map.At(scene.ids[2]).camera_from_world, RigidNear(before * move.Inverse(), 1e-12, 1e-6));
}

TEST(Bend, LeavesOtherWorldsAlone) {
  Scene scene;
  PointWorld other(300, 5);
  scene.map.AddWorld();
  const KeyframeId elsewhere = other.AddTo(scene.map, FrameId{9}, At(0), other.Look(At(0)));
  const PointId point = scene.map.At(elsewhere).points.front();
  const Eigen::Vector3d position = scene.map.At(point).position;
  scene.map.Bend(std::vector<Map::WorldMove>{{scene.ids[0], At(5)}});
  EXPECT_THAT(scene.map.At(elsewhere).camera_from_world, RigidNear(At(0), 0.0, 1e-6));
  EXPECT_EQ(scene.map.At(point).position, position);
}

TEST(Bend, CorrectionsThatWereComputedBeforeAreRefused) {
  Scene scene;
  Correction correction;
  const PointId point = scene.map.At(scene.ids[1]).points.front();
  correction.poses.push_back({{scene.ids[1], scene.map.At(scene.ids[1]).pose_revision}, At(7)});
  correction.points.push_back(
      {point,
       scene.map.At(point).revision,
       {scene.map.At(point).reference, scene.map.At(scene.map.At(point).reference).pose_revision},
       {7, 7, 7}});
  scene.map.Bend(std::vector<Map::WorldMove>{{scene.ids[0], At(1)}});
  const Applied applied = scene.map.Apply(correction);
  EXPECT_EQ(applied.poses, 0);
  EXPECT_EQ(applied.points, 0);
}

TEST(LocalMapPoses, AreKnownOfRecentKeyframesOutsideOfTheSnapshot) {
  Scene scene;
  const auto local = BuildLocalMap(scene.map, scene.ids[2], {.keyframes = 1, .neighbors = 0});
  ASSERT_EQ(local->Find(scene.ids[0]), nullptr);
  const auto pose = local->CameraFromWorld(scene.ids[1]);
  ASSERT_TRUE(pose.has_value());
  EXPECT_THAT(*pose, RigidNear(At(0.1), 1e-12, 1e-6));
  EXPECT_FALSE(local->CameraFromWorld(KeyframeId{77}).has_value());
}

// Local mapping goes on while a full bundle adjustment is under way.
TEST(BendTo, WhatChangedMeanwhileFollows) {
  Scene scene;
  std::vector<KeyframeId> all = scene.ids;
  const auto bundle = PlanBundle(scene.map, all, {}, PointsToAdjust(scene.map, all, false), false);
  ASSERT_TRUE(bundle.has_value());
  BundleResult result;
  const Rigid3 shift = At(-0.5);  // new_world_from_old_world of all but the root
  for (std::size_t i = 0; i < bundle->problem.poses.size(); ++i) {
    const Rigid3& pose = bundle->problem.poses[i].camera_from_world;
    result.poses.push_back(i == 0 ? pose : pose * shift.Inverse());
  }
  for (const Eigen::Vector3d& point : bundle->problem.points) {
    result.points.push_back(point + Eigen::Vector3d(0, 0, 1));
  }
  result.outlier.assign(bundle->problem.observations.size(), 0);
  result.usable = true;
  const Rigid3 corrected = Rigid3{ExpSo3({0, 0, 0.1}), {0, 0.2, 0}} * At(0.1);
  scene.map.SetPose(scene.ids[1], corrected);  // by local bundle adjustment
  const KeyframeId later = scene.world.AddTo(scene.map, FrameId{3}, At(0.3), scene.world.Look(At(0.3)));
  const PointId untouched = bundle->points.front().id;
  ASSERT_EQ(scene.map.At(untouched).reference, scene.ids[0]);
  BendTo(scene.map, *bundle, result);
  EXPECT_THAT(scene.map.At(scene.ids[1]).camera_from_world, RigidNear(corrected * shift.Inverse(), 1e-9, 1e-6));
  EXPECT_NE((scene.map.At(later).camera_from_world.translation - At(0.3).translation).norm() > 0.4,
            scene.map.At(later).parent == scene.ids[0]);
  EXPECT_THAT(scene.map.At(untouched).position, MatrixNear(result.points.front(), 1e-9));
  EXPECT_THAT(scene.map.Validate(), IsEmpty());
}

}  // namespace
}  // namespace rds
